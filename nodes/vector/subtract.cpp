#include "nodes/vector/subtract.h"

#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Points> points, from;
};
struct Params {};
struct Outputs {
  Ref<Vectors> vectors;
};

Outputs run(const Inputs& in, const Params&, Context&) {
  const auto &p = in.points->at, &q = in.from->at;
  if (q.size() != 1 && q.size() != p.size())
    throw NodeError("rows_differ",
                    fmt::format("{} points minus {}: there must be as many, or one", p.size(), q.size()),
                    at_input("from"));
  return {std::make_shared<Vectors>(Vectors{vector::differences(p, q)})};
}

}  // namespace

NodeType nodes::vector_subtract() {
  return node("vector.subtract", run)
      .doc("Takes points from points, which leaves vectors: w is 1 - 1 = 0.")
      .covers(4)
      .input("points", &Inputs::points, "Where the vectors end.")
      .input("from", &Inputs::from, "Where they start: as many points, or one for all.")
      .output("vectors", &Outputs::vectors, "The ways from each start to each end.");
}

}  // namespace frustum
