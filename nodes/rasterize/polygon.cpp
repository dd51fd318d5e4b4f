#include "nodes/rasterize/polygon.h"

#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace kernels {
constexpr auto choices(FillRule) {
  return std::array{std::pair{FillRule::even_odd, "even_odd"}, std::pair{FillRule::nonzero, "nonzero"}};
}
}  // namespace kernels
namespace polygon {
enum class Coverage : std::uint8_t { samples, area };
constexpr auto choices(Coverage) {
  return std::array{std::pair{Coverage::samples, "samples"}, std::pair{Coverage::area, "area"}};
}
}  // namespace polygon

namespace {

using polygon::Coverage;

struct Inputs {
  std::optional<std::vector<Ref<Points>>> points;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {
  std::vector<std::vector<glm::dvec2>> contours;
  kernels::FillRule rule = kernels::FillRule::nonzero;
  Coverage coverage = Coverage::samples;
  Color color{glm::dvec3{1}};
  std::optional<Color> paper;
  glm::ivec2 resolution{64, 64};
};
struct Outputs {
  Ref<Image> image;
  Ref<Table> edges, spans;
};

std::vector<polygon::Side> sides_of(const Inputs& in, const Params& p, Context& ctx) {
  std::vector<polygon::Side> sides;
  std::vector<polygon::GridPoint> corners;
  std::size_t left_out = 0;
  const auto close = [&] { polygon::add_sides(sides, corners), corners.clear(); };
  const auto add = [&](const glm::dvec2& px) {
    if (const auto corner = polygon::snapped(px))
      corners.push_back(*corner);
    else
      ++left_out;
  };
  for (const auto& contour : p.contours) {
    for (const glm::dvec2& px : contour) add(px);
    close();
  }
  const std::vector<Ref<Points>> none;
  for (const Ref<Points>& contour : in.points ? *in.points : none) {
    for (const glm::dvec3& at : contour->at) add({at.x, at.y});
    close();
  }
  if (left_out > 0)
    ctx.warn(
        "corners_out_of_range",
        fmt::format("{} corners were left out: they are not finite, or more than 2^21 px away", left_out));
  ctx.count("sides", sides.size());
  return sides;
}

// The edge table of the textbook: by the row where a side is met first.
Table edge_table(std::vector<polygon::Side> sides) {
  std::stable_sort(sides.begin(), sides.end(), [](const polygon::Side& a, const polygon::Side& b) {
    return std::pair(a.top.y, a.top.x) < std::pair(b.top.y, b.top.x);
  });
  Table t;
  t.columns = {{.name = "y_top", .unit = "px"},
               {.name = "y_bottom", .unit = "px"},
               {.name = "x_top", .unit = "px"},
               {.name = "dx_per_row", .unit = "px"},
               {.name = "winding"}};
  constexpr double unit = kernels::corner_unit;
  for (const polygon::Side& s : sides) {
    const double height = static_cast<double>(s.bottom.y) - s.top.y;
    const double values[] = {s.top.y / unit, s.bottom.y / unit, s.top.x / unit,
                             (static_cast<double>(s.bottom.x) - s.top.x) / height, double(s.winding)};
    for (std::size_t i = 0; i < 5; ++i) t.columns[i].numbers.push_back(values[i]);
  }
  return t;
}

// Runs of pixels of one row with the same coverage, and that coverage.
class SpanRows {
 public:
  SpanRows() {
    table_.columns = {{.name = "y", .unit = "px"},
                      {.name = "x0", .unit = "px"},
                      {.name = "x1", .unit = "px"},
                      {.name = "coverage"}};
  }
  void add(int y, std::span<const double> shares) {
    for (std::size_t first = 0, last = 0; first < shares.size(); first = last) {
      while (last < shares.size() && shares[last] == shares[first]) ++last;
      if (shares[first] == 0) continue;
      const double values[] = {double(y), static_cast<double>(first), static_cast<double>(last),
                               shares[first]};
      for (std::size_t i = 0; i < 4; ++i) table_.columns[i].numbers.push_back(values[i]);
    }
  }
  Table take() { return std::move(table_); }

 private:
  Table table_;
};

// Rows of coverage, [sample][x], become premultiplied colour over paper.
class Paint {
 public:
  Paint(const Params& p, Ref<SamplePattern> pattern, Context& ctx)
      : precision_(ctx.precision),
        raster_(Frame{.window = {0, 0, p.resolution.x, p.resolution.y},
                      .pattern = std::move(pattern),
                      .planes = planes(real_kind(ctx.precision)),
                      .color_space = std::string(linear_rec709),
                      .alpha = Alpha::premultiplied}),
        front_(p.color.rgb, 1),
        back_(p.paper ? glm::dvec4(p.paper->rgb, 1) : glm::dvec4(0)),
        tell_(ctx.wants(2)) {
    const std::vector<double> none(static_cast<std::size_t>(p.resolution.x), 0.0);
    if (p.paper)
      for (int y = 0; y < p.resolution.y; ++y)
        for (int k = 0; k < raster_.frame().samples(); ++k) put(k, y, none);
  }

  void put(int sample, int y, std::span<const double> shares) {
    for (int c = 0; c < 4; ++c) {
      if (precision_ == Precision::single)
        write(raster_.view().row<float>(c, sample, y), c, shares);
      else
        write(raster_.view().row<double>(c, sample, y), c, shares);
    }
    if (tell_ && sample == 0) spans_.add(y, shares);
  }
  Raster raster() { return std::move(raster_); }
  Table spans() { return spans_.take(); }

 private:
  static PlaneList planes(PlaneKind kind) { return {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}}; }
  template <class R>
  void write(R* to, int c, std::span<const double> shares) const {
    for (std::size_t x = 0; x < shares.size(); ++x)
      to[x] = static_cast<R>(back_[c] * (1 - shares[x]) + front_[c] * shares[x]);
  }

  Precision precision_;
  Raster raster_;
  glm::dvec4 front_, back_;
  bool tell_;
  SpanRows spans_;
};

void draw_samples(std::vector<polygon::Side> sides, const Params& p, const SamplePattern& pattern,
                  Paint& paint, Context& ctx) {
  const kernels::PixelRect window{0, 0, p.resolution.x, p.resolution.y};
  const kernels::SamplePositions positions{pattern.samples, pattern.period, pattern.x, pattern.y};
  polygon::WindingRows rows(std::move(sides), positions, window);
  const auto width = static_cast<std::size_t>(p.resolution.x);
  std::vector<int> winding(width * static_cast<std::size_t>(pattern.samples));
  std::vector<double> shares(width);
  std::uint64_t covered = 0;
  for (int y = 0; y < p.resolution.y; ++y) {
    ctx.poll();
    rows.row(y, winding);
    if (rows.active() == 0) continue;
    for (int k = 0; k < pattern.samples; ++k) {
      const auto of_sample = std::span(winding).subspan(static_cast<std::size_t>(k) * width, width);
      for (std::size_t x = 0; x < width; ++x) {
        const bool inside = kernels::is_inside(of_sample[x], p.rule);
        shares[x] = inside ? 1 : 0;
        covered += inside ? 1 : 0;
      }
      paint.put(k, y, shares);
    }
  }
  ctx.count("samples_covered", covered);
}

void draw_area(const std::vector<polygon::Side>& sides, const Params& p, Paint& paint, Context& ctx) {
  const kernels::PixelRect window{0, 0, p.resolution.x, p.resolution.y};
  kernels::AreaSweep sweep(polygon::area_edges(sides), p.rule, window);
  sweep.rows([&](int y, std::span<const double> shares) {
    ctx.poll();
    paint.put(0, y, shares);
  });
}

void check(const Params& p) {
  constexpr int limit = 65536;
  if (p.resolution.x > limit || p.resolution.y > limit)
    throw NodeError("too_large",
                    fmt::format("the picture is {} x {} pixels; at most {} can be drawn each way",
                                p.resolution.x, p.resolution.y, limit),
                    at_param("resolution"));
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  if (in.pattern && p.coverage == Coverage::area)
    throw NodeError("sampled_image",
                    "the area of coverage is one value a pixel: it takes no pattern of samples",
                    at_input("pattern"));
  const std::vector<polygon::Side> sides = sides_of(in, p, ctx);
  static const auto middle = std::make_shared<const SamplePattern>();
  const Ref<SamplePattern> pattern = in.pattern.value_or(middle);
  ctx.claim(static_cast<std::uint64_t>(p.resolution.x) * static_cast<std::uint64_t>(p.resolution.y) *
            static_cast<std::uint64_t>(pattern->samples) * 4 * bytes_of(real_kind(ctx.precision)));
  Paint paint(p, in.pattern.value_or(nullptr), ctx);
  if (p.coverage == Coverage::area)
    draw_area(sides, p, paint, ctx);
  else
    draw_samples(sides, p, *pattern, paint, ctx);
  return {std::make_shared<Image>(Image{paint.raster()}), std::make_shared<Table>(edge_table(sides)),
          std::make_shared<Table>(paint.spans())};
}

}  // namespace

NodeType nodes::rasterize_polygon() {
  return node("rasterize.polygon", run)
      .doc("Fills a polygon of any contours by scan lines; polygons that share sides share no sample.")
      .cite(
          "Foley, van Dam, Feiner & Hughes 1990, section 3.6; sub-pixel grid and rule of rasterize.triangles")
      .covers(27, 87)
      .input("points", &Inputs::points, "Further contours, x and y in pixels, y down; z is not looked at.")
      .input("pattern", &Inputs::pattern, "Where samples lie; without it in the middle of each pixel.")
      .param("contours", &Params::contours, "Closed rings of corners; corners snap to 1/256 px.",
             {.unit = "px"})
      .param("rule", &Params::rule, "Inside is what is wound around an odd number of times, or at all.")
      .param("coverage", &Params::coverage, "Of samples in or out, or the exact area inside each pixel.")
      .knob({"samples", "area"}, "One sample a pixel is all or nothing; the area is what many converge to.")
      .param("color", &Params::color, "Of the inside, linear Rec.709.", {.range = at_least(0)})
      .param("paper", &Params::paper, "Colour behind the polygon; null is transparent.",
             {.range = at_least(0)})
      .param("resolution", &Params::resolution,
             "Width and height of the picture; raising them draws more of it.",
             {.unit = "px", .range = at_least(1)})
      .check(check)
      .output("image", &Outputs::image, "The polygon, premultiplied; alpha is the coverage.")
      .output("edges", &Outputs::edges,
              "The edge table: sides that are not horizontal, in order of their upper ends.")
      .output("spans", &Outputs::spans,
              "Runs of pixels of one coverage, of the first sample; x1 is excluded.");
}

}  // namespace frustum
