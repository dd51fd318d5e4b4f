#include "nodes/trace/camera.h"

#include "nodes/trace.h"
#include "runtime/buffers/camera.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/rays.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

enum class Projection : std::uint8_t { perspective, orthographic };
constexpr auto choices(Projection) {
  return std::array{std::pair{Projection::perspective, "perspective"},
                    std::pair{Projection::orthographic, "orthographic"}};
}

struct Inputs {
  Ref<Camera> camera;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {
  Projection projection = Projection::perspective;
};
struct Outputs {
  Tiled<Image> rays;
};

struct State {
  trace::CameraRays rays;
  Ref<SamplePattern> pattern;
};

trace::CameraRays rays_of(const Camera& c, Projection projection) {
  const kernels::ClipSpace space = clip_space(&c);
  return {kernels::look_at(c.eye, c.target, c.up),
          projection == Projection::perspective
              ? kernels::perspective(c.fov_y, c.aspect(), c.near_z, c.far_z, space)
              : kernels::orthographic(c.height, c.aspect(), c.near_z, c.far_z, space),
          viewport_of(c)};
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Camera& c = *in.camera;
  const Ref<SamplePattern> pattern = in.pattern.value_or(nullptr);
  Frame frame{
      .window = picture_window(c), .pattern = pattern, .planes = ray_planes(real_kind(ctx.precision))};
  return {{rays_of(c, p.projection), pattern}, {std::move(frame)}};
}

template <class R>
void fill(const State& s, const Tile& to) {
  const kernels::SamplePositions samples = sample_positions(s.pattern.get());
  constexpr double unit = 1.0 / kernels::sample_unit;
  for (int k = 0; k < to.samples(); ++k)
    for (int y = to.rect().y0; y < to.rect().y1; ++y) {
      const RayWriter<R> row(to, k, y);
      for (int x = to.rect().x0; x < to.rect().x1; ++x) {
        const std::size_t at = samples.index(k, x, y);
        row.put(static_cast<std::size_t>(x - to.rect().x0),
                s.rays.at({x + samples.x[at] * unit, y + samples.y[at] * unit}), 0);
      }
    }
}

void tile(const State& s, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena&) {
  const Tile& to = out[&Outputs::rays];
  if (to.frame().planes[0].kind == PlaneKind::f32)
    fill<float>(s, to);
  else
    fill<double>(s, to);
}

}  // namespace

NodeType nodes::trace_camera() {
  return pixel_node("trace.camera", prepare, tile)
      .doc("Makes the ray of each sample of a camera's picture, in world space.")
      .cite(
          "Appel 1968, Some techniques for shading machine renderings of solids, doi:10.1145/1468075.1468082")
      .cite("Igehy 1999, Tracing ray differentials, doi:10.1145/311535.311555")
      .covers(71)
      .input("camera", &Inputs::camera, "Where the picture is taken from.")
      .input("pattern", &Inputs::pattern, "Where a pixel's samples lie; left out: one sample in its middle.")
      .param("projection", &Params::projection,
             "perspective: rays from the eye; orthographic: along the view, from the plane through the eye.")
      .output(
          "rays", &Outputs::rays,
          "O, D with -1 along the view axis, so that t is distance along it, and their change per pixel.");
}

}  // namespace frustum
