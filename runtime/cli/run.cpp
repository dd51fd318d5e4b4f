// frustum run GRAPH: makes the wanted files and buffers.
#include "runtime/app/effects/plan_effects.h"
#include "runtime/app/files.h"
#include "runtime/app/observers.h"
#include "runtime/cli/command.h"
#include "runtime/cli/progress.h"
#include "runtime/core/text.h"
#include "runtime/graph/own_files.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <set>

namespace frustum::cli {
namespace {

struct Arguments {
  GraphArguments graph;
  RunArguments run;
  CacheArguments cache;
  std::vector<std::string> wanted;
  std::vector<std::string> skipped;
  std::string out = "out", frames, trace, forced;
  int repeat = 0;
  bool events = false;
};

// The most memory that this process ever held, as the system counts it.
std::uint64_t peak_process_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

struct Listeners {
  Observers all;
  std::optional<ProgressBar> bar;
  std::optional<EventStream> events;
  std::optional<Trace> trace;
  std::optional<StepTimes> steps;
};

void write_event(const std::string& line) { std::fputs((line + "\n").c_str(), stderr); }

void attach(Listeners& l, const Arguments& args) {
  if (progress_on_stderr() && !args.events && args.repeat == 0) l.all.add(l.bar.emplace());
  if (args.events) l.all.add(l.events.emplace(fmt::format("{}", ::getpid()), write_event));
  if (!args.trace.empty()) l.all.add(l.trace.emplace());
  if (args.repeat != 0) l.all.add(l.steps.emplace());
}

Json ports_json(const Graph& graph, const RunResult& result) {
  Json ports = Json::object();
  for (const auto& [port, buffer] : result.buffers)
    ports[graph.name(port)] = {
        {"type", buffer.type().name}, {"bytes", buffer.bytes()}, {"digest", to_hex(buffer.digest())}};
  return ports;
}

Json culprit_json(const Culprit& c) {
  return {{"node", c.node},
          {"port", c.port},
          {"where", c.where},
          {"inputs", c.inputs},
          {"values", c.health.values},
          {"nan", c.health.nan},
          {"positive_infinity", c.health.positive_infinity},
          {"negative_infinity", c.health.negative_infinity}};
}

struct Outcome {
  int code = done;
  bool began = false;  // a run, whether or not it came to its end
  std::vector<std::string> files;
  Json ports = Json::object();
  Diagnostics problems;
  std::optional<Culprit> culprit;
  std::uint64_t peak_bytes = 0;
  std::vector<NodeCaching> caching;  // of the last frame
  bool cache_differs = false;
  std::vector<std::chrono::nanoseconds> times;  // of whole runs
  std::set<std::array<std::string, 4>> told;    // code, file, pointer and message of the problems
};

// What --repeat and --cache off say of every node: no cache was asked.
std::vector<NodeCaching> bypassed(const Graph& graph) {
  std::vector<NodeCaching> list;
  for (const GraphNode& n : graph.nodes) list.push_back({.node = n.id});
  return list;
}

// Every frame and repetition has the same warnings.
void add_new(const Diagnostics& more, Outcome& o) {
  for (const Diagnostic& d : more.list())
    if (o.told.insert({d.code, d.file, d.pointer, d.message}).second) o.problems.add(d);
}

// One run of one frame; the outcome gathers over frames and repetitions.
void run_once(Session& session, const Graph& graph, const RunOptions& options, bool keep, Outcome& o) {
  const auto began = std::chrono::steady_clock::now();
  RunResult r = session.run(graph, options, keep);
  o.times.push_back(std::chrono::steady_clock::now() - began);
  o.code = exit_code(r);
  o.peak_bytes = std::max(o.peak_bytes, r.peak_bytes);
  for (std::string& f : r.files)
    if (std::find(o.files.begin(), o.files.end(), f) == o.files.end()) o.files.push_back(std::move(f));
  o.ports = ports_json(graph, r);
  o.caching = std::move(r.caching);
  if (r.cache_differs) o.cache_differs = true;
  if (!keep) o.caching = bypassed(graph);
  if (!o.culprit) o.culprit = r.culprit;
  check_region(graph, options, r, r.problems);
  if (o.code == done && r.problems.has_errors()) o.code = bad_input;
  add_new(r.problems, o);
}

// Each frame would write over the one before.
void check_names_of_frames(const Graph& graph, const Demand& demand, Diagnostics& problems) {
  for (const std::size_t i : demand.outputs) {
    const GraphOutput& output = graph.outputs[i];
    if (output.file.find("{frame}") != std::string::npos) continue;
    problems.add({.code = "file_without_frame",
                  .pointer = output.place.pointer,
                  .message = fmt::format("--frames writes every frame of output '{}' to the same file '{}'",
                                         output.name, output.file),
                  .expected = "a file name with {frame}",
                  .got = output.file,
                  .file = output.place.file,
                  .line = output.place.line,
                  .column = output.place.column});
  }
}

// A trace of that name would take the place of an output.
std::optional<Diagnostic> trace_over_output(const Graph& graph, const RunOptions& options,
                                            const std::string& trace) {
  namespace fs = std::filesystem;
  std::error_code none;
  const auto place = [&](const std::string& path) {
    return fs::weakly_canonical(fs::absolute(path, none), none);
  };
  for (const std::size_t i : options.demand.outputs)
    if (!trace.empty() && place(output_path(graph.outputs[i], options)) == place(trace))
      return Diagnostic{
          .code = "duplicate_file",
          .pointer = "",
          .message = fmt::format("--trace and output '{}' are one file, {}", graph.outputs[i].name, trace),
          .expected = "another file",
          .got = trace};
  return std::nullopt;
}

// Loads the graph for one frame and runs it. False where the rest is not worth trying.
bool run_frame(Session& session, const Arguments& args, bool keep, std::optional<int> frame, bool one_of_many,
               Listeners& listeners, Outcome& o) {
  LoadOptions load = load_options(args.graph);
  load.frame = frame;
  Loaded loaded = session.load(args.graph.path, std::move(load));
  if (!loaded.graph) {
    add_new(loaded.problems, o);
    return o.code = bad_input, false;
  }
  RunOptions options;
  apply(args.run, options);
  Diagnostics of_demand;
  options.demand = demand_of(*loaded.graph, args.wanted, of_demand);
  drop_unused(*loaded.graph, options.demand.ports, loaded.problems);
  add_new(loaded.problems, o);
  o.problems.add(of_demand);
  options.effects = effect_policy(session.registry(), assignments(args.forced), args.skipped, o.problems);
  options.out_folder = args.out;
  options.frame = frame;
  if (auto d = overwriting(*loaded.graph, args.trace, "--trace")) o.problems.add(std::move(*d));
  if (auto d = trace_over_output(*loaded.graph, options, args.trace)) o.problems.add(std::move(*d));
  if (one_of_many) check_names_of_frames(*loaded.graph, options.demand, o.problems);
  if (o.problems.has_errors()) return o.code = bad_input, false;
  o.began = true;
  options.cancel = &cancel_flag();
  options.observer = &listeners.all;
  for (int i = 0; i < std::max(1, args.repeat) && o.code == done; ++i)
    run_once(session, *loaded.graph, options, keep, o);
  return o.code == done;
}

void print_steps(const StepTimes& steps, const Outcome& o) {
  std::vector<std::vector<std::string>> rows{{"step", "min", "median", "runs"}};
  const auto row = [&](const std::string& what, const std::vector<std::chrono::nanoseconds>& times) {
    rows.push_back({what, human_time(*std::min_element(times.begin(), times.end())),
                    human_time(median(times)), std::to_string(times.size())});
  };
  for (const StepTimes::Row& r : steps.rows()) row(r.what, r.times);
  row("whole run", o.times);
  print(aligned(rows));
}

void print_text(const Outcome& o, const Listeners& l, std::chrono::nanoseconds total) {
  report(o.problems);
  if (o.code == cancelled) std::fputs("cancelled\n", stderr);
  if (o.code != done && o.code != check_failed) return;
  for (const std::string& f : o.files) print(f + "\n");
  for (const auto& [name, port] : o.ports.items())
    print(fmt::format("{}  {}  {}  {}\n", name, port["type"].get<std::string>(),
                      human_bytes(port["bytes"].get<std::uint64_t>()), port["digest"].get<std::string>()));
  if (l.steps) print_steps(*l.steps, o);
  std::fputs(fmt::format("{}, buffers {} at most, process {} at most\n", human_time(total),
                         human_bytes(o.peak_bytes), human_bytes(peak_process_bytes()))
                 .c_str(),
             stderr);
}

void print_json(const Outcome& o, const Listeners& l, std::chrono::nanoseconds total) {
  const auto ms = [](std::chrono::nanoseconds t) {
    return std::chrono::duration<double, std::milli>(t).count();
  };
  constexpr auto end_of = [](int code) {
    return code == done           ? "done"
           : code == check_failed ? "cache_differs"
           : code == cancelled    ? "cancelled"
           : code == bad_input    ? "failed"
                                  : "world_failed";
  };
  Json out = {{"end", end_of(o.code)},      {"files", o.files},
              {"ports", o.ports},           {"ms", ms(total)},
              {"peak_bytes", o.peak_bytes}, {"peak_process_bytes", peak_process_bytes()}};
  out["cache"] = to_json(o.caching);
  if (o.culprit) out["culprit"] = culprit_json(*o.culprit);
  if (l.steps) {
    const auto times_json = [&](const std::string& what, const std::vector<std::chrono::nanoseconds>& times) {
      return Json{{"step", what},
                  {"min_ms", ms(*std::min_element(times.begin(), times.end()))},
                  {"median_ms", ms(median(times))},
                  {"runs", times.size()}};
    };
    Json steps = Json::array();
    for (const StepTimes::Row& r : l.steps->rows()) steps.push_back(times_json(r.what, r.times));
    if (!o.times.empty()) steps.push_back(times_json("whole run", o.times));
    out["steps"] = std::move(steps);
  }
  print(with_diagnostics(std::move(out), o.problems));
}

int run(const Arguments& args, bool json) {
  const auto began = std::chrono::steady_clock::now();
  Session session;
  if (!args.trace.empty()) require_writable(args.trace);
  const bool keep = open_cache(args.cache, session) && args.repeat == 0;
  Listeners listeners;
  attach(listeners, args);
  Outcome outcome;
  if (args.frames.empty()) {
    run_frame(session, args, keep, std::nullopt, false, listeners, outcome);
  } else {
    const auto [first, last] = frame_range(args.frames);
    for (int frame = first; frame <= last; ++frame)
      if (!run_frame(session, args, keep, frame, last > first, listeners, outcome)) break;
  }
  if (outcome.code == done && outcome.cache_differs) outcome.code = check_failed;
  listeners.bar.reset();
  const auto total = std::chrono::steady_clock::now() - began;
  if (listeners.trace && outcome.began) write_text(args.trace, listeners.trace->text());
  if (json)
    print_json(outcome, listeners, total);
  else
    print_text(outcome, listeners, total);
  return outcome.code;
}

}  // namespace

void add_run(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c = add_command(app, chosen, "run", "Runs a graph and writes its outputs.",
                            "frustum run graphs/gallery/teapot.json --set samples=4 --out pictures",
                            [args, &chosen] { return run(*args, chosen.json); });
  add_graph_arguments(c, args->graph);
  c.add_option("--want", args->wanted, "Only this output or port; repeatable. Without it, every output.")
      ->type_name("NODE.PORT|OUTPUT")
      ->allow_extra_args(false);
  c.add_option("--out", args->out, "The folder that files are written under.")
      ->capture_default_str()
      ->type_name("DIR");
  c.add_option("--frames", args->frames, "Sets the graph parameter frame to each of these in turn.")
      ->type_name("A-B");
  c.add_flag("--force-effects{all}", args->forced,
             "Simulates effects that the scene does not call for: all, or =NAME,...; the same bytes.")
      ->type_name("[=NAME,...]");
  c.add_option("--skip-effects", args->skipped,
               "Leaves these effects out, whatever the scene calls for: another picture.")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,...");
  add_run_arguments(c, args->run);
  add_cache_arguments(c, args->cache);
  c.add_option("--trace", args->trace, "Writes a timeline in the Chrome trace format.")->type_name("FILE");
  c.add_option("--repeat", args->repeat,
               "Runs this often without the cache and prints the times of every step.")
      ->check(quiet(CLI::Range(1, 1000000)))
      ->type_name("N");
  c.add_flag("--events", args->events, "Events as JSON lines on stderr.");
}

}  // namespace frustum::cli
