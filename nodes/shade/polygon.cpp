#include "nodes/shade/polygon.h"

#include "nodes/kernels/parallel.h"
#include "nodes/shade.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <numbers>

namespace frustum {
namespace polygon_shading {
enum class Method : std::uint8_t { scan_line, fan, mean_value };
constexpr auto choices(Method) {
  return std::array{std::pair{Method::scan_line, "scan_line"}, std::pair{Method::fan, "fan"},
                    std::pair{Method::mean_value, "mean_value"}};
}
}  // namespace polygon_shading
namespace {

using polygon_shading::Method;

struct Inputs {
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {
  std::vector<glm::dvec2> corners{{12, 12}, {52, 12}, {52, 52}, {12, 52}};
  std::vector<glm::dvec3> colors{{1, 1, 1}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  Method method = Method::scan_line;
  double turn = 0;
  int first = 0;
  glm::ivec2 resolution{64, 64};
};
struct Outputs {
  Ref<Image> image;
};

void check(const Params& p) {
  if (p.corners.size() < 3)
    throw NodeError("no_plane", "a polygon has at least three corners", at_param("corners"));
  if (p.colors.size() != p.corners.size())
    throw NodeError("rows_differ",
                    fmt::format("{} corners have {} colours", p.corners.size(), p.colors.size()),
                    at_param("colors"));
  for (const glm::dvec2& c : p.corners)
    if (!std::isfinite(kernels::largest_component(c)))
      throw NodeError("not_finite", "a corner of the polygon is not finite", at_param("corners"));
  for (const glm::dvec3& c : p.colors)
    if (!std::isfinite(kernels::largest_component(c)))
      throw NodeError("not_finite", "a colour of a corner is not finite", at_param("colors"));
  constexpr int limit = 65536;
  if (p.resolution.x > limit || p.resolution.y > limit)
    throw NodeError("too_large", fmt::format("a picture has at most {} pixels each way", limit),
                    at_param("resolution"));
}

// Inside by the scan line's rule for every method, so that all of them fill the same samples.
std::optional<glm::dvec3> color_at(const kernels::ColoredPolygon& polygon, Method method,
                                   const glm::dvec2& p) {
  const auto scanned = kernels::scan_line_color(polygon, p);
  if (!scanned || method == Method::scan_line) return scanned;
  const glm::dvec3 smooth = kernels::mean_value_color(polygon, p);
  return method == Method::mean_value ? smooth : kernels::fan_color(polygon, p).value_or(smooth);
}

template <class R>
void draw(const polygon_shading::Polygon& polygon, Method method, Raster& to, const Context& ctx) {
  const Frame& f = to.frame();
  const Tile rows = to.view();
  static const SamplePattern middle;
  const SamplePattern& pattern = f.pattern ? *f.pattern : middle;
  kernels::parallel_blocks(
      static_cast<std::size_t>(f.window.height()), 16, [&](std::size_t begin, std::size_t end) {
        ctx.poll();
        for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
          for (int k = 0; k < f.samples(); ++k) {
            const std::array<R*, 4> out{rows.row<R>(0, k, y), rows.row<R>(1, k, y), rows.row<R>(2, k, y),
                                        rows.row<R>(3, k, y)};
            for (int x = 0; x < f.window.x1; ++x) {
              const std::size_t i = pattern.index(k, x, y);
              const auto color =
                  color_at(polygon.view(), method, {x + pattern.x[i] * 0x1p-12, y + pattern.y[i] * 0x1p-12});
              for (glm::length_t c = 0; c < 3; ++c)
                out[static_cast<std::size_t>(c)][x] = color ? static_cast<R>((*color)[c]) : R(0);
              out[3][x] = color ? R(1) : R(0);
            }
          }
      });
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const auto n = static_cast<int>(p.corners.size());
  const polygon_shading::Polygon polygon = polygon_shading::turned(
      {p.corners, p.colors}, p.turn * std::numbers::pi / 180, static_cast<std::size_t>(p.first % n));
  const PlaneKind kind = real_kind(ctx.precision);
  const Frame frame{.window = {0, 0, p.resolution.x, p.resolution.y},
                    .pattern = in.pattern.value_or(nullptr),
                    .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
                    .color_space = std::string(linear_rec709),
                    .alpha = Alpha::premultiplied};
  ctx.claim(static_cast<std::uint64_t>(frame.window.area()) * frame.bytes_per_pixel());
  Raster image(frame);
  ctx.real([&]<class R>() { draw<R>(polygon, p.method, image, ctx); });
  return {std::make_shared<Image>(Image{std::move(image)})};
}

}  // namespace

NodeType nodes::shade_polygon() {
  return node("shade.polygon", run)
      .doc(
          "Shades a whole polygon from the colours of its corners: what depends on how it lies, and what "
          "does not.")
      .cite("Gouraud 1971, doi:10.1109/T-C.1971.223313")
      .cite(
          "Hormann & Floater 2006, Mean value coordinates for arbitrary planar polygons, "
          "doi:10.1145/1183287.1183295")
      .covers(60)
      .input("pattern", &Inputs::pattern, "Where samples lie; without it in the middle of each pixel.")
      .param("corners", &Params::corners, "In order, without crossings, y down.", {.unit = "px"})
      .param("colors", &Params::colors, "Of the corners, linear Rec.709.")
      .param("method", &Params::method,
             "scan_line depends on the turn, fan on the first corner, mean_value on neither.")
      .param("turn", &Params::turn, "About the middle of the corners, from x to y; raising it turns further.",
             {.unit = "degrees"})
      .param("first", &Params::first,
             "The corner that counts as the first; the picture of fan depends on it.", {.range = at_least(0)})
      .param("resolution", &Params::resolution,
             "Width and height of the picture; raising them draws more of it.",
             {.unit = "px", .range = at_least(1)})
      .check(check)
      .output("image", &Outputs::image, "The polygon, premultiplied; all methods fill the same samples.");
}

}  // namespace frustum
