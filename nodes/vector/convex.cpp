#include "nodes/vector/convex.h"

#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Points> points;
};
struct Params {
  std::vector<std::vector<double>> weights;
};
struct Outputs {
  Ref<Points> points;
};

void check(const Params& p) {
  for (std::size_t i = 0; i < p.weights.size(); ++i) {
    const auto& row = p.weights[i];
    const std::size_t k = vector::first_negative(row);
    if (k < row.size())
      throw NodeError(
          "not_convex",
          fmt::format("weight {} of row {} is {}: a convex combination has none below 0", k, i, row[k]),
          at_param(fmt::format("weights/{}/{}", i, k)));
    if (!kernels::adds_up_to_one(row))
      throw NodeError(
          "not_affine",
          fmt::format("row {} of the weights adds up to {} and not to 1", i, 1 + kernels::drift_of(row)),
          at_param(fmt::format("weights/{}", i)));
  }
}

Outputs run(const Inputs& in, const Params& p, Context&) {
  auto out = std::make_shared<Points>();
  for (std::size_t i = 0; i < p.weights.size(); ++i) {
    if (p.weights[i].size() != in.points->at.size())
      throw NodeError("rows_differ",
                      fmt::format("{} weights for {} points", p.weights[i].size(), in.points->at.size()),
                      at_param(fmt::format("weights/{}", i)));
    out->at.push_back(vector::convex_combination(p.weights[i], in.points->at));
  }
  return {std::move(out)};
}

}  // namespace

NodeType nodes::vector_convex() {
  return node("vector.convex", run)
      .doc("Combines points with weights of sum 1, none negative: a point of their convex hull.")
      .cite("Errata E2")
      .covers(3)
      .input("points", &Inputs::points, "The corners of the hull, and what else lies in it.")
      .param("weights", &Params::weights,
             "Rows of factors from 0 to 1, one for each point; each row adds up to 1.")
      .check(check)
      .output("points", &Outputs::points, "One point for every row of weights.");
}

}  // namespace frustum
