#include "nodes/vector/linear.h"

#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Vectors> vectors;
};
struct Params {
  std::vector<std::vector<double>> weights;
  kernels::Summation sum = kernels::Summation::exact;
};
struct Outputs {
  Ref<Vectors> vectors;
  Ref<Table> errors;
};

// What the chosen sum and a plain one are off by.
Table errors_of(const Params& p, std::span<const glm::dvec3> v, std::span<const glm::dvec3> result) {
  const auto exact = vector::combinations(p.weights, v, kernels::Summation::exact);
  const auto plain = vector::combinations(p.weights, v, kernels::Summation::plain);
  Table t;
  t.columns = {{.name = "row"}, {.name = "error"}, {.name = "error_of_plain"}};
  for (std::size_t i = 0; i < exact.size(); ++i) {
    t.columns[0].numbers.push_back(static_cast<double>(i));
    t.columns[1].numbers.push_back(kernels::largest_component(result[i] - exact[i]));
    t.columns[2].numbers.push_back(kernels::largest_component(plain[i] - exact[i]));
  }
  return t;
}

Outputs run(const Inputs& in, const Params& p, Context&) {
  const auto& v = in.vectors->along;
  const std::size_t bad = vector::first_of_other_length(p.weights, v.size());
  if (bad < p.weights.size())
    throw NodeError("rows_differ", fmt::format("{} weights for {} vectors", p.weights[bad].size(), v.size()),
                    at_param(fmt::format("weights/{}", bad)));
  auto result = vector::combinations(p.weights, v, p.sum);
  auto errors = std::make_shared<Table>(errors_of(p, v, result));
  return {std::make_shared<Vectors>(Vectors{std::move(result)}), std::move(errors)};
}

}  // namespace

NodeType nodes::vector_linear() {
  return node("vector.linear", run)
      .doc("Adds multiples of vectors: a vector for every row of weights.")
      .cite("Ogita, Rump & Oishi 2005, SIAM J. Sci. Comput. 26:1955; errata E1")
      .covers(1)
      .input("vectors", &Inputs::vectors, "What is combined.")
      .param("weights", &Params::weights, "Rows of factors, one for each vector.")
      .param("sum", &Params::sum,
             "How the products are added; where large ones cancel, only exact keeps all digits.")
      .knob({"plain", "compensated", "exact"},
            "Twice the precision, then a single rounding, for some times the work.")
      .output("vectors", &Outputs::vectors, "One sum for every row of weights.")
      .output("errors", &Outputs::errors, "How far this sum and a plain one are from the exact one.");
}

}  // namespace frustum
