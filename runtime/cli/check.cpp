// frustum check GRAPH...: every problem of a graph, none of its work.
#include "runtime/cli/command.h"
#include "runtime/core/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace frustum::cli {
namespace {

struct Arguments {
  std::vector<std::string> graphs, settings;
};

// Adds the problems of one graph, or says that there are none.
void check_one(const Session& session, const std::string& path, LoadOptions options, Diagnostics& all,
               std::string& good) {
  const Loaded loaded = session.load(path, std::move(options));
  all.add(loaded.problems);
  if (loaded.graph)
    good += fmt::format("{}: {} nodes, {} outputs, no errors\n", path, loaded.graph->nodes.size(),
                        loaded.graph->outputs.size() + named_ports(*loaded.graph).size());
}

int check(const Arguments& args, bool json) {
  const Session session;
  Diagnostics all;
  std::string good;
  bool all_read = true;
  for (const std::string& path : args.graphs) {
    try {
      check_one(session, path, load_options({path, args.settings, {}}), all, good);
    } catch (const WorldError& e) {  // of one file: the others are checked all the same
      all.add({.code = e.code, .pointer = "", .message = e.what(), .file = path});
      all_read = false;
    }
  }
  const Exit exit = !all_read ? world_failed : all.has_errors() ? bad_input : done;
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
