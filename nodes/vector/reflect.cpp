#include "nodes/vector/reflect.h"

#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Vectors> vectors, normals;
};
struct Params {};
struct Outputs {
  Ref<Vectors> vectors;
};

Outputs run(const Inputs& in, const Params&, Context&) {
  const auto &from = in.vectors->along, &normals = in.normals->along;
  if (normals.size() != 1 && normals.size() != from.size())
    throw NodeError(
        "rows_differ",
        fmt::format("{} vectors and {} normals: there must be as many, or one", from.size(), normals.size()),
        at_input("normals"));
  auto out = std::make_shared<Vectors>();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::size_t k = normals.size() == 1 ? 0 : i;
    const auto r = vector::mirrored(from[i], normals[k]);
    if (!r)
      throw NodeError("zero_direction", fmt::format("normal {} has no direction", k), at_input("normals"));
    out->along.push_back(*r);
  }
  return {std::move(out)};
}

}  // namespace

NodeType nodes::vector_reflect() {
  return node("vector.reflect", run)
      .doc("Mirrors vectors about normals of any length: r = 2 n (n.l) / (n.n) - l.")
      .cite("Phong 1975, doi:10.1145/360825.360839; errata E34 and E46")
      .covers(53)
      .input("vectors", &Inputs::vectors, "Directions away from the surface, such as towards a light.")
      .input("normals", &Inputs::normals, "One for each vector, or one for all; the length does not matter.")
      .output("vectors", &Outputs::vectors,
              "The mirror images, as long, on the other side of their normals.");
}

}  // namespace frustum
