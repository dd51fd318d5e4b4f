// What a run will do, decided before it starts: which nodes, in which order, what is fused, what must be whole.
#pragma once

#include "runtime/graph/graph.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace frustum {

struct Demand {
  std::vector<PortRef> ports;         // whole buffers for the caller: inspections, --want NODE.PORT
  std::vector<std::size_t> outputs;   // indices of Graph::outputs to write
};

// Why a pixel port is held whole in memory instead of streaming.
enum class Whole : std::uint8_t { demanded, read_whole, recomputed_too_often, not_fused };
std::string_view name_of(Whole);

struct PlannedNode {
  std::size_t node = 0;
  std::uint64_t wanted_outputs = 0;        // bit i: somebody reads the i-th output
  std::vector<std::string> wanted_by;      // who pulls it in: consumers' ids and output names
};

// Pixel nodes that stream together: one pass over tiles gives every root.
struct PixelPass {
  std::vector<std::size_t> nodes;          // in running order
  struct Root {
    PortRef port;
    Whole why;
  };
  std::vector<Root> roots;                 // materialized by this pass
  std::vector<std::size_t> outputs;        // Graph::outputs that this pass streams to sinks
};

// One step; steps run in order of their dependencies, independent geometry in parallel.
struct Step {
  std::optional<std::size_t> node;         // a geometry node (index into Plan::nodes' node numbers)
  std::optional<std::size_t> pass;         // or a pass (index into Plan::passes)
  std::vector<std::size_t> after;          // earlier steps
};

struct Plan {
  std::vector<PlannedNode> nodes;          // those that run, in the graph's order
  std::vector<std::size_t> skipped;        // graph nodes that nobody asked for
  std::vector<PixelPass> passes;
  std::vector<Step> steps;
};

struct PlanOptions {
  bool fuse = true;                        // false: every pixel node's outputs become whole
};

Plan make_plan(const Graph&, const Demand&, const PlanOptions& = {});

}  // namespace frustum
