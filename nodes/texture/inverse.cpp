#include "nodes/texture/inverse.h"

#include "nodes/texture.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/quad.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Points> corners;
  std::optional<Ref<Matrix>> matrix;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {
  kernels::QuadMapKind map = kernels::QuadMapKind::projective;
  glm::ivec2 resolution{64, 64};
};
struct Outputs {
  Tiled<Image> points;
};

struct State {
  kernels::QuadMap map;
  Ref<SamplePattern> pattern;
  Precision precision;
};

void check(const Params& p) {
  constexpr int limit = 65536;
  if (p.resolution.x > limit || p.resolution.y > limit)
    throw NodeError("too_large",
                    fmt::format("the picture is {} x {} pixels; at most {} can be filled each way",
                                p.resolution.x, p.resolution.y, limit),
                    at_param("resolution"));
}

constexpr std::array uv_names{"uv.u", "uv.v", "uv.du_dx", "uv.dv_dx", "uv.du_dy", "uv.dv_dy"};

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const kernels::QuadMap map = quad_map(*in.corners, in.matrix ? in.matrix->get() : nullptr, p.map);
  Frame frame{.window = {0, 0, p.resolution.x, p.resolution.y},
              .pattern = in.pattern.value_or(nullptr),
              .planes = {{"id", PlaneKind::u32}}};
  for (const char* name : uv_names) frame.planes.push_back({name, real_kind(ctx.precision)});
  return {State{map, in.pattern.value_or(nullptr), ctx.precision}, {std::move(frame)}};
}

template <class R>
void fill(const State& s, const Tile& to) {
  const Rect& r = to.rect();
  const auto pattern = sample_positions(s.pattern.get());
  for (int k = 0; k < to.samples(); ++k)
    for (int y = r.y0; y < r.y1; ++y) {
      texture::UvTargets<R> row{.id = out_row<std::uint32_t>(to, 0, k, y), .uv = {}};
      for (std::size_t i = 0; i < row.uv.size(); ++i)
        row.uv[i] = out_row<R>(to, static_cast<int>(i) + 1, k, y);
      texture::unmap_row(s.map, pattern, k, r.x0, y, static_cast<std::size_t>(r.width()), no_face, row);
    }
}

void tile(const State& s, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena&) {
  if (s.precision == Precision::single)
    fill<float>(s, out[&Outputs::points]);
  else
    fill<double>(s, out[&Outputs::points]);
}

}  // namespace

NodeType nodes::texture_inverse() {
  return pixel_node("texture.inverse", prepare, tile)
      .doc(
          "Finds for every sample the place in the texture: (s, t) = T_wt(T_sw(x, y)); no pixel is left out.")
      .cite("Heckbert 1989, Fundamentals of Texture Mapping and Image Warping, section 2")
      .covers(29)
      .input("corners", &Inputs::corners,
             "Where (u, v) = (0, 0), (1, 0), (1, 1) and (0, 1) lie, in pixels, y down.")
      .input("matrix", &Inputs::matrix,
             "Takes corners in the world to pixels, before the divide by w, as project.mvp's matrix does.")
      .input("pattern", &Inputs::pattern, "Where a pixel's samples lie; left out: one sample in its middle.")
      .param("map", &Params::map,
             "projective keeps straight lines straight, bilinear keeps steps along sides even.")
      .param("resolution", &Params::resolution, "Width and height of the picture; raising them shows more.",
             {.unit = "px", .range = at_least(1)})
      .check(check)
      .output(
          "points", &Outputs::points,
          "id and uv with derivatives, for texture.sample; id is 0 inside, and nothing is seen elsewhere.");
}

}  // namespace frustum
