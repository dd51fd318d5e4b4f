// What is checked once all links are known: cycles, kinds of buffers, spaces, and what is left out.
#pragma once

#include "runtime/graph/flatten.h"

#include <vector>

namespace frustum {

// What is known of an output before anything runs.
struct PortFacts {
  const BufferType* kind = nullptr;  // null: not known
  Spaces spaces = {};                // empty: not known
};

struct Checked {
  std::vector<std::size_t> order;  // of Flat::nodes: feeders first, otherwise as in the files; without cycles
  std::vector<std::vector<PortFacts>> facts;  // [node][output]
};

// Whether what an edge leads to is left out, and why.
LeftOut left_out_by(const Flat&, const Edge&);
std::string why_left_out(const Edge&, const LeftOut&);

// Sets FlatNode::left_out. Cost: linear in nodes and edges, n log n for the order.
Checked check(Flat&, Diagnostics&);

// What feeds an edge, for messages: "cut.mesh", "$mesh", "a literal".
std::string name_of(const Flat&, const Edge&);
PortFacts facts_of(const Flat&, const Checked&, const Edge&);

}  // namespace frustum
