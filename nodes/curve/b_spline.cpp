#include "nodes/curve/b_spline.h"

#include "nodes/curve.h"
#include "runtime/buffers/curve_knots.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/step_table.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  std::optional<Ref<Points>> control;
};
struct Params {
  std::vector<glm::dvec3> points;
  int degree = 3;
  KnotKind knots = KnotKind::clamped;
  std::vector<double> knot_values;
  std::vector<double> t;
  int rows = 10000;
};
struct Outputs {
  Ref<Curve> curve;
  Ref<Points> points;
  Ref<Table> basis;
};

Ref<Table> basis_of(const kernels::Spline& s, const Params& p, Context& ctx) {
  StepTable out({{.name = "t"}, {.name = "point"}, {.name = "basis"}}, p.rows);
  if (!ctx.wants(2)) return out.table(ctx, 2);
  for (const double t : p.t) {
    const std::size_t span = s.span_at(t);
    const std::vector<double> n = b_spline::basis(s.knots_of(span), t);
    for (std::size_t k = 0; k < n.size(); ++k) out.add(t, span - s.degree + k, n[k]);
    ctx.poll();
  }
  return out.table(ctx, 2);
}

void check(const Params& p) { check_knots(p.knots, p.knot_values, static_cast<std::size_t>(p.degree)); }

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  std::vector<glm::dvec3> control = p.points;
  if (in.control) {
    ctx.claim((*in.control)->at.size() * (sizeof(glm::dvec3) + sizeof(double)));
    control.insert(control.end(), (*in.control)->at.begin(), (*in.control)->at.end());
  }
  ctx.real([&]<class R>() { round_points<R>(control); });
  auto curve = std::make_shared<Curve>(
      spline_curve(std::move(control), {}, static_cast<std::size_t>(p.degree), p.knots, p.knot_values));
  const kernels::Spline s = curve->spline();
  auto points = std::make_shared<Points>();
  ctx.real([&]<class R>() {
    kernels::SplinePoints<R> at(s);
    for (const double t : p.t) points->at.push_back(at.at(t)), ctx.poll();
  });
  ctx.count("pieces", curve->pieces());
  auto basis = basis_of(s, p, ctx);
  return {std::move(curve), std::move(points), std::move(basis)};
}

}  // namespace

NodeType nodes::curve_b_spline() {
  return node("curve.b_spline", run)
      .doc("Makes a piecewise polynomial that follows its control points, smooth where knots do not repeat.")
      .cite("de Boor 1972, J. Approx. Theory 6:50; Piegl & Tiller 1997, A2.1 and A2.2; errata E70")
      .covers(108, 119)
      .input("control", &Inputs::control, "Control points, after those of 'points'.")
      .param("points", &Params::points, "Control points; x, y and z.")
      .param("degree", &Params::degree, "Of the pieces; raising it makes the curve smoother and stiffer.",
             {.range = between(1, 30)})
      .param(
          "knots", &Params::knots,
          "clamped ends at its first and last point, uniform does not, closed goes around, given lists them.")
      .param("knot_values", &Params::knot_values,
             "Of given: points + degree + 1 numbers that do not fall; each repetition costs one order of "
             "smoothness.")
      .param("t", &Params::t, "Where points and basis functions are asked for.")
      .param("rows", &Params::rows,
             "How many rows of the table are kept; raising it keeps more of a long list.",
             {.range = at_least(1)})
      .check(check)
      .output("curve", &Outputs::curve,
              "The curve, continuous up to order degree - m at a knot that stands m times.")
      .output("points", &Outputs::points,
              "The curve at every t, in order; beyond its ends the last pieces go on.")
      .output("basis", &Outputs::basis,
              "At every t the shares of the control points that count there; others are 0.");
}

}  // namespace frustum
