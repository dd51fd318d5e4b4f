#include "nodes/curve/nurbs.h"

#include "nodes/curve.h"
#include "runtime/buffers/curve_knots.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  std::optional<Ref<Points>> control;
  std::optional<Ref<Matrix>> matrix;
};
struct Params {
  std::vector<glm::dvec3> points;
  std::vector<double> weights;
  int degree = 2;
  KnotKind knots = KnotKind::clamped;
  std::vector<double> knot_values;
  std::vector<double> t;
};
struct Outputs {
  Ref<Curve> curve;
  Ref<Points> points;
};

void project(Curve& c, const glm::dmat4& m) {
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    const auto moved = nurbs::projected(m, c.points[i], c.weights[i]);
    if (!moved)
      throw NodeError("behind_the_eye",
                      fmt::format("the matrix takes control point {} to infinity (w = 0)", i),
                      at_input("matrix"));
    c.points[i] = moved->first, c.weights[i] = moved->second;
  }
}

// A denominator of one sign, which then is the positive one.
void check_weights(Curve& c) {
  if (const auto at = nurbs::pole(c.spline()))
    throw NodeError(
        "pole",
        fmt::format(
            "the weights cancel between t = {:.17g} and {:.17g}: the curve runs to infinity there, or "
            "nowhere",
            at->first, at->second),
        at_param("weights"));
  const auto h =
      kernels::bezier_points(c.spline(), c.spline().span_at(c.spline().first()), c.spline().first(),
                             c.knots[c.spline().span_at(c.spline().first()) + 1]);
  const auto first = std::find_if(h.begin(), h.end(), [](const glm::dvec4& p) { return p.w != 0; });
  if (first != h.end() && first->w < 0)
    for (double& w : c.weights) w = -w;
}

void check(const Params& p) { check_knots(p.knots, p.knot_values, static_cast<std::size_t>(p.degree)); }

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  std::vector<glm::dvec3> control = p.points;
  if (in.control) {
    ctx.claim((*in.control)->at.size() * (sizeof(glm::dvec3) + 2 * sizeof(double)));
    control.insert(control.end(), (*in.control)->at.begin(), (*in.control)->at.end());
  }
  std::vector<double> weights = p.weights;
  if (weights.empty()) weights.assign(control.size(), 1.0);
  auto curve = std::make_shared<Curve>(spline_curve(
      std::move(control), std::move(weights), static_cast<std::size_t>(p.degree), p.knots, p.knot_values));
  if (in.matrix) project(*curve, (*in.matrix)->value);
  ctx.real([&]<class R>() { round_points<R>(curve->points); });
  check_weights(*curve);
  auto points = std::make_shared<Points>();
  ctx.real([&]<class R>() {
    kernels::SplinePoints<R> at(curve->spline());
    for (const double t : p.t) points->at.push_back(at.at(t)), ctx.poll();
  });
  ctx.count("pieces", curve->pieces());
  return {std::move(curve), std::move(points)};
}

}  // namespace

NodeType nodes::curve_nurbs() {
  return node("curve.nurbs", run)
      .doc(
          "Makes a rational B-spline: circles and other conics exactly, and what stays itself in "
          "perspective.")
      .cite("Versprille 1975; Piegl & Tiller 1997, The NURBS Book, chapters 4 and 7; errata E71")
      .covers(120)
      .input("control", &Inputs::control, "Control points, after those of 'points'.")
      .input("matrix", &Inputs::matrix, "A projective map of points and weights: of the whole curve.")
      .param("points", &Params::points, "Control points; x, y and z.")
      .param(
          "weights", &Params::weights,
          "One for each point, or none for 1; raising one pulls the curve to its point. All may not cancel.")
      .param("degree", &Params::degree, "Of the pieces; 2 makes conics.", {.range = between(1, 30)})
      .param(
          "knots", &Params::knots,
          "clamped ends at its first and last point, uniform does not, closed goes around, given lists them.")
      .param("knot_values", &Params::knot_values, "Of given: points + degree + 1 numbers that do not fall.")
      .param("t", &Params::t, "Where points are asked for.")
      .check(check)
      .output("curve", &Outputs::curve, "The curve; its denominator is above 0 everywhere between its ends.")
      .output("points", &Outputs::points,
              "The curve at every t, in order; beyond its ends the last pieces go on.");
}

}  // namespace frustum
