#include "nodes/curve/catmull_rom.h"

#include "nodes/curve.h"
#include "runtime/buffers/curve.h"
#include "runtime/buffers/points.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <array>

namespace frustum {
namespace catmull_rom {
enum class Spacing : std::uint8_t { uniform, centripetal, chordal };
constexpr auto choices(Spacing) {
  return std::array{std::pair{Spacing::uniform, "uniform"}, std::pair{Spacing::centripetal, "centripetal"},
                    std::pair{Spacing::chordal, "chordal"}};
}
enum class Ends : std::uint8_t { reflected, given, closed };
constexpr auto choices(Ends) {
  return std::array{std::pair{Ends::reflected, "reflected"}, std::pair{Ends::given, "given"},
                    std::pair{Ends::closed, "closed"}};
}
}  // namespace catmull_rom

namespace {

using catmull_rom::Ends;
using catmull_rom::Spacing;

struct Inputs {
  std::optional<Ref<Points>> through;
};
struct Params {
  std::vector<glm::dvec3> points;
  double tension = 0.5;
  Spacing spacing = Spacing::uniform;
  Ends ends = Ends::reflected;
};
struct Outputs {
  Ref<Curve> curve;
};

std::vector<glm::dvec3> points_of(const Inputs& in, const Params& p, Context& ctx) {
  std::vector<glm::dvec3> points = p.points;
  if (in.through) {
    ctx.claim((*in.through)->at.size() * 6 * sizeof(glm::dvec3));
    points.insert(points.end(), (*in.through)->at.begin(), (*in.through)->at.end());
  }
  ctx.real([&]<class R>() { round_points<R>(points); });
  if (p.spacing == Spacing::uniform) return points;
  // Points at one place have no distance between them, and a knot of its own for neither.
  const std::size_t before = points.size();
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (p.ends == Ends::closed)
    while (points.size() > 1 && points.back() == points.front()) points.pop_back();
  ctx.count("points_dropped", before - points.size());
  return points;
}

// With the points before the first and after the last that its ends' tangents need.
std::vector<glm::dvec3> with_phantoms(std::vector<glm::dvec3> p, Ends ends) {
  if (ends == Ends::given) return p;
  const std::size_t n = p.size();
  const glm::dvec3 first = ends == Ends::closed ? p[n - 1] : p[0] + (p[0] - p[1]);
  const glm::dvec3 last = ends == Ends::closed ? p[0] : p[n - 1] + (p[n - 1] - p[n - 2]);
  if (ends == Ends::closed) {
    const glm::dvec3 second = p[1];
    p.push_back(last), p.push_back(second);
  } else {
    p.push_back(last);
  }
  p.insert(p.begin(), first);
  return p;
}

double step(const glm::dvec3& a, const glm::dvec3& b, Spacing spacing) {
  if (spacing == Spacing::uniform) return 1;
  const double chord = kernels::norm(b - a);
  return spacing == Spacing::chordal ? chord : std::sqrt(chord);
}

std::vector<double> steps_of(std::span<const glm::dvec3> p, const Params& params) {
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    steps.push_back(step(p[i], p[i + 1], params.spacing));
    if (!(steps.back() > 0 && std::isfinite(steps.back())))
      throw NodeError(
          "not_finite",
          fmt::format(
              "the distance between point {} and the next is {}: knots need one that is finite and not "
              "0",
              i, steps.back()),
          at_param("spacing"));
  }
  return steps;
}

template <class R>
Curve chain(std::span<const glm::dvec3> p, std::span<const double> steps, double tension) {
  const std::vector<glm::vec<3, R>> points(p.begin(), p.end());
  std::vector<R> narrow;
  for (const double h : steps) narrow.push_back(static_cast<R>(h));
  Curve c;
  c.degree = 3;
  for (const auto& q : catmull_rom::bezier_points(std::span<const glm::vec<3, R>>(points),
                                                  std::span<const R>(narrow), static_cast<R>(tension)))
    c.points.emplace_back(q);
  std::vector<double> breaks{0};
  for (std::size_t i = 1; i + 1 < steps.size(); ++i) breaks.push_back(breaks.back() + double(narrow[i]));
  c.knots = chain_knots(3, breaks);
  return c;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const std::vector<glm::dvec3> points = points_of(in, p, ctx);
  const std::size_t least = p.ends == Ends::given ? 4 : p.ends == Ends::closed ? 3 : 2;
  if (points.size() < least)
    throw NodeError("wrong_count",
                    fmt::format("{} points that differ from the one before; with these ends a curve needs {}",
                                points.size(), least),
                    at_param("points"));
  const std::vector<glm::dvec3> all = with_phantoms(points, p.ends);
  const std::vector<double> steps = steps_of(all, p);
  std::shared_ptr<Curve> curve;
  ctx.real([&]<class R>() { curve = std::make_shared<Curve>(chain<R>(all, steps, p.tension)); });
  ctx.count("pieces", curve->pieces());
  return {std::move(curve)};
}

}  // namespace

NodeType nodes::curve_catmull_rom() {
  return node("curve.catmull_rom", run)
      .doc("Makes a smooth curve through points, each tangent along the line between its neighbours.")
      .cite(
          "Catmull & Rom 1974; Barry & Goldman 1988, SIGGRAPH 22(4):199; Yuksel, Schaefer & Keyser 2011; "
          "errata E69")
      .covers(118)
      .input("through", &Inputs::through, "Points to go through, after those of 'points'.")
      .param("points", &Params::points,
             "Points to go through; x, y and z. By distance, those where the one before lies count once.")
      .param("tension", &Params::tension,
             "s of the tangent s (next - previous): 1/2 is standard, 0 straight; raising it swings wider.")
      .param(
          "spacing", &Params::spacing,
          "Of knots: uniform, by the root of distances (no cusps or loops within a piece), or by distances.")
      .param("ends", &Params::ends,
             "reflected adds a phantom point at each end, given takes the first and last as such, closed "
             "goes around.")
      .output("curve", &Outputs::curve, "Through every point (given: every inner one), C1 at each.");
}

}  // namespace frustum
