#include "nodes/transform/compose.h"

#include "nodes/kernels/matrix.h"
#include "nodes/transform.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  std::vector<Ref<Matrix>> maps;
};
struct Params {};
struct Outputs {
  Ref<Matrix> matrix;
  Ref<Number> rcond;
};

Outputs run(const Inputs& in, const Params&, Context&) {
  std::vector<glm::dmat4> maps;
  for (const auto& m : in.maps) maps.push_back(m->value);
  const glm::dmat4 all = transform::composed(maps);
  const auto back = kernels::inverse<4>(all);
  return {std::make_shared<Matrix>(Matrix{all}), std::make_shared<Number>(Number{back ? back->rcond : 0.0})};
}

}  // namespace

NodeType nodes::transform_compose() {
  return node("transform.compose", run)
      .doc(
          "Makes one map of several: the first of the list acts first, so it stands at the right of the "
          "product.")
      .cite("Errata E6 and E13")
      .covers(16)
      .input("maps", &Inputs::maps, "Matrices in the order in which they act.")
      .output("matrix", &Outputs::matrix, "Their product, each entry of each step rounded once.")
      .output("rcond", &Outputs::rcond,
              "How well it can be undone: 1 at best, 0 for a map that has no inverse.");
}

}  // namespace frustum
