#include "nodes/rasterize/line.h"

#include "nodes/kernels/mesh_edges.h"
#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <numeric>

namespace frustum {
namespace line {

enum class Algorithm : std::uint8_t { bresenham, dda, wu, gupta_sproull, exact_area };
enum class Connect : std::uint8_t { path, pairs, dots };
enum class Snap : std::uint8_t { pixel, subpixel };
enum class Overlap : std::uint8_t { strongest, sum };

struct Segment {
  glm::dvec2 from{0}, to{0};
};

constexpr auto choices(Algorithm) {
  return std::array{std::pair{Algorithm::bresenham, "bresenham"}, std::pair{Algorithm::dda, "dda"},
                    std::pair{Algorithm::wu, "wu"}, std::pair{Algorithm::gupta_sproull, "gupta_sproull"},
                    std::pair{Algorithm::exact_area, "exact_area"}};
}
constexpr auto choices(Connect) {
  return std::array{std::pair{Connect::path, "path"}, std::pair{Connect::pairs, "pairs"},
                    std::pair{Connect::dots, "dots"}};
}
constexpr auto choices(Snap) {
  return std::array{std::pair{Snap::pixel, "pixel"}, std::pair{Snap::subpixel, "subpixel"}};
}
constexpr auto choices(Overlap) {
  return std::array{std::pair{Overlap::strongest, "strongest"}, std::pair{Overlap::sum, "sum"}};
}
constexpr auto choices(Ends) {
  return std::array{std::pair{Ends::closed, "closed"}, std::pair{Ends::diamond, "diamond"}};
}
constexpr auto choices(Ties) {
  return std::array{std::pair{Ties::fixed, "fixed"}, std::pair{Ties::stay, "stay"}};
}
inline void describe(Fields<Segment>& f) {
  const ParamOptions px{.unit = "px", .range = between(-limit_px, limit_px)};
  f.field("from", &Segment::from, "Where it starts; pixel middles are at 0.5.", px);
  f.field("to", &Segment::to, "Where it ends.", px);
}

}  // namespace line

namespace {

using namespace line;

struct Inputs {
  std::optional<Ref<Points>> points;
  std::optional<Ref<Mesh>> mesh;
};
struct Params {
  std::vector<Segment> segments;
  Connect connect = Connect::path;
  Algorithm algorithm = Algorithm::bresenham;
  Snap snap = Snap::subpixel;
  Ends ends = Ends::closed;
  Ties ties = Ties::fixed;
  double width = 1;
  Overlap overlap = Overlap::strongest;
  Color color{glm::dvec3{1}};
  std::optional<Color> paper;
  glm::ivec2 resolution{64, 64};
};
struct Outputs {
  Ref<Image> image;
  Ref<Table> steps;
};

// ----- the segments

class Segments {
 public:
  explicit Segments(Snap snap) : snap_(snap) {}
  void add(const glm::dvec2& from, const glm::dvec2& to) {
    const auto p = snapped(from), q = snapped(to);
    if (!p || !q) {
      ++left_out_;
      return;
    }
    all_.emplace_back(on_grid(*p), on_grid(*q));
  }
  const auto& all() const { return all_; }
  std::size_t left_out() const { return left_out_; }

 private:
  GridPoint on_grid(GridPoint p) const {
    if (snap_ == Snap::subpixel) return p;
    return {Walk::middle(Walk::pixel_of(p.x)), Walk::middle(Walk::pixel_of(p.y))};
  }
  Snap snap_;
  std::vector<std::pair<GridPoint, GridPoint>> all_;
  std::size_t left_out_ = 0;
};

void add_points(Segments& out, const Points& points, Connect connect) {
  const auto& p = points.at;
  const std::size_t step = connect == Connect::pairs ? 2 : 1;
  const std::size_t reach = connect == Connect::dots ? 0 : 1;
  for (std::size_t i = 0; i + reach < p.size(); i += step)
    out.add(glm::dvec2(p[i].x, p[i].y), glm::dvec2(p[i + reach].x, p[i + reach].y));
}

void add_mesh(Segments& out, const Mesh& mesh, const Context& ctx) {
  std::vector<std::uint32_t> place(mesh.vertices());
  std::iota(place.begin(), place.end(), 0U);
  ctx.real([&]<class R>() {
    const auto column = mesh.real<R>("position");
    const auto position = column->template values<glm::vec<4, R>>();
    const auto at = [&](std::uint32_t v) { return glm::dvec2(position[v].x, position[v].y); };
    const auto keep = [](const kernels::MeshEdge&) { return true; };
    for (const kernels::MeshEdge& e : kernels::mesh_edges(mesh.triangles(), place, keep))
      out.add(at(e.a), at(e.b));
  });
}

Segments segments_of(const Inputs& in, const Params& p, Context& ctx) {
  Segments out(p.snap);
  for (const Segment& s : p.segments) out.add(s.from, s.to);
  if (in.points) add_points(out, **in.points, p.connect);
  if (in.mesh) add_mesh(out, **in.mesh, ctx);
  ctx.count("segments", out.all().size());
  if (out.left_out() > 0)
    ctx.warn("segments_out_of_range",
             fmt::format("{} segments were left out: an end is not finite, or more than 2^30 px away",
                         out.left_out()));
  return out;
}

// ----- drawing

template <class Visit>
void draw(const std::pair<GridPoint, GridPoint>& s, const Params& p, const kernels::PixelRect& window,
          const Visit& visit) {
  switch (p.algorithm) {
    case Algorithm::bresenham: return bresenham(s.first, s.second, p.ends, p.ties, window, visit);
    case Algorithm::dda: return dda(s.first, s.second, p.ends, window, visit);
    case Algorithm::wu: return wu(s.first, s.second, window, visit);
    case Algorithm::gupta_sproull: return gupta_sproull(s.first, s.second, p.width, window, visit);
    case Algorithm::exact_area: return exact_area(s.first, s.second, p.width, window, visit);
  }
}

struct StepRows {
  std::vector<double> line, step, x, y, decision, coverage;

  Table table() && {
    Table t;
    t.columns = {{.name = "line", .numbers = std::move(line)},
                 {.name = "step", .numbers = std::move(step)},
                 {.name = "x", .unit = "px", .numbers = std::move(x)},
                 {.name = "y", .unit = "px", .numbers = std::move(y)},
                 {.name = "decision", .numbers = std::move(decision)},
                 {.name = "coverage", .numbers = std::move(coverage)}};
    return t;
  }
  void add(std::size_t segment, std::size_t index, const Step& s) {
    line.push_back(static_cast<double>(segment)), step.push_back(static_cast<double>(index));
    x.push_back(s.x), y.push_back(s.y), decision.push_back(s.decision), coverage.push_back(s.coverage);
  }
};

// Premultiplied colour over paper, from how much ink every pixel got.
Raster inked(const std::vector<double>& ink, const Params& p, Context& ctx) {
  const PlaneKind kind = real_kind(ctx.precision);
  Raster raster(Frame{.window = {0, 0, p.resolution.x, p.resolution.y},
                      .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
                      .color_space = std::string(linear_rec709),
                      .alpha = Alpha::premultiplied});
  const Tile tile = raster.view();
  const glm::dvec4 front(p.color.rgb, 1), back = p.paper ? glm::dvec4(p.paper->rgb, 1) : glm::dvec4(0);
  const auto width = static_cast<std::size_t>(p.resolution.x);
  ctx.real([&]<class R>() {
    for (int y = 0; y < p.resolution.y; ++y)
      for (int c = 0; c < 4; ++c) {
        R* to = tile.row<R>(c, 0, y);
        for (std::size_t x = 0; x < width; ++x) {
          const double amount = ink[static_cast<std::size_t>(y) * width + x];
          const double opaque = std::min(amount, 1.0);
          to[x] = static_cast<R>(back[c] * (1 - opaque) + front[c] * (c == 3 ? opaque : amount));
        }
      }
  });
  return raster;
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
  const Segments segments = segments_of(in, p, ctx);
  const auto pixels = static_cast<std::size_t>(p.resolution.x) * static_cast<std::size_t>(p.resolution.y);
  ctx.claim(pixels * (sizeof(double) + 4 * bytes_of(real_kind(ctx.precision))));
  std::vector<double> ink(pixels, 0.0);
  StepRows rows;
  const bool tell = ctx.wants(1);
  const kernels::PixelRect window{0, 0, p.resolution.x, p.resolution.y};
  std::uint64_t drawn = 0;
  for (std::size_t i = 0; i < segments.all().size(); ++i) {
    std::size_t index = 0;
    draw(segments.all()[i], p, window, [&](const Step& s) {
      double& amount = ink[static_cast<std::size_t>(s.y) * static_cast<std::size_t>(p.resolution.x) +
                           static_cast<std::size_t>(s.x)];
      amount = p.overlap == Overlap::sum ? amount + s.coverage : std::max(amount, s.coverage);
      if (tell) rows.add(i, index, s);
      ++index;
    });
    drawn += index;
    ctx.poll();
  }
  ctx.count("pixels_drawn", drawn);
  return {std::make_shared<Image>(Image{inked(ink, p, ctx)}),
          std::make_shared<Table>(std::move(rows).table())};
}

}  // namespace

NodeType nodes::rasterize_line() {
  return node("rasterize.line", run)
      .doc("Draws segments pixel by pixel, by the algorithm of your choice, and lists every step it took.")
      .cite("Bresenham 1965; Pitteway 1967; Wu 1991; Gupta & Sproull 1981; errata E14 to E17 and E48")
      .covers(24, 25, 88)
      .input("points", &Inputs::points, "Ends in pixels, y down; z is not looked at.")
      .input("mesh", &Inputs::mesh, "Triangles whose edges are drawn, each once.", {.space = Space::screen})
      .param("segments", &Params::segments, "Further segments, drawn first.")
      .param("connect", &Params::connect,
             "path joins each point to the next, pairs every two; dots are segments without length.")
      .param(
          "algorithm", &Params::algorithm,
          "bresenham and dda choose one pixel a column; wu shares two; the others spread by distance, area.")
      .knob({"bresenham", "dda", "wu", "gupta_sproull", "exact_area"},
            "Area is right at any slope; wu's ink is wrong by up to sqrt(2), one pixel's by all or nothing.")
      .param("snap", &Params::snap, "Ends in the middle of their pixel, as in the course, or on 1/256 px.")
      .knob({"pixel", "subpixel"}, "Ends that jump by pixels turn short lines by whole degrees.")
      .param("ends", &Params::ends,
             "Of bresenham and dda: closed draws both end pixels, diamond none twice along a path.")
      .param("ties", &Params::ties,
             "Of bresenham, midway between two pixels: fixed is the same both ways, stay the course's.")
      .param("width", &Params::width, "Of gupta_sproull and exact_area; raising it makes lines bolder.",
             {.unit = "px", .range = between(0.01, 64)})
      .param("overlap", &Params::overlap, "Where segments meet: the strongest counts, or the sum of all.")
      .param("color", &Params::color, "Of the lines, linear Rec.709.", {.range = at_least(0)})
      .param("paper", &Params::paper, "Colour behind the lines; null is transparent.", {.range = at_least(0)})
      .param("resolution", &Params::resolution,
             "Width and height of the picture; raising them draws more of it.",
             {.unit = "px", .range = at_least(1)})
      .check(check)
      .output("image", &Outputs::image, "The lines, premultiplied; alpha is the coverage.")
      .output("steps", &Outputs::steps,
              "Every pixel in drawing order; decision is d = 2F, or what the algorithm goes by instead.");
}

}  // namespace frustum
