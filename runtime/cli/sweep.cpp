// frustum sweep GRAPH: what accuracy costs in time.
#include "runtime/app/sweep/markdown.h"
#include "runtime/app/sweep/report.h"
#include "runtime/cli/command.h"
#include "runtime/core/text.h"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cstdio>

namespace frustum::cli {
namespace {

struct Arguments {
  GraphArguments graph;
  SweepOptions options;
  std::string reference;
};

// A line that is written over, on a terminal only.
void show_progress(std::size_t done, std::size_t all, const std::string& what) {
  std::fputs(fmt::format("\r\x1b[K{} of {}  {}", done, all, what).c_str(), stderr);
  std::fflush(stderr);
}

int sweep(Arguments args, bool json) {
  Session session;
  SweepOptions& o = args.options;
  o.graph = args.graph.path;
  o.load = load_options(args.graph);
  o.cancel = &cancel_flag();
  o.reference = assignments(args.reference);
  if (o.folder.empty()) throw UsageError("--out is empty: name a folder, such as out/sweep");
  if (!o.reference.empty() && !o.reference_file.empty())
    throw UsageError("--reference and --reference-file exclude each other");
  const bool terminal = progress_on_stderr();
  if (terminal) o.progress = show_progress;
  Diagnostics problems;
  std::optional<Sweep> result;
  try {
    result = run_sweep(session, o, problems);
  } catch (const Cancelled&) {
    if (terminal) std::fputs("\r\x1b[K", stderr);
    std::fputs(fmt::format("cancelled; what is finished lies in {}: --resume goes on from there\n", o.folder)
                   .c_str(),
               stderr);
    return cancelled;
  }
  if (terminal) std::fputs("\r\x1b[K", stderr);
  if (!result) return fail(problems, json);
  const auto files = write_sweep(*result);
  if (!o.markdown.empty() && !json) {
    const std::filesystem::path target = o.markdown;
    return print(sweep_markdown(*result, target.parent_path(), target.filename().string())), done;
  }
  if (json) {
    Json out = to_json(*result);
    out["files"] = files;
    print(with_diagnostics(std::move(out), problems));
    return done;
  }
  report(problems);
  print(sweep_text(*result, 12));
  for (const std::string& f : files) print(f + "\n");
  return done;
}

}  // namespace

void add_sweep(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c = add_command(app, chosen, "sweep",
                            "Runs a graph at many settings: error against time, slopes, best buys.",
                            "frustum sweep graphs/gallery/teapot.json --knob samples=1,4,16,64 -o out/sweep",
                            [args, &chosen] { return sweep(*args, chosen.json); });
  SweepOptions& o = args->options;
  add_graph_arguments(c, args->graph);
  c.add_option(
       "--knob", o.knobs,
       "Turn this, from cheap to exact; without values, those it declares. Without any, every declared knob.")
      ->type_name("ADDR[=V1,V2,...]")
      ->allow_extra_args(false);
  c.add_flag("--grid", o.grid, "Every combination instead of one knob at a time.");
  c.add_option("--reference", args->reference, "What is exact; without it, every knob at its last value.")
      ->type_name("ADDR=VALUE,...");
  c.add_option("--reference-file", o.reference_file, "A picture that is exact.")->type_name("FILE");
  c.add_option("--metric", o.metrics, "How errors are measured; the first one is plotted.")
      ->type_name("M")
      ->default_str("rmse")
      ->allow_extra_args(false);
  c.add_option("--want", o.want, "The output or port that is measured; without it, the first output.")
      ->type_name("NODE.PORT|OUTPUT");
  c.add_option("--repeats", o.repeats, "Timed runs of each point, in turns.")
      ->check(quiet(CLI::Range(1, 10000)))
      ->capture_default_str()
      ->type_name("N");
  c.add_option("--threads", o.threads, "Threads; 0 takes every processor.")
      ->check(quiet(CLI::Range(0, 4096)))
      ->type_name("N");
  c.add_flag("--resume", o.resume, "Go on with a sweep that was cut off.");
  c.add_option("--markdown", o.markdown,
               "Prints a part of a page for docs/, whose pictures are written beside this path and begin "
               "with its name.")
      ->type_name("FOLDER/NAME");
  c.add_option("-o,--out", o.folder, "The folder for sweep.html, .json, .csv and the journal.")
      ->required()
      ->type_name("DIR");
}

}  // namespace frustum::cli
