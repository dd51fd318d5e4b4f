// Graphs from text, and what their last node makes: what the benchmarks of whole runs have in common.
#pragma once

#include "runtime/graph/load.h"
#include "runtime/graph/run.h"

#include <stdexcept>
#include <string>

namespace frustum::bench {

// Throws std::runtime_error with the problems of a graph that cannot be loaded, or run.
inline Graph graph_of(const std::string& text, const Registry& registry) {
  const auto loaded = load_graph_text(text, "bench.json", registry);
  if (!loaded.graph) throw std::runtime_error(to_text(loaded.problems));
  return *loaded.graph;
}

// The first output of the last node.
inline Buffer result_of(const Graph& graph) {
  const PortRef last{graph.nodes.size() - 1, 0};
  RunOptions options;
  options.demand.ports.push_back(last);
  const RunResult result = run_graph(graph, options);
  if (result.end != RunResult::End::done) throw std::runtime_error(to_text(result.problems));
  return result.buffers.at(last);
}

}  // namespace frustum::bench
