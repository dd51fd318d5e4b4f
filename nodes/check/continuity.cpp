#include "nodes/check/continuity.h"

#include "nodes/check.h"
#include "runtime/buffers/curve.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  std::vector<Ref<Curve>> curves;
};
struct Params {
  int orders = 2;
  double tolerance = 1e-6;
  double gap = 1e-6;
  bool closed = false;
};
struct Outputs {
  Ref<Table> joints;
};

class Rows {
 public:
  explicit Rows(std::size_t orders) : orders_(orders) {
    table_.columns = {{.name = "curve"}, {.name = "t"}, {.name = "c"}, {.name = "g"}};
    for (std::size_t k = 0; k <= orders; ++k) table_.columns.push_back({.name = "c" + std::to_string(k)});
    for (std::size_t k = 1; k <= orders; ++k) table_.columns.push_back({.name = "g" + std::to_string(k)});
  }
  // An order that cannot hold has the residual -1: what is infinite would be taken for a mishap.
  void add(std::size_t curve, double t, const continuity::Joint& j) {
    std::vector<double> row{static_cast<double>(curve), t, static_cast<double>(j.c),
                            static_cast<double>(j.g)};
    for (std::size_t k = 0; k <= orders_; ++k) row.push_back(j.c_residual[k]);
    for (std::size_t k = 1; k <= orders_; ++k)
      row.push_back(std::isinf(j.g_residual[k]) ? -1 : j.g_residual[k]);
    for (std::size_t i = 0; i < row.size(); ++i) table_.columns[i].numbers.push_back(row[i]);
  }
  Table take() { return std::move(table_); }

 private:
  std::size_t orders_;
  Table table_;
};

// One side of a joint: a curve, where, and how long the piece is that ends or begins there.
struct End {
  const Curve& curve;
  double t;
  kernels::KnotSide side;

  double length() const {
    const kernels::Spline s = curve.spline();
    const std::size_t span = s.span_at(t, side);
    return s.knots[span + 1] - s.knots[span];
  }
  // By a parameter that is `unit` times slower.
  continuity::Derivatives derivatives(double unit, Context& ctx) const {
    continuity::Derivatives out;
    ctx.real([&]<class R>() { kernels::SplinePoints<R>(curve.spline()).at(t, out, side); });
    double power = 1;
    for (glm::dvec3& d : out) d *= power, power *= unit;
    return out;
  }
};

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const auto orders = static_cast<std::size_t>(p.orders);
  Rows rows(orders);
  std::uint64_t joints = 0;
  const auto judge = [&](std::size_t i, double t, const Curve& left, const Curve& right, double right_t) {
    const End from{left, t, kernels::KnotSide::before}, to{right, right_t, kernels::KnotSide::after};
    const double unit = std::max(from.length(), to.length());
    rows.add(i, t,
             continuity::judge(from.derivatives(unit, ctx), to.derivatives(unit, ctx), orders, p.tolerance,
                               p.gap));
    ++joints;
    ctx.poll();
  };
  for (std::size_t i = 0; i < in.curves.size(); ++i) {
    const Curve& c = *in.curves[i];
    const kernels::Spline s = c.spline();
    for (const std::size_t span : kernels::spans_of(s))
      if (s.knots[span + 1] < s.last()) judge(i, s.knots[span + 1], c, c, s.knots[span + 1]);
    const bool ends = i + 1 == in.curves.size();
    if (ends && !p.closed) break;
    const Curve& next = *in.curves[ends ? 0 : i + 1];
    judge(i, s.last(), c, next, next.spline().first());
  }
  ctx.count("joints", joints);
  return {std::make_shared<Table>(rows.take())};
}

}  // namespace

NodeType nodes::check_continuity() {
  return node("check.continuity", run)
      .doc(
          "Says at every joint of curves up to which order they meet parametrically (C) and geometrically "
          "(G).")
      .cite("Barsky & DeRose 1989, IEEE CG&A 9(6):60; errata E64 and E65")
      .covers(114)
      .input("curves", &Inputs::curves,
             "Curves, each beginning where the one before it ends; knots inside are joints, too.")
      .param("orders", &Params::orders, "The highest order that is asked for; raising it asks for more.",
             {.range = between(0, double(continuity::highest_order))})
      .param("tolerance", &Params::tolerance,
             "Relative difference of derivatives up to which they agree; raising it forgives more.",
             {.range = at_least(0)})
      .param("gap", &Params::gap, "How far ends may lie apart and still meet; raising it forgives more.",
             {.unit = "units of the curves", .range = at_least(0)})
      .param("closed", &Params::closed, "Whether the last end meets the first beginning.")
      .output(
          "joints", &Outputs::joints,
          "Where, the highest order of each kind (-1: a gap), and residuals by order (-1: it cannot hold).");
}

}  // namespace frustum
