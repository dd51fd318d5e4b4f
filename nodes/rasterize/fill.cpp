#include "nodes/rasterize/fill.h"

#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <cmath>

namespace frustum {
namespace fill {

enum class Until : std::uint8_t { other_color, boundary };

constexpr auto choices(Connectivity) {
  return std::array{std::pair{Connectivity::four, "four"}, std::pair{Connectivity::eight, "eight"}};
}
constexpr auto choices(Until) {
  return std::array{std::pair{Until::other_color, "other_color"}, std::pair{Until::boundary, "boundary"}};
}

}  // namespace fill

namespace {

struct Inputs {
  Ref<Image> image;
};
struct Params {
  glm::ivec2 seed{0};
  fill::Until until = fill::Until::other_color;
  Color boundary{glm::dvec3{0}};
  double tolerance = 0;
  fill::Connectivity connectivity = fill::Connectivity::four;
  Color color{glm::dvec3{1}};
};
struct Outputs {
  Ref<Image> image;
  Ref<Number> count;
  Ref<Table> spans;
};

// The planes of colour, and how two colours compare.
class Colors {
 public:
  explicit Colors(const Raster& raster) : raster_(raster) {
    const Frame& f = raster.frame();
    if (f.samples() != 1)
      throw NodeError("sampled_image",
                      fmt::format("{} values a pixel: resolve them before a fill", f.samples()),
                      at_input("image"));
    for (const char* name : {"R", "G", "B"}) {
      const auto plane = f.find(name);
      if (!plane)
        throw NodeError("missing_plane", fmt::format("there is no plane '{}'", name), at_input("image"));
      if (f.planes[static_cast<std::size_t>(*plane)].kind == PlaneKind::u32)
        throw NodeError("wrong_plane", fmt::format("plane '{}' holds integers", name), at_input("image"));
      planes_[count_++] = *plane;
    }
  }

  glm::dvec3 at(int x, int y) const {
    return {raster_.value(planes_[0], 0, x, y), raster_.value(planes_[1], 0, x, y),
            raster_.value(planes_[2], 0, x, y)};
  }
  int plane(std::size_t channel) const { return planes_[channel]; }

  // No channel is further away than the tolerance. NaN is near NaN and nothing else, an infinity near itself.
  static bool near(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
    for (glm::length_t c = 0; c < 3; ++c) {
      if (std::isnan(a[c]) || std::isnan(b[c])) {
        if (std::isnan(a[c]) != std::isnan(b[c])) return false;
      } else if (a[c] != b[c] && !(std::fabs(a[c] - b[c]) <= tolerance)) {
        return false;
      }
    }
    return true;
  }

 private:
  const Raster& raster_;
  std::array<int, 3> planes_{};
  std::size_t count_ = 0;
};

// A copy whose pixels in the spans have the colour, and alpha 1 where there is alpha.
Raster painted(const Raster& from, const Colors& colors, const fill::Filled& filled,
               const glm::dvec3& color) {
  Raster to(from.frame());
  const Tile tile = to.view();
  copy(from.view(), tile);
  const Rect& window = from.frame().window;
  const auto paint = [&](int plane, double value) {
    const bool single = from.frame().planes[static_cast<std::size_t>(plane)].kind == PlaneKind::f32;
    for (const fill::Span& s : filled.spans) {
      const auto n = static_cast<std::size_t>(s.x1 - s.x0);
      if (single)
        std::fill_n(tile.row<float>(plane, 0, window.y0 + s.y) + s.x0, n, static_cast<float>(value));
      else
        std::fill_n(tile.row<double>(plane, 0, window.y0 + s.y) + s.x0, n, value);
    }
  };
  for (std::size_t c = 0; c < 3; ++c) paint(colors.plane(c), color[static_cast<glm::length_t>(c)]);
  const auto alpha = from.frame().find("A");
  if (alpha && from.frame().planes[static_cast<std::size_t>(*alpha)].kind != PlaneKind::u32) paint(*alpha, 1);
  return to;
}

Table table_of(const fill::Filled& filled, const Rect& window) {
  Table t;
  t.columns = {{.name = "y", .unit = "px"}, {.name = "x0", .unit = "px"}, {.name = "x1", .unit = "px"}};
  for (const fill::Span& s : filled.spans) {
    t.columns[0].numbers.push_back(window.y0 + s.y);
    t.columns[1].numbers.push_back(window.x0 + s.x0);
    t.columns[2].numbers.push_back(window.x0 + s.x1);
  }
  return t;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const Raster& raster = in.image->raster;
  const Rect& window = raster.frame().window;
  const Colors colors(raster);
  if (!window.contains(p.seed.x, p.seed.y))
    throw NodeError("outside_window",
                    fmt::format("the seed ({}, {}) lies outside of the picture, [{}, {}) x [{}, {})",
                                p.seed.x, p.seed.y, window.x0, window.x1, window.y0, window.y1),
                    at_param("seed"));
  const glm::dvec3 start = colors.at(p.seed.x, p.seed.y);
  const bool flood = p.until == fill::Until::other_color;
  const auto inside = [&](int x, int y) {
    const glm::dvec3 here = colors.at(window.x0 + x, window.y0 + y);
    return Colors::near(here, flood ? start : p.boundary.rgb, p.tolerance) == flood;
  };
  ctx.claim(static_cast<std::uint64_t>(window.area() / 8) + raster.bytes());
  const fill::Filled filled =
      fill::spans_from(window.width(), window.height(), p.seed.x - window.x0, p.seed.y - window.y0,
                       p.connectivity, inside, [&] { ctx.poll(); });
  ctx.count("pixels_filled", filled.pixels);
  ctx.count("pixels_tested", filled.tests);
  ctx.count("spans", filled.spans.size());
  ctx.count("spans_waiting_at_most", filled.deepest);
  return {std::make_shared<Image>(Image{painted(raster, colors, filled, p.color.rgb)}),
          std::make_shared<Number>(Number{static_cast<double>(filled.pixels)}),
          std::make_shared<Table>(table_of(filled, window))};
}

}  // namespace

NodeType nodes::rasterize_fill() {
  return node("rasterize.fill", run)
      .doc("Fills the region around a seed, by spans and without recursion, whatever its size and colours.")
      .cite("Smith 1979, Tint fill, doi:10.1145/965103.807456; Heckbert 1990, Graphics Gems; errata E18")
      .covers(26)
      .input("image", &Inputs::image, "One value a pixel, with planes R, G and B.")
      .param("seed", &Params::seed, "The pixel to start from.", {.unit = "px"})
      .param("until", &Params::until,
             "other_color floods pixels like the seed; boundary goes on to the boundary's colour.")
      .param("boundary", &Params::boundary, "The colour that stops a fill up to a boundary.")
      .param("tolerance", &Params::tolerance,
             "How far each channel may be from a colour and still count as it; raising it fills more.",
             {.range = at_least(0)})
      .param("connectivity", &Params::connectivity,
             "Whether pixels meet over their four sides, or also over their corners.")
      .param("color", &Params::color, "What the region gets.")
      .output("image", &Outputs::image, "The picture with the region filled, opaque.")
      .output("count", &Outputs::count, "Pixels filled.")
      .output("spans", &Outputs::spans,
              "The runs of pixels in the order in which they were filled; x1 is excluded.");
}

}  // namespace frustum
