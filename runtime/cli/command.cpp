#include "runtime/cli/command.h"

#include "runtime/app/simd.h"
#include "runtime/core/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <limits>

namespace frustum::cli {

CLI::Validator quiet(CLI::Validator check) { return check.description(""), check; }

CLI::App& add_command(CLI::App& app, Invocation& chosen, const std::string& name, const std::string& what,
                      const std::string& example, std::function<int()> body) {
  CLI::App* command = app.add_subcommand(name, what);
  command->footer("\nExample:\n  " + example);
  command->add_flag("--json", chosen.json, "One JSON object on stdout; logs stay on stderr.");
  command->callback([&chosen, body = std::move(body)] { chosen.body = body; });
  return *command;
}

void add_graph_arguments(CLI::App& app, GraphArguments& args) {
  app.add_option("graph", args.path, "The graph file.")->required()->type_name("GRAPH");
  app.add_option("--set", args.settings,
                 "A graph parameter (samples=4) or a node's (lit:interpolation=flat); repeatable.")
      ->type_name("ADDR=VALUE")
      ->allow_extra_args(false);
  app.add_option("--precision", args.precision, "The Real in which nodes compute, above the graph's own.")
      ->check(quiet(CLI::IsMember({"single", "double"})))
      ->type_name("single|double");
}

LoadOptions load_options(const GraphArguments& args) {
  LoadOptions options;
  for (const std::string& s : args.settings) {
    const auto equals = s.find('=');
    if (equals == std::string::npos || equals == 0)
      throw UsageError(fmt::format("--set {}: expected ADDR=VALUE, such as samples=4", s));
    options.settings.push_back({s.substr(0, equals), s.substr(equals + 1)});
  }
  if (args.precision == "single") options.precision = Precision::single;
  if (args.precision == "double") options.precision = Precision::real_double;
  return options;
}

void drop_unused(const Graph& graph, std::span<const PortRef> asked, Diagnostics& warnings) {
  std::vector<bool> feeds(graph.nodes.size(), false);
  for (const PortRef p : asked) feeds[p.node] = true;
  for (std::size_t n = graph.nodes.size(); n-- > 0;)  // feeders stand before their consumers
    for (const auto& sources : graph.nodes[n].inputs)
      for (const Source& s : sources)
        if (const auto* from = std::get_if<PortRef>(&s); from != nullptr && feeds[n])
          feeds[from->node] = true;
  std::set<std::string> places;
  for (std::size_t n = 0; n < feeds.size(); ++n)
    if (feeds[n]) places.insert(graph.nodes[n].place.file + graph.nodes[n].place.pointer);
  std::erase_if(warnings.list(), [&](const Diagnostic& d) {
    return d.code == "unused_node" && places.contains(d.file + d.pointer);
  });
}

std::optional<Graph> load_or_report(const Session& session, const GraphArguments& args, bool json,
                                    LoadOptions options, Diagnostics* warnings) {
  Loaded loaded = session.load(args.path, std::move(options));
  if (!loaded.graph)
    fail(loaded.problems, json);
  else if (warnings != nullptr)
    warnings->add(loaded.problems);
  else
    report(loaded.problems);
  return std::move(loaded.graph);
}

void add_memory_argument(CLI::App& app, std::string& memory) {
  app.add_option("--memory", memory,
                 "Most bytes of buffers that may be live at once; a run that needs more is refused, exit 2.")
      ->type_name("SIZE");
}

std::uint64_t memory_limit(const std::string& memory) {
  if (memory.empty()) return 0;
  const auto bytes = parse_bytes(memory);
  if (!bytes || *bytes == 0)
    throw UsageError(fmt::format("--memory {}: expected a size such as 512M or 2G", memory));
  return *bytes;
}

void add_run_arguments(CLI::App& app, RunArguments& args) {
  app.add_option("--threads", args.threads,
                 "Threads; 0 takes every processor. The bytes do not depend on it.")
      ->check(quiet(CLI::Range(0, 4096)))
      ->type_name("N");
  add_memory_argument(app, args.memory);
  app.add_option("--region", args.region, "Only these pixels; the same bytes as that part of the whole.")
      ->type_name("X,Y,W,H");
  app.add_option("--tile", args.tile,
                 "Testing aid: edge of a tile in pixels; -1 takes the whole frame as one tile.")
      ->check(quiet(CLI::Range(-1, 65536)))
      ->type_name("N");
  app.add_flag("--no-fuse", args.no_fuse, "Testing aid: every pixel node's outputs become whole.");
  app.add_option("--simd", args.simd,
                 "Testing aid: the vector instructions to use; exit 3 where there are none such.")
      ->check(quiet(CLI::IsMember({"sse4", "avx2", "avx512"})))
      ->type_name("sse4|avx2|avx512");
}

void apply(const RunArguments& args, RunOptions& options) {
  options.threads = args.threads;
  options.tile_edge = args.tile;
  options.fuse = !args.no_fuse;
  options.memory = memory_limit(args.memory);
  if (!args.region.empty()) {
    const auto v = integers("--region", args.region, 4);
    if (v[2] <= 0 || v[3] <= 0)
      throw UsageError(fmt::format("--region {}: width and height are above 0", args.region));
    const auto end = [](int from, int size) {  // beyond the last pixel that there can be is at it
      return static_cast<int>(
          std::min<std::int64_t>(std::int64_t{from} + size, std::numeric_limits<int>::max()));
    };
    options.region = Rect{v[0], v[1], end(v[0], v[2]), end(v[1], v[3])};
  }
  for (const auto& [target, name] : choices(Simd{}))
    if (args.simd == name && !use_simd(target))
      throw WorldError("unsupported_simd", fmt::format("this processor has no {}", name));
}

void check_region(const Graph& graph, const RunOptions& options, const RunResult& result,
                  Diagnostics& problems) {
  if (!options.region) return;
  for (const auto& [port, buffer] : result.buffers) {
    if (!buffer.type().is_pixels() || !buffer.type().raster(buffer.data()).frame().window.empty()) continue;
    const Rect& r = *options.region;
    Diagnostic d = at_port(graph, port, "empty_region",
                           fmt::format("{} has no pixels in the region {},{},{},{}", graph.name(port), r.x0,
                                       r.y0, r.width(), r.height()));
    d.expected = "a region that meets the picture";
    problems.add(std::move(d));
  }
}

std::vector<std::string> assignments(const std::string& text) {
  std::vector<std::string> out{""};
  int depth = 0;
  for (const char c : text) {
    depth += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
    if (c == ',' && depth == 0)
      out.emplace_back();
    else
      out.back() += c;
  }
  if (out.back().empty()) out.pop_back();
  return out;
}

std::vector<int> integers(std::string_view option, std::string_view text, std::size_t count) {
  std::vector<int> out;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (;;) {
    int value = 0;
    const auto [next, problem] = std::from_chars(at, end, value);
    if (problem != std::errc{}) break;
    out.push_back(value);
    at = next;
    if (at == end || *at != ',' || at + 1 == end) break;  // a comma at the end stays, and is refused
    ++at;
  }
  if (at != end || out.size() != count)
    throw UsageError(
        fmt::format("{} {}: expected {} integers with commas between them", option, text, count));
  return out;
}

// A day of pictures at 24 a second has two million.
constexpr int most_frame = 9'999'999;

std::pair<int, int> frame_range(std::string_view text) {
  const auto parse = [&](std::string_view part) {
    int value = 0;
    const auto [end, problem] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (problem != std::errc{} || end != part.data() + part.size() || value < 0)
      throw UsageError(fmt::format("--frames {}: expected A-B, such as 1-48", text));
    return value;
  };
  const auto dash = text.find('-');
  const int first = parse(text.substr(0, dash));
  const int last = dash == std::string_view::npos ? first : parse(text.substr(dash + 1));
  if (last < first) throw UsageError(fmt::format("--frames {}: the last frame comes before the first", text));
  if (last > most_frame)
    throw UsageError(fmt::format("--frames {}: the last frame is {} at most", text, most_frame));
  return {first, last};
}

namespace {
int output_error = 0;  // of the first write to stdout that failed
}

void print(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if ((!written || std::fflush(stdout) != 0) && output_error == 0) output_error = errno != 0 ? errno : EIO;
}

int exit_after_output(int code) {
  if (std::fflush(stdout) != 0 && output_error == 0) output_error = errno != 0 ? errno : EIO;
  if (output_error == 0 || output_error == EPIPE) return code;
  Diagnostics problems;
  problems.add(
      {.code = "cannot_write_file",
       .pointer = "",
       .message = fmt::format("cannot write to the standard output: {}", std::strerror(output_error))});
  report(problems);
  return world_failed;
}

void print(const Json& object) { print(object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"); }

void report(const Diagnostics& problems) {
  if (problems.empty()) return;
  const std::string text = to_text(problems, color_on_stderr());
  std::fwrite(text.data(), 1, text.size(), stderr);
}

Json with_diagnostics(Json object, const Diagnostics& problems) {
  object.update(to_json(problems));
  return object;
}

int fail(const Diagnostics& problems, bool json, Exit exit) {
  if (exit == cancelled) std::fputs("cancelled\n", stderr);
  if (json)
    print(to_json(problems));
  else
    report(problems);
  return exit;
}

int fail(const Diagnostic& problem, bool json) {
  Diagnostics problems;
  problems.add(problem);
  return fail(problems, json);
}

int exit_code(const RunResult& result) {
  switch (result.end) {
    case RunResult::End::done: return done;
    case RunResult::End::failed: return bad_input;
    case RunResult::End::world_failed: return world_failed;
    case RunResult::End::cancelled: return cancelled;
  }
  return world_failed;
}

}  // namespace frustum::cli
