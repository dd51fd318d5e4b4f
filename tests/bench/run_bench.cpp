// What the runtime costs on top of the nodes' own work: graphs of a thousand nodes that do nothing.
#include "runtime/buffers/value.h"
#include "runtime/graph/run.h"

#include <benchmark/benchmark.h>

#include <stdexcept>

namespace frustum {
namespace {

struct Inputs {
  std::vector<Ref<Number>> numbers;
};
struct Params {};
struct Outputs {
  Ref<Number> number;
};

const Ref<Number> one = std::make_shared<Number>(Number{1});

Outputs run(const Inputs&, const Params&, Context&) { return {one}; }

const NodeType& trivial() {
  static const NodeType type = node("bench.trivial", run)
                                   .doc("Gives the same number every time.")
                                   .input("numbers", &Inputs::numbers, "Read by nobody.")
                                   .output("number", &Outputs::number, "One.");
  return type;
}

GraphNode trivial_node(std::size_t i, std::vector<Source> from) {
  GraphNode n;
  n.id = "n" + std::to_string(i);
  n.type = &trivial();
  n.params = n.type->default_params();
  n.inputs = {std::move(from)};
  return n;
}

// Layers of `width` nodes; each reads two of the layer before.
Graph layers(std::size_t count, std::size_t width) {
  Graph g;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<Source> from;
    if (i >= width) {
      const std::size_t below = i - i % width - width;
      from = {PortRef{below + i % width, 0}, PortRef{below + (i + 1) % width, 0}};
    }
    g.nodes.push_back(trivial_node(i, std::move(from)));
  }
  return g;
}

void run_layers(benchmark::State& state) {
  const auto width = static_cast<std::size_t>(state.range(0));
  const Graph g = layers(1000, width);
  RunOptions options;
  for (std::size_t i = 1000 - width; i < 1000; ++i) options.demand.ports.push_back({i, 0});
  for (auto _ : state)
    if (run_graph(g, options).end != RunResult::End::done) throw std::runtime_error("the run failed");
  state.counters["ns_per_node"] =
      benchmark::Counter(1000, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(run_layers)
    ->Name("graph_of_1000_trivial_nodes/width")
    ->Arg(1)
    ->Arg(10)
    ->Arg(100)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace frustum
