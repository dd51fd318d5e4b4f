// frustum inspect GRAPH NODE.PORT: the buffer between two nodes, its statistics, values, and where a pixel
// came from.
#include "runtime/app/export.h"
#include "runtime/app/provenance.h"
#include "runtime/buffers/fragments.h"
#include "runtime/cli/command.h"
#include "runtime/cli/inspect_text.h"
#include "runtime/core/text.h"
#include "runtime/graph/own_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
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

Json table_json(const Buffer& buffer, std::size_t first, std::size_t count) {
  const Json table =
      buffer.type().table != nullptr ? buffer.type().table(buffer.data(), first, count) : Json(nullptr);
  if (table.is_null()) throw NodeError("no_table", fmt::format("a {} has no table form", buffer.type().name));
  return table;
}

// {"samples": [{"sample": 0, "R": ..., "G": ...}]} with every plane: the rows of the buffer's table that
// are this pixel.
Json pixel_json(const Buffer& buffer, int x, int y) {
  const Frame& frame = buffer.type().raster(buffer.data()).frame();
  const auto count = static_cast<std::size_t>(frame.samples()), planes = frame.planes.size();
  const auto row = static_cast<std::size_t>(y - frame.window.y0),
             column = static_cast<std::size_t>(x - frame.window.x0);
  const Json table =
      table_json(buffer, (row * static_cast<std::size_t>(frame.window.width()) + column) * count, count);
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
Json pixel_lists(const Buffer& buffer, const Fragments& lists, int x, int y) {
  const auto [begin, end] = lists.of_pixel(x, y);
  return table_json(buffer, begin, end - begin);
}

Rect window_of(const Buffer& buffer, const std::string& port) {
  if (const auto lists = buffer.as<Fragments>()) return lists->window;
  if (!buffer.type().is_pixels()) throw NodeError("not_pixels", fmt::format("{} holds no pixels", port));
  return buffer.type().raster(buffer.data()).frame().window;
}

// What is told of a file names it.
void save(const Buffer& buffer, const Arguments& args, Context& ctx, Diagnostics& warnings) {
  save_buffer(buffer, args.save, ctx, args.sample, [&](std::string_view code, const std::string& message) {
    const bool named = message.starts_with(args.save);
    warnings.add({.code = std::string(code),
                  .severity = Severity::warning,
                  .pointer = "",
                  .message = named ? message : fmt::format("{}: {}", args.save, message)});
  });
}

int show_buffer(const Graph& graph, PortRef port, const Buffer& buffer, const Arguments& args, Context ctx,
                Diagnostics& warnings, bool json) {
  Json out = header_json(graph.name(port), buffer);
  ctx.poll();
  std::string text;
  if (!args.pixel.empty()) {
    const auto at = integers("--pixel", args.pixel, 2);
    if (!window_of(buffer, graph.name(port)).contains(at[0], at[1]))
      throw NodeError("outside_window", fmt::format("pixel {},{} lies outside the picture", at[0], at[1]));
    if (const auto lists = buffer.as<Fragments>()) {
      out["pixel"] = pixel_lists(buffer, *lists, at[0], at[1]);
      text += table_text(out["pixel"], lists->of_pixel(at[0], at[1]).begin);
    } else {
      out["pixel"] = pixel_json(buffer, at[0], at[1]);
      text += samples_text(out["pixel"]["samples"]);
    }
  }
  if (args.table) {
    out["table"] = table_json(buffer, args.first, args.rows);
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
  if (const auto d = overwriting(*graph, args.save, "--save")) return fail(*d, json);
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
  return show_buffer(*graph, *port, buffer, args, saving_context(buffer, options.cancel, options.memory),
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
