// frustum diverge GRAPH: where two settings of a graph part, and which node loses the digits.
#include "runtime/app/diverge.h"
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace frustum::cli {
namespace {

struct Arguments {
  GraphArguments graph;
  std::string a, b;
  std::vector<std::string> wanted;
  int threads = 0;
};

std::vector<Setting> settings_of(const std::string& option, const std::string& text) {
  std::vector<Setting> out;
  for (const std::string& s : assignments(text)) {
    const auto equals = s.find('=');
    if (equals == std::string::npos || equals == 0)
      throw UsageError(fmt::format("{} {}: expected ADDR=VALUE, such as precision=single", option, s));
    out.push_back({s.substr(0, equals), s.substr(equals + 1)});
    if (out.back().address == "precision" && out.back().value != "single" && out.back().value != "double")
      throw UsageError(fmt::format("{} {}: precision is single or double", option, s));
  }
  return out;
}

int run(const Arguments& args, bool json) {
  Session session;
  DivergeOptions o;
  o.graph = args.graph.path;
  o.load = load_options(args.graph);
  o.a = settings_of("--a", args.a), o.b = settings_of("--b", args.b);
  o.wanted = args.wanted;
  o.threads = args.threads;
  o.cancel = &cancel_flag();
  Diagnostics problems;
  const auto result = diverge(session, o, problems);
  if (!result) return fail(problems, json);
  if (json)
    print(with_diagnostics(to_json(*result), problems));
  else
    print(diverge_text(*result));
  return done;
}

}  // namespace

void add_diverge(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c =
      add_command(app, chosen, "diverge",
                  "Runs a graph at two settings: the first port that differs, and which node loses what.",
                  "frustum diverge graphs/gallery/teapot.json --a precision=single --b precision=double",
                  [args, &chosen] { return run(*args, chosen.json); });
  add_graph_arguments(c, args->graph);
  c.add_option("--a", args->a, "One setting; without both, precision=single.")->type_name("ADDR=VALUE,...");
  c.add_option("--b", args->b, "The other, which is the reference; without both, precision=double.")
      ->type_name("ADDR=VALUE,...");
  c.add_option("--want", args->wanted, "Only what feeds this output or port; repeatable.")
      ->type_name("NODE.PORT|OUTPUT")
      ->allow_extra_args(false);
  c.add_option("--threads", args->threads, "Threads; 0 takes every processor.")
      ->check(quiet(CLI::Range(0, 4096)))
      ->type_name("N");
}

}  // namespace frustum::cli
