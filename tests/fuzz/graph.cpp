// Graph files: loaded, checked and flattened, with every node type of this build.
#include "runtime/graph/load.h"

#include "nodes/all_nodes.h"
#include "runtime/app/session.h"
#include "runtime/io/buffer_files.h"
#include "runtime/io/color.h"
#include "tests/fuzz/support/check.h"
#include "tests/fuzz/support/target.h"
#include "tests/support/source_dir.h"

namespace frustum::fuzz {
namespace {

const Registry& registry() {
  static const Registry all(all_node_types());
  return all;
}

void read(std::string_view input) {
  // A folder with graphs in it, so that graphs as nodes are opened.
  static const std::string folder = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/";
  static const LoadOptions options{
      .library_folders = {folder + "lib"}, .to_linear = to_linear_rec709, .saved_as = saved_as};
  const std::string file = folder + "input.json";
  const Loaded loaded = load_graph_text(std::string(input), file, registry(), options);
  check_problems(loaded.problems, file, input);
  require(loaded.graph.has_value() != loaded.problems.has_errors(),
          "a graph and its problems contradict each other");
  if (!loaded.graph) return;
  for (const GraphNode& node : loaded.graph->nodes)
    require(node.inputs.size() == node.type->inputs.size(), node.id);
  Diagnostics none;
  demand_of(*loaded.graph, {}, none);
  require(none.empty(), "a graph that was checked has outputs that nobody makes");
}
const Registered graph({"graph", read, {std::size_t{1} << 24, 8192}});

}  // namespace
}  // namespace frustum::fuzz
