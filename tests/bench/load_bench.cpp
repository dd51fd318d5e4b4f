// What it costs to read and check a graph file, per node.
#include "runtime/buffers/value.h"
#include "runtime/graph/load.h"

#include <benchmark/benchmark.h>

#include <stdexcept>

namespace frustum {
namespace {

struct Inputs {
  std::vector<Ref<Number>> numbers;
};
struct Params {
  std::vector<glm::dvec3> points;
  double scale = 1;
};
struct Outputs {
  Ref<Number> number;
};

Outputs run(const Inputs&, const Params&, Context&) { return {}; }

void check_chain(benchmark::State& state) {
  const Registry registry({node("bench.point", run)
                               .input("numbers", &Inputs::numbers, "")
                               .param("points", &Params::points, "")
                               .param("scale", &Params::scale, "")
                               .output("number", &Outputs::number, "")});
  std::string text =
      R"({ "format": "frustum.graph/1", "params": { "size": 2 }, "nodes": { "n0": { "type": "bench.point", "in": { "numbers": [] } })";
  for (int i = 1; i < state.range(0); ++i)
    text += ",\n\"n" + std::to_string(i) + "\": { \"type\": \"bench.point\", \"in\": { \"numbers\": [\"n" +
            std::to_string(i - 1) +
            "\"] }, \"params\": { \"points\": [[0, 1, 0], [1, 0, 0.5]], \"scale\": \"$size\" } }";
  text += " } }";
  for (auto _ : state) {
    const Loaded loaded = load_graph_text(text, "bench.json", registry);
    if (!loaded.graph) throw std::runtime_error(to_text(loaded.problems));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(check_chain)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace frustum
