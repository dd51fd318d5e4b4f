#include "nodes/curve/polyline.h"

#include "nodes/curve.h"
#include "runtime/buffers/curve.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace polyline {
enum class Cutting : std::uint8_t { uniform, adaptive };
constexpr auto choices(Cutting) {
  return std::array{std::pair{Cutting::uniform, "uniform"}, std::pair{Cutting::adaptive, "adaptive"}};
}
}  // namespace polyline

namespace {

using namespace polyline;

struct Inputs {
  Ref<Curve> curve;
};
struct Params {
  Cutting cutting = Cutting::adaptive;
  double tolerance = 0.1;
  int segments = 16;
  int depth = 12;
};
struct Outputs {
  Ref<Points> points;
  Ref<Vectors> tangents;
  Ref<Table> samples;
};

// The parts, their memory claimed as it grows.
class Parts {
 public:
  Parts(double tolerance, Context& ctx) : tolerance_(tolerance), ctx_(ctx) {}
  void add(const Cut& c) {
    if (all_.size() == all_.capacity()) {
      const std::size_t more = std::max<std::size_t>(all_.capacity(), 1024);
      ctx_.claim(more * (sizeof(Cut) + 2 * sizeof(glm::dvec3) + 7 * sizeof(double)));
      all_.reserve(all_.size() + more);
      ctx_.poll();
    }
    all_.push_back(c);
    if (!std::isfinite(c.bound))
      ++not_finite_;
    else if (c.bound > tolerance_)
      ++beyond_;
  }
  std::vector<Cut> take(bool adaptive) {
    ctx_.count("segments", all_.size());
    if (adaptive && beyond_ > 0)
      ctx_.warn(
          "tolerance_not_met",
          fmt::format("{} segments may leave the curve by more than {}: 'depth' lets them be cut more often",
                      beyond_, tolerance_));
    if (not_finite_ > 0)
      ctx_.warn(
          "curve_not_finite",
          fmt::format("{} segments have no bound: a control point is not finite, or too large", not_finite_));
    return std::move(all_);
  }

 private:
  double tolerance_;
  Context& ctx_;
  std::vector<Cut> all_;
  std::uint64_t beyond_ = 0, not_finite_ = 0;
};

std::vector<Cut> cut(const kernels::Spline& s, const Params& p, Context& ctx) {
  Parts parts(p.tolerance, ctx);
  const auto add = [&](const Cut& c) { parts.add(c); };
  for (const std::size_t span : kernels::spans_of(s)) {
    const double from = s.knots[span], to = s.knots[span + 1];
    if (p.cutting == Cutting::uniform)
      cut_uniformly(s, span, p.segments, add);
    else
      cut_adaptively(kernels::bezier_points(s, span, from, to), s.rational(), {from, to, 0}, p.tolerance,
                     p.depth, add);
  }
  return parts.take(p.cutting == Cutting::adaptive);
}

Table samples_table() {
  Table t;
  t.columns = {{.name = "t"},     {.name = "x"},         {.name = "y"},    {.name = "z"},
               {.name = "speed"}, {.name = "curvature"}, {.name = "bound"}};
  return t;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const kernels::Spline s = in.curve->spline();
  const std::vector<Cut> parts = cut(s, p, ctx);
  auto points = std::make_shared<Points>();
  auto tangents = std::make_shared<Vectors>();
  auto samples = std::make_shared<Table>(samples_table());
  const bool more = ctx.wants(1) || ctx.wants(2);
  // As far as a tangent may need them where points coincide; two for the curvature.
  const std::size_t orders = more ? std::clamp<std::size_t>(s.degree, 2, 4) + 1 : 1;
  ctx.real([&]<class R>() {
    kernels::SplinePoints<R> curve(s);
    std::vector<glm::dvec3> d(orders);
    const auto add = [&](double t, double bound, kernels::KnotSide side) {
      curve.at(t, d, side);
      points->at.push_back(d[0]);
      if (!more) return;
      tangents->along.push_back(tangent(std::span(d).subspan(1), side));
      const double row[] = {t, d[0].x, d[0].y, d[0].z, kernels::norm(d[1]), curvature(d[1], d[2]), bound};
      for (std::size_t k = 0; k < samples->columns.size(); ++k) samples->columns[k].numbers.push_back(row[k]);
    };
    for (std::size_t i = 0; i < parts.size(); ++i) {
      add(parts[i].from, parts[i].bound, kernels::KnotSide::after);
      if (i % 256 == 0) ctx.poll();
    }
    add(s.last(), 0, kernels::KnotSide::before);
  });
  return {std::move(points), std::move(tangents), std::move(samples)};
}

}  // namespace

NodeType nodes::curve_polyline() {
  return node("curve.polyline", run)
      .doc("Replaces a curve by straight lines that stay within a tolerance of it, or by as many as you say.")
      .cite(
          "Wang 1984; Filip, Magedson & Markot 1986, CAGD 3:295, theorem 1; Lane & Riesenfeld 1980, PAMI "
          "2:35")
      .covers(107)
      .input("curve", &Inputs::curve, "What is drawn.")
      .param("cutting", &Params::cutting,
             "adaptive halves a piece until its bound says that it is straight enough.")
      .param("tolerance", &Params::tolerance,
             "Of adaptive: how far a line may leave the curve; raising it takes fewer lines.",
             {.unit = "units of the curve", .range = above(0)})
      .knob({"2", "0.5", "0.1", "0.02", "0.004"}, "Error like the tolerance; lines like its root.", 1.0)
      .param("segments", &Params::segments,
             "Of uniform: lines for each piece; raising it follows the curve more closely.",
             {.range = between(1, 1000000)})
      .knob({"4", "8", "16", "32", "64"}, "Halving a line quarters its distance from a smooth curve.", -2.0)
      .param("depth", &Params::depth,
             "Of adaptive: how often a piece is halved at most; raising it meets finer tolerances.",
             {.range = between(0, 24)})
      .output("points", &Outputs::points,
              "Ends of the lines in order, on the curve: one more than there are lines.")
      .output("tangents", &Outputs::tangents,
              "Unit vectors along the curve there, by the first derivative that is not 0; 0 where all are.")
      .output("samples", &Outputs::samples,
              "Parameter, point, speed, curvature, and a bound on how far the next line leaves the curve.");
}

}  // namespace frustum
