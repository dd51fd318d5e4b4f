// frustum check GRAPH...: every problem of a graph, none of its work.
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace frustum::cli {
namespace {

struct Arguments {
  std::vector<std::string> graphs, settings;
};

int check(const Arguments& args, bool json) {
  const Session session;
  Diagnostics all;
  std::string good;
  bool world = false;
  for (const std::string& path : args.graphs) try {
      const Loaded loaded = session.load(path, load_options({path, args.settings, {}}));
      all.add(loaded.problems);
      if (loaded.graph)
        good += fmt::format("{}: {} nodes, {} outputs, no errors\n", path, loaded.graph->nodes.size(),
                            loaded.graph->outputs.size() + named_ports(*loaded.graph).size());
    } catch (const WorldError& e) {  // of one file: the others are checked all the same
      all.add({.code = e.code, .pointer = "", .message = e.what(), .file = path});
      world = true;
    }
  const Exit exit = world ? world_failed : all.has_errors() ? bad_input : done;
  if (json) {
    print(with_diagnostics({{"ok", exit == done}}, all));
    return exit;
  }
  report(all);
  print(good);
  return exit;
}

}  // namespace

void add_check(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c = add_command(app, chosen, "check", "Names every problem of a graph, and runs nothing.",
                            "frustum check graphs/gallery/*.json",
                            [args, &chosen] { return check(*args, chosen.json); });
  c.add_option("graphs", args->graphs, "The graph files.")->required()->type_name("GRAPH");
  c.add_option("--set", args->settings, "A graph parameter or a node's; repeatable.")
      ->type_name("ADDR=VALUE")
      ->allow_extra_args(false);
}

}  // namespace frustum::cli
