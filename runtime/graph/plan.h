// What a run will do, decided before it starts: which nodes, in which order, what is fused, what must be whole.
#pragma once

#include "runtime/graph/graph.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace frustum {

struct Demand {
  std::vector<PortRef> ports = {};        // whole buffers for the caller: inspections, --want NODE.PORT
  std::vector<std::size_t> outputs = {};  // indices of Graph::outputs to write
};

// Why a pixel port is held whole in memory instead of streaming.
enum class Whole : std::uint8_t { demanded, read_whole, not_fused };
std::string_view name_of(Whole);

struct PlannedNode {
  std::size_t node = 0;
  std::uint64_t wanted_outputs = 0;    // bit i: somebody reads the i-th output
  std::vector<std::string> wanted_by;  // who pulls it in: consumers' ids, output names, "demand"
};

// Pixel nodes that stream together: one walk over tiles gives every root and feeds every output.
struct PixelPass {
  struct Root {
    PortRef port;
    Whole why;
  };
  std::vector<std::size_t> nodes;    // in running order
  std::vector<Root> roots;           // made whole by this pass
  std::vector<std::size_t> outputs;  // Graph::outputs that this pass streams to their sinks
};

// A geometry node runs, a pixel node is prepared, or a pass walks its tiles.
struct Step {
  enum class Kind : std::uint8_t { node, pass };
  Kind kind = Kind::node;
  std::size_t index = 0;                    // of Graph::nodes or Plan::passes
  std::vector<std::size_t> followers = {};  // steps that wait for this one
  std::size_t waits_for = 0;                // how many steps it waits for
};

struct Plan {
  std::vector<PlannedNode> nodes;    // those that run, in the graph's order
  std::vector<std::size_t> skipped;  // graph nodes that nobody asked for
  std::vector<PixelPass> passes;     // in running order
  std::vector<Step> steps;           // a step stands after those it waits for
};

struct PlanOptions {
  bool fuse = true;  // false: every pixel port that is read becomes whole
  // A region is asked for: ports that are whole only because they are demanded hold no more than that, so nodes that read
  // them by tiles do not read them from memory.
  bool cropped = false;
  // Ports whose buffers are there already (from the cache): nothing is run for them.
  std::function<bool(PortRef)> given = {};
};

// Walks back from what is demanded. Pixel nodes fuse through tiled inputs; a port is made whole where the caller or a node
// needs all of it. Passes that share nodes at the same depth of "whole" are one pass. Cost: linear in nodes and links.
Plan make_plan(const Graph&, const Demand&, const PlanOptions& = {});

}  // namespace frustum
