#include "nodes/curve/power.h"

#include "nodes/curve.h"
#include "runtime/buffers/curve.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  std::optional<Ref<Curve>> curve;
};
struct Params {
  std::vector<glm::dvec3> coefficients;
};
struct Outputs {
  Ref<Curve> curve;
  Ref<Table> coefficients;
};

constexpr std::size_t highest_degree = 100;

Table empty_table() {
  Table t;
  t.columns = {{.name = "piece"}, {.name = "power"}, {.name = "x"},
               {.name = "y"},     {.name = "z"},     {.name = "amplification"}};
  return t;
}

// One piece: its coefficients become rows, and points again.
template <class R>
void add_piece(std::size_t piece, std::span<const glm::vec<3, R>> coefficients, Table& table,
               std::vector<glm::dvec3>& points) {
  const auto bezier = kernels::bezier_of_power(coefficients);
  double largest = 0;
  for (const auto& p : bezier) largest = std::max(largest, double(kernels::largest_component(p)));
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const glm::dvec3 a(coefficients[i]);
    const double worst =
        power::amplification(coefficients.size() - 1, i, kernels::largest_component(a), largest);
    const double row[] = {double(piece), double(i), a.x, a.y, a.z, worst};
    for (std::size_t k = 0; k < table.columns.size(); ++k) table.columns[k].numbers.push_back(row[k]);
  }
  for (std::size_t i = points.empty() ? 0 : 1; i < bezier.size(); ++i) points.emplace_back(bezier[i]);
}

template <class R>
std::vector<glm::vec<3, R>> coefficients_of(const kernels::Spline& s, std::size_t span) {
  std::vector<glm::vec<3, R>> p;
  for (const glm::dvec4& h : kernels::bezier_points(s, span, s.knots[span], s.knots[span + 1]))
    p.emplace_back(glm::dvec3(h));
  return kernels::power_of_bezier(std::span<const glm::vec<3, R>>(p));
}

void check_degree(std::size_t degree, const char* where, bool input) {
  if (degree > highest_degree)
    throw NodeError("too_large",
                    fmt::format("degree {}: powers up to {} have coefficients that mean anything", degree,
                                highest_degree),
                    input ? at_input(where) : at_param(where));
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  if (in.curve.has_value() == !p.coefficients.empty())
    throw NodeError("wrong_count", "link a curve or write coefficients: one of both",
                    at_param("coefficients"));
  auto table = std::make_shared<Table>(empty_table());
  std::vector<glm::dvec3> points;
  std::size_t degree = 0;
  if (in.curve) {
    const kernels::Spline s = (*in.curve)->spline();
    if (s.rational())
      throw NodeError("rational_curve", "a rational curve is no polynomial: it has no coefficients",
                      at_input("curve"));
    check_degree(degree = s.degree, "curve", true);
    std::size_t piece = 0;
    for (const std::size_t span : kernels::spans_of(s)) {
      ctx.real([&]<class R>() {
        const auto a = coefficients_of<R>(s, span);
        add_piece(piece, std::span<const glm::vec<3, R>>(a), *table, points);
      });
      ++piece, ctx.poll();
    }
  } else {
    check_degree(degree = p.coefficients.size() - 1, "coefficients", false);
    ctx.real([&]<class R>() {
      const std::vector<glm::vec<3, R>> a(p.coefficients.begin(), p.coefficients.end());
      add_piece(0, std::span<const glm::vec<3, R>>(a), *table, points);
    });
  }
  double worst = 0;
  for (const double x : table->columns[5].numbers) worst = std::max(worst, x);
  if (worst * (ctx.precision == Precision::single ? 0x1p-24 : 0x1p-53) > 1e-3)
    ctx.warn("ill_conditioned",
             fmt::format("rounding in the points shows {:.2g} times in a coefficient", worst));
  return {std::make_shared<Curve>(bezier_chain(std::move(points), degree)), std::move(table)};
}

}  // namespace

NodeType nodes::curve_power() {
  return node("curve.power", run)
      .doc(
          "Makes a curve of the coefficients of its powers, or gives those of a curve and what rounding left "
          "of it.")
      .cite("Farouki & Rajan 1987, CAGD 4:191 (the condition of both bases); errata E66")
      .covers(115)
      .input("curve", &Inputs::curve, "A polynomial curve to take apart, instead of coefficients.")
      .param("coefficients", &Params::coefficients,
             "a_0, a_1 ... of a_0 + a_1 t + a_2 t^2 + ... over [0, 1]; x, y and z.")
      .output("curve", &Outputs::curve,
              "The curve of the coefficients, each piece over an interval of length 1.")
      .output("coefficients", &Outputs::coefficients,
              "Rows a_i of each piece by its own t in [0, 1], and how many times an error in its points "
              "shows there.");
}

}  // namespace frustum
