#include "nodes/vector/add.h"

#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Points> points;
  Ref<Vectors> vectors;
};
struct Params {
  double scale = 1;
};
struct Outputs {
  Ref<Points> points;
};

Outputs run(const Inputs& in, const Params& p, Context&) {
  const auto& from = in.points->at;
  const auto& by = in.vectors->along;
  if (by.size() != 1 && by.size() != from.size())
    throw NodeError(
        "rows_differ",
        fmt::format("{} points plus {} vectors: there must be as many, or one", from.size(), by.size()),
        at_input("vectors"));
  return {std::make_shared<Points>(Points{vector::moved(from, by, p.scale)})};
}

}  // namespace

NodeType nodes::vector_add() {
  return node("vector.add", run)
      .doc("Moves points by vectors, which leaves points: w is 1 + 0 = 1. Two points have no sum.")
      .covers(4)
      .input("points", &Inputs::points, "Where the ways start.")
      .input("vectors", &Inputs::vectors, "The ways: as many vectors, or one for all.")
      .param("scale", &Params::scale, "Times each vector; raising it moves further, below 0 back.")
      .output("points", &Outputs::points, "Where the ways end.");
}

}  // namespace frustum
