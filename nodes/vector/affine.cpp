#include "nodes/vector/affine.h"

#include "nodes/kernels/vector.h"
#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Points> points;
};
struct Params {
  std::vector<std::vector<double>> weights;
  kernels::Summation sum = kernels::Summation::exact;
};
struct Outputs {
  Ref<Points> points;
  Ref<Table> drift;
};

void check(const Params& p) {
  for (std::size_t i = 0; i < p.weights.size(); ++i)
    if (!kernels::adds_up_to_one(p.weights[i]))
      throw NodeError(
          "not_affine",
          fmt::format("row {} of the weights adds up to {}: only a sum of 1 makes a point of points", i,
                      1 + kernels::drift_of(p.weights[i])),
          at_param(fmt::format("weights/{}", i)));
}

Outputs run(const Inputs& in, const Params& p, Context&) {
  const auto& points = in.points->at;
  auto drift = std::make_shared<Table>();
  drift->columns = {{.name = "row"}, {.name = "sum_minus_1"}, {.name = "error_of_plain"}};
  for (std::size_t i = 0; i < p.weights.size(); ++i) {
    const auto& row = p.weights[i];
    if (row.size() != points.size())
      throw NodeError("rows_differ", fmt::format("{} weights for {} points", row.size(), points.size()),
                      at_param(fmt::format("weights/{}", i)));
    const glm::dvec3 off = kernels::affine_combination(row, points, kernels::Summation::plain) -
                           kernels::affine_combination(row, points, kernels::Summation::exact);
    drift->columns[0].numbers.push_back(static_cast<double>(i));
    drift->columns[1].numbers.push_back(kernels::drift_of(row));
    drift->columns[2].numbers.push_back(kernels::largest_component(off));
  }
  return {std::make_shared<Points>(Points{vector::affine_combinations(p.weights, points, p.sum)}),
          std::move(drift)};
}

}  // namespace

NodeType nodes::vector_affine() {
  return node("vector.affine", run)
      .doc("Combines points with weights whose sum is 1: a point, which every affine map takes along.")
      .cite("Goldman 2002, Pyramid Algorithms, chapter 1")
      .covers(2)
      .input("points", &Inputs::points, "What is combined.")
      .param("weights", &Params::weights, "Rows of factors, one for each point; each row adds up to 1.")
      .param("sum", &Params::sum, "plain drifts by the weights' rounding times the distance from the origin.")
      .knob({"plain", "compensated", "exact"},
            "The others add ways from the heaviest point and do not drift.")
      .check(check)
      .output("points", &Outputs::points, "One point for every row of weights.")
      .output("drift", &Outputs::drift,
              "What rounding left of each row's sum minus 1, and what it does to a plain sum.");
}

}  // namespace frustum
