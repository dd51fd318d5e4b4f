#include "nodes/curve/bezier.h"

#include "nodes/curve.h"
#include "runtime/buffers/curve.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/step_table.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

using bezier::Method;

struct Inputs {
  std::optional<Ref<Points>> control;
};
struct Params {
  std::vector<glm::dvec3> points;
  std::optional<int> degree;
  std::vector<double> t;
  Method method = Method::casteljau;
  int rows = 10000;
};
struct Outputs {
  Ref<Curve> curve;
  Ref<Points> points;
  Ref<Table> triangle, basis;
};

constexpr std::size_t highest_degree = 2000;

void check_degree(const Params& p, std::size_t degree) {
  if (degree > highest_degree)
    throw NodeError(
        "too_large",
        fmt::format("a piece of degree {}; at most {} can be evaluated: set 'degree' to cut the points into "
                    "pieces",
                    degree, highest_degree),
        at_param("degree"));
  const bool binomial = p.method == Method::matrix || p.method == Method::volk_schumaker;
  if (binomial && degree > bezier::highest_binomial_degree)
    throw NodeError(
        "too_large",
        fmt::format("degree {} has binomials beyond the range of this method; it takes at most {}", degree,
                    bezier::highest_binomial_degree),
        at_param("method"));
}

Curve curve_of(const Inputs& in, const Params& p, Context& ctx) {
  std::vector<glm::dvec3> points = p.points;
  if (in.control) {
    ctx.claim((*in.control)->at.size() * sizeof(glm::dvec3));
    points.insert(points.end(), (*in.control)->at.begin(), (*in.control)->at.end());
  }
  if (points.empty())
    throw NodeError("wrong_count", "a Bezier curve has at least one control point", at_param("points"));
  const std::size_t degree = p.degree ? static_cast<std::size_t>(*p.degree) : points.size() - 1;
  check_degree(p, degree);
  if (points.size() > 1 && (points.size() - 1) % degree != 0)
    throw NodeError(
        "wrong_count",
        fmt::format("{} points: pieces of degree {} that share their ends take {} and so on, one more than a "
                    "multiple of {}",
                    points.size(), degree, 2 * degree + 1, degree),
        at_param("degree"));
  ctx.real([&]<class R>() { round_points<R>(points); });
  return bezier_chain(std::move(points), points.size() == 1 ? 0 : degree);
}

std::span<const glm::dvec3> piece(const Curve& c, std::size_t i) {
  return std::span(c.points).subspan(i * c.degree, c.degree + 1);
}

// The piece of a parameter and where it is in it; parameters beyond both ends go on with the pieces there.
std::pair<std::size_t, double> place(const Curve& c, double t) {
  const std::size_t last = static_cast<std::size_t>(c.spline().last()) - 1;
  const double whole = std::floor(t);
  const std::size_t i = !(whole > 0)                         ? 0
                        : whole >= static_cast<double>(last) ? last
                                                             : static_cast<std::size_t>(whole);
  return {i, t - static_cast<double>(i)};
}

Ref<Table> triangle_of(const Curve& c, const Params& p, Context& ctx) {
  StepTable out(
      {{.name = "t"}, {.name = "level"}, {.name = "point"}, {.name = "x"}, {.name = "y"}, {.name = "z"}},
      p.rows);
  if (!ctx.wants(2)) return out.table(ctx, 2);
  ctx.real([&]<class R>() {
    for (const double t : p.t) {
      const auto [i, at] = place(c, t);
      std::vector<bezier::Point<R>> d;
      for (const glm::dvec3& q : piece(c, i)) d.emplace_back(q);
      for (std::size_t k = 0; k < d.size(); ++k) out.add(t, 0, k, d[k].x, d[k].y, d[k].z);
      kernels::casteljau(std::span(d), static_cast<R>(at),
                         [&](std::size_t level, std::size_t k, const bezier::Point<R>& q) {
                           out.add(t, level, k, q.x, q.y, q.z);
                         });
      ctx.poll();
    }
  });
  return out.table(ctx, 2);
}

Ref<Table> basis_of(const Curve& c, const Params& p, Context& ctx) {
  StepTable out({{.name = "t"}, {.name = "point"}, {.name = "bernstein"}}, p.rows);
  if (!ctx.wants(3)) return out.table(ctx, 3);
  ctx.real([&]<class R>() {
    for (const double t : p.t) {
      const auto [i, at] = place(c, t);
      const std::vector<R> b = kernels::bernstein(c.degree, static_cast<R>(at));
      for (std::size_t k = 0; k < b.size(); ++k) out.add(t, i * c.degree + k, b[k]);
      ctx.poll();
    }
  });
  return out.table(ctx, 3);
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  auto curve = std::make_shared<Curve>(curve_of(in, p, ctx));
  auto points = std::make_shared<Points>();
  ctx.real([&]<class R>() {
    std::optional<bezier::Evaluator<R>> evaluator;
    std::size_t of = 0;
    for (const double t : p.t) {
      const auto [i, at] = place(*curve, t);
      if (!evaluator || of != i) evaluator.emplace(piece(*curve, of = i), p.method);
      points->at.emplace_back(evaluator->at(at));
      ctx.poll();
    }
  });
  ctx.count("pieces", curve->pieces());
  const auto triangle = triangle_of(*curve, p, ctx), basis = basis_of(*curve, p, ctx);
  return {std::move(curve), std::move(points), triangle, basis};
}

}  // namespace

NodeType nodes::curve_bezier() {
  return node("curve.bezier", run)
      .doc(
          "Makes a Bezier curve of control points, or a chain of them, and its points at parameters of your "
          "choice.")
      .cite("de Casteljau 1959; Forrest 1972, Computer Journal 15:71; errata E61 to E63")
      .cite(
          "Schumaker & Volk 1986, CAGD 3:149; Farouki 2012, CAGD 29:379; Jiang, Li, Cheng & Su 2010, CAMWA "
          "60:744")
      .covers(109, 112, 113)
      .input("control", &Inputs::control, "Control points, after those of 'points'.")
      .param("points", &Params::points, "Control points; x, y and z.")
      .param("degree", &Params::degree,
             "Of each piece of a chain that shares its joints; null makes one piece of all points.",
             {.range = between(1, double(highest_degree))})
      .param("t", &Params::t, "Where points are asked for: 0 to 1 in the first piece, 1 to 2 in the next.")
      .param("method", &Params::method,
             "How 'points' are computed; casteljau only mixes, compensated has twice the digits.")
      .knob({"matrix", "volk_schumaker", "bernstein", "casteljau", "compensated"},
            "Errors in units of u max|P|, n the degree: up to 3^n, 4 n, 4 n, 2 n and 1.")
      .param("rows", &Params::rows, "How many rows of tables are kept; raising it keeps more of a long list.",
             {.range = at_least(1)})
      .output("curve", &Outputs::curve, "The curve over [0, 1], or [0, pieces].")
      .output("points", &Outputs::points, "The curve at every t, in order; beyond its ends it goes on.")
      .output("triangle", &Outputs::triangle,
              "All points of de Casteljau's algorithm at every t, level by level.")
      .output("basis", &Outputs::basis,
              "At every t the share of each control point of its piece: they add up to 1.");
}

}  // namespace frustum
