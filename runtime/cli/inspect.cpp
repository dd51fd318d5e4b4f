// frustum inspect GRAPH NODE.PORT: the buffer between two nodes, its statistics, values, and where a pixel
// came from.
#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/app/provenance.h"
#include "runtime/buffers/fragments.h"
#include "runtime/cli/command.h"
#include "runtime/cli/inspect_text.h"
#include "runtime/core/text.h"
#include "runtime/graph/output_format.h"
#include "runtime/graph/own_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <array>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace frustum::cli {
namespace {

constexpr std::int64_t most_rows = std::int64_t{1} << 40;

struct Arguments {
  GraphArguments graph;
  RunArguments run;
  std::string port, pixel, provenance, save;
  bool table = false;
  std::size_t first = 0, rows = 20;
  std::optional<int> sample;
};

// The port that is looked at, and what is wrong with looking at it in some way.
struct Looked {
  const Graph& graph;
  PortRef port;

  std::string name() const { return graph.name(port); }
  [[noreturn]] void wrong(std::string code, std::string message, std::string expected, std::string got = {},
                          std::vector<std::string> suggestions = {}) const {
    Diagnostic d = at_port(graph, port, std::move(code), std::move(message));
    d.expected = std::move(expected), d.got = std::move(got), d.suggestions = std::move(suggestions);
    throw Mistake(std::move(d));
  }
};

Json table_json(const Looked& at, const Buffer& buffer, std::size_t first, std::size_t count) {
  const auto has_table = [](const BufferType& t) { return t.table != nullptr; };
  const Json table =
      has_table(buffer.type()) ? buffer.type().table(buffer.data(), first, count) : Json(nullptr);
  if (table.is_null())
    at.wrong("no_table", fmt::format("{} is a {}, which has no table form", at.name(), buffer.type().name),
             "a port whose buffer has rows", std::string(buffer.type().name),
             near_ports(at.graph, at.port, has_table));
  return table;
}

// {"samples": [{"sample": 0, "R": ..., "G": ...}]} with every plane: the rows of the buffer's table that
// are this pixel.
Json pixel_json(const Looked& at, const Buffer& buffer, int x, int y) {
  const Frame& frame = buffer.type().raster(buffer.data()).frame();
  const auto count = static_cast<std::size_t>(frame.samples()), planes = frame.planes.size();
  const auto row = static_cast<std::size_t>(y - frame.window.y0),
             column = static_cast<std::size_t>(x - frame.window.x0);
  const Json table =
      table_json(at, buffer, (row * static_cast<std::size_t>(frame.window.width()) + column) * count, count);
  Json samples = Json::array();
  for (const Json& cells : table["rows"]) {
    Json sample = {{"sample", samples.size()}};
    for (std::size_t p = 0; p < planes; ++p) sample[frame.planes[p].name] = cells[cells.size() - planes + p];
    samples.push_back(std::move(sample));
  }
  return {{"x", x}, {"y", y}, {"samples", samples}};
}

Json header_json(const std::string& name, const Buffer& buffer) {
  const Health health = buffer.health();
  Json out = {{"port", name},
              {"type", buffer.type().name},
              {"bytes", buffer.bytes()},
              {"digest", to_hex(buffer.digest())},
              {"values", health.values},
              {"nan", health.nan},
              {"positive_infinity", health.positive_infinity},
              {"negative_infinity", health.negative_infinity}};
  if (!health.finite()) out["first_not_finite"] = health.first;
  return out;
}

int show_provenance(Session& session, const Graph& graph, PortRef port, const Arguments& args,
                    RunOptions options, Diagnostics& problems, bool json) {
  const auto at = integers("--provenance", args.provenance, 2);
  RunResult::End end{};
  const auto found = provenance(session, graph, port, at[0], at[1], std::move(options), problems, end);
  if (!found) {
    RunResult failed;
    failed.end = end == RunResult::End::done ? RunResult::End::failed : end;
    return fail(problems, json, static_cast<Exit>(exit_code(failed)));
  }
  if (json)
    print(with_diagnostics(to_json(*found), problems));
  else
    report(problems), print(to_text(*found));
  return done;
}

// The fragments of all samples of a pixel: rows of the buffer's table.
Json pixel_lists(const Looked& at, const Buffer& buffer, const Fragments& lists, int x, int y) {
  const auto [begin, end] = lists.of_pixel(x, y);
  return table_json(at, buffer, begin, end - begin);
}

bool has_pixels(const BufferType& t) { return t.is_pixels() || &t == &buffer_type<Fragments>(); }

Rect window_of(const Looked& at, const Buffer& buffer) {
  if (const auto lists = buffer.as<Fragments>()) return lists->window;
  if (!buffer.type().is_pixels())
    at.wrong("not_pixels", at.name() + " holds no pixels", "a port of pixels",
             std::string(buffer.type().name), near_ports(at.graph, at.port, has_pixels));
  return buffer.type().raster(buffer.data()).frame().window;
}

std::string show_pixel(const Looked& at, const Buffer& buffer, const std::string& pixel, Json& out) {
  const auto xy = integers("--pixel", pixel, 2);
  const Rect window = window_of(at, buffer);
  if (!window.contains(xy[0], xy[1]))
    at.wrong("outside_window",
             fmt::format("pixel {},{} lies outside the picture of {}", xy[0], xy[1], at.name()),
             window.empty() ? "a picture with pixels"
                            : fmt::format("x from {} to {}, y from {} to {}", window.x0, window.x1 - 1,
                                          window.y0, window.y1 - 1),
             pixel);
  if (const auto lists = buffer.as<Fragments>()) {
    out = pixel_lists(at, buffer, *lists, xy[0], xy[1]);
    return table_text(out, lists->of_pixel(xy[0], xy[1]).begin);
  }
  out = pixel_json(at, buffer, xy[0], xy[1]);
  return samples_text(out["samples"]);
}

// ----- the file of --save

// Known before anything runs, where the port carries one kind of buffer.
void check_format(const BufferType& type, const Arguments& args) {
  const std::string extension = extension_of(args.save);
  const std::vector<std::string> forms = forms_of(type, false);
  const std::vector<std::string> whole = forms_of(type, true);
  if (std::find(forms.begin(), forms.end(), extension) == forms.end()) {
    std::vector<std::string> near = nearest_names(extension, forms);
    for (std::string& n : near) n = std::filesystem::path(args.save).replace_extension(n).string();
    throw Mistake({.code = "unknown_format",
                   .pointer = "",
                   .message = fmt::format("--save {}: a buffer of kind {} is saved as {}", args.save,
                                          type.name, fmt::join(forms, ", ")),
                   .expected = fmt::format("one of: {}", fmt::join(forms, ", ")),
                   .got = extension,
                   .suggestions = std::move(near),
                   .file = args.save});
  }
  if (args.sample && std::find(whole.begin(), whole.end(), extension) != whole.end())
    throw UsageError(fmt::format("--sample {}: {} gets the whole buffer", *args.sample, args.save));
}

void save(const Buffer& buffer, const Arguments& args, Context& ctx, Diagnostics& warnings) {
  check_format(buffer.type(), args);
  const auto warn = [&](std::string_view code, const std::string& message) {
    warnings.add({.code = std::string(code),
                  .severity = Severity::warning,
                  .pointer = "",
                  .message = message,
                  .file = args.save});
  };
  try {
    save_buffer(buffer, args.save, ctx, args.sample, warn);
  } catch (const NodeError& e) {
    throw Mistake({.code = e.code, .pointer = "", .message = e.what(), .file = args.save});
  }
}

int show_buffer(const Looked& at, const Buffer& buffer, const Arguments& args, Context ctx,
                Diagnostics& warnings, bool json) {
  Json out = header_json(at.name(), buffer);
  ctx.poll();
  std::string text;
  if (!args.pixel.empty()) text += show_pixel(at, buffer, args.pixel, out["pixel"]);
  if (args.table) {
    out["table"] = table_json(at, buffer, args.first, args.rows);
    text += table_text(out["table"], args.first);
  }
  if (text.empty()) {
    out["summary"] = buffer.type().summary(buffer.data());
    text = buffer_text(out);
  }
  if (!args.save.empty()) {
    save(buffer, args, ctx, warnings);
    out["saved"] = args.save;
    text += args.save + "\n";
  }
  if (json)
    print(with_diagnostics(std::move(out), warnings));
  else
    report(warnings), print(text);
  return done;
}

int inspect(const Arguments& args, bool json) {
  Session session;
  Diagnostics warnings, problems;
  const auto graph = load_or_report(session, args.graph, json, load_options(args.graph), &warnings);
  if (!graph) return bad_input;
  const auto port = port_of(*graph, args.port, problems);
  if (!port) return fail(problems, json);
  drop_unused(*graph, std::array{*port}, warnings);
  if (const auto d = overwriting(*graph, args.save, "--save")) return fail(*d, json);
  const auto& kinds = graph->port(*port).types;
  if (!args.save.empty() && kinds.size() == 1) check_format(*kinds.front(), args);
  if (!args.save.empty()) require_writable(args.save);
  RunOptions options;
  apply(args.run, options);
  options.cancel = &cancel_flag();
  if (!args.provenance.empty()) return show_provenance(session, *graph, *port, args, options, warnings, json);
  options.demand.ports = {*port};
  if (options.region && !graph->port(*port).types.front()->is_pixels())
    throw UsageError(fmt::format("--region {}: {} holds no pixels", args.run.region, graph->name(*port)));
  const RunResult result = session.run(*graph, options);
  warnings.add(result.problems);
  check_region(*graph, options, result, warnings);
  if (warnings.has_errors() && result.end == RunResult::End::done) return fail(warnings, json);
  if (result.end != RunResult::End::done) return fail(warnings, json, static_cast<Exit>(exit_code(result)));
  const Buffer& buffer = result.buffers.at(*port);
  return show_buffer({*graph, *port}, buffer, args, saving_context(buffer, options.cancel, options.memory),
                     warnings, json);
}

}  // namespace

void add_inspect(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c =
      add_command(app, chosen, "inspect", "Shows any buffer: statistics, values, where a pixel came from.",
                  "frustum inspect graphs/gallery/teapot_stages.json display --provenance 640,360",
                  [args, &chosen] { return inspect(*args, chosen.json); });
  add_graph_arguments(c, args->graph);
  c.add_option("port", args->port, "A port, a node (its first output) or an output of the graph.")
      ->required()
      ->type_name("NODE.PORT");
  auto* pixel = c.add_option("--pixel", args->pixel,
                             "Every plane of every sample of one pixel, or its lists of fragments.")
                    ->type_name("X,Y");
  auto* table = c.add_flag("--table", args->table, "The values as rows.")->excludes(pixel);
  c.add_option("--first", args->first, "The first row of the table.")
      ->check(quiet(CLI::Range(std::int64_t{0}, most_rows)))
      ->needs(table)
      ->type_name("ROW");
  c.add_option("--rows", args->rows, "Rows of the table.")
      ->check(quiet(CLI::Range(std::int64_t{1}, most_rows)))
      ->capture_default_str()
      ->needs(table)
      ->type_name("N");
  auto* save =
      c.add_option(
           "--save", args->save,
           "Pixels to an image file (.exr keeps every plane), a mesh to .ply, .obj or .glb, any buffer "
           "to .csv or .json.")
          ->type_name("FILE");
  c.add_option("--sample", args->sample,
               "Which sample of each pixel --save writes; the first, unless it is given.")
      ->needs(save)
      ->type_name("N");
  add_run_arguments(c, args->run);
  c.add_option("--provenance", args->provenance,
               "The pixel's samples, their triangles, and the node that made them.")
      ->excludes(pixel, table, save, c.get_option("--region"))
      ->type_name("X,Y");
}

}  // namespace frustum::cli
