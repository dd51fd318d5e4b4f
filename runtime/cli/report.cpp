// frustum report GRAPH -o FILE: a run as one page.
#include "runtime/app/report.h"

#include "runtime/app/files.h"
#include "runtime/cli/command.h"
#include "runtime/core/text.h"
#include "runtime/graph/own_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace frustum::cli {
namespace {

struct Arguments {
  GraphArguments graph;
  RunArguments run;
  ReportOptions options;
  std::string file;
};

int report_run(const Arguments& args, bool json) {
  Session session;
  const auto graph = load_or_report(session, args.graph, json, load_options(args.graph));
  if (!graph) return bad_input;
  if (const auto d = overwriting(*graph, args.file, "--output")) return fail(*d, json);
  require_writable(args.file);  // known before minutes of work
  ReportOptions options = args.options;
  options.settings = args.graph.settings;
  if (!args.graph.precision.empty()) options.settings.push_back("precision=" + args.graph.precision);
  apply(args.run, options.run);
  options.run.cancel = &cancel_flag();
  const Report made = make_report(session, *graph, options);
  if (made.page.empty())
    return fail(made.problems, json,
                made.problems.has_errors() && made.result.end == RunResult::End::done
                    ? bad_input
                    : static_cast<Exit>(exit_code(made.result)));
  write_text(args.file, made.page);
  if (json) {
    print(with_diagnostics({{"file", args.file},
                            {"bytes", made.page.size()},
                            {"ports", made.ports},
                            {"peak_bytes", made.result.peak_bytes}},
                           made.problems));
  } else {
    report(made.problems);
    print(fmt::format("{}  {}, {} buffers\n", args.file, human_bytes(made.page.size()), made.ports.size()));
  }
  return done;
}

}  // namespace

void add_report(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c =
      add_command(app, chosen, "report", "Runs a graph and shows everything about it in one HTML page.",
                  "frustum report graphs/gallery/teapot_stages.json --all -o teapot.html",
                  [args, &chosen] { return report_run(*args, chosen.json); });
  add_graph_arguments(c, args->graph);
  c.add_option("-o,--output", args->file, "The page; it needs no other file and no network.")
      ->required()
      ->type_name("FILE");
  c.add_option("--want", args->options.wanted,
               "Only this output or port; repeatable. Without it, every output and every end port.")
      ->type_name("NODE.PORT|OUTPUT")
      ->allow_extra_args(false);
  c.add_flag("--all", args->options.all, "Every port of every node that runs.");
  c.add_option(
       "--max-values", args->options.most_values,
       "Most numbers of one picture in the page; larger ones are thinned to every 2nd, 3rd ... pixel.")
      ->check(quiet(CLI::Range(std::uint64_t{1000}, std::uint64_t{1} << 32)))
      ->capture_default_str()
      ->type_name("N");
  add_run_arguments(c, args->run);
}

}  // namespace frustum::cli
