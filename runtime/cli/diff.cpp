// frustum diff A B: how far two images, meshes or tables are apart.
#include "runtime/app/export.h"
#include "runtime/app/metrics/metrics.h"
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum::cli {
namespace {

struct Arguments {
  std::string a, b;
  std::vector<std::string> metrics;
};

// What is wrong with a file names it.
template <class Read>
auto read(const std::string& path, Read reader) {
  try {
    return reader(path);
  } catch (const NodeError& e) {
    throw Mistake({.code = e.code, .pointer = "", .message = e.what(), .file = path});
  }
}

Measured measure_files(const Arguments& args, const std::vector<std::string>& names) {
  const auto is_table = [](const std::string& path) { return path.ends_with(".csv"); };
  if (is_table(args.a) != is_table(args.b))
    throw NodeError(
        "not_comparable",
        fmt::format("{} is a table and {} is none: frustum inspect --save makes a .csv of any buffer",
                    is_table(args.a) ? args.a : args.b, is_table(args.a) ? args.b : args.a));
  if (!is_table(args.a)) return measure(read(args.a, load_buffer), read(args.b, load_buffer), names);
  return measure(compare_tables(read(args.a, csv_table), read(args.b, csv_table)), names);
}

// Without any bound, the files have to be identical.
std::vector<MetricBound> bounds_of(const std::vector<std::string>& texts) {
  std::vector<MetricBound> out;
  for (const std::string& t : texts) out.push_back(parse_metric_bound(t));
  if (out.empty()) out.push_back({"identical"});
  return out;
}

std::string text_of(const Measured& m) {
  const Difference& d = m.difference;
  if (!d.mismatch.empty()) return d.mismatch + "\n";
  if (d.identical()) return fmt::format("identical: {} values\n", d.values);
  std::string out = fmt::format("rmse {:.6g}, max {:.6g}, psnr {:.2f} dB; {} of {} values differ", d.rmse,
                                d.max, d.psnr, d.differing, d.values);
  if (d.nan != 0) out += fmt::format(", {} are NaN", d.nan);
  if (d.wrong_ids != 0) out += fmt::format(", {} of {} ids are wrong", d.wrong_ids, d.ids);
  if (d.worst) out += fmt::format("\nworst: {}: {:.9g} and {:.9g}", d.worst->place(), d.worst->a, d.worst->b);
  for (const auto& [name, value] : m.values)
    if (name != "rmse" && name != "max" && name != "psnr" && name != "identical")
      out += fmt::format("\n{}: {:.6g}{}{}", name, value, find_metric(name)->unit.empty() ? "" : " ",
                         find_metric(name)->unit);
  return out + "\n";
}

int diff(const Arguments& args, bool json) {
  const auto bounds = bounds_of(args.metrics);
  std::vector<std::string> names;
  for (const MetricBound& b : bounds) names.push_back(b.metric);
  const Measured m = measure_files(args, names);
  if (m.difference.values == 0 && m.difference.mismatch.empty())
    throw NodeError("not_comparable",
                    fmt::format("{} and {} hold no values: nothing can be compared", args.a, args.b));
  Json out = to_json(m), failed = Json::array();
  std::string text = text_of(m);
  for (const MetricBound& bound : broken(m, bounds)) {
    failed.push_back({{"metric", bound.metric}, {"tolerance", bound.tolerance}});
    const Metric& metric = *find_metric(bound.metric);
    if (!m.difference.mismatch.empty()) continue;  // says why already
    if (metric.yes_or_no)
      text += fmt::format("does not hold: {}\n", bound.metric);
    else
      text += fmt::format("does not hold: {} {} {}\n", bound.metric,
                          metric.at_least ? ">=" : "<=", bound.tolerance);
  }
  out["pass"] = failed.empty();
  out["broken"] = failed;
  if (json)
    print(out);
  else
    print(text);
  return failed.empty() ? done : check_failed;
}

std::string metric_help() {
  std::vector<std::string_view> at_most, at_least;
  for (const Metric& m : metrics())
    if (!m.yes_or_no) (m.at_least ? at_least : at_most).push_back(m.name);
  return fmt::format(
      "A bound: {} at most, {} at least, or identical. Without any: identical. NaN never passes.",
      fmt::join(at_most, ", "), fmt::join(at_least, " and "));
}

}  // namespace

void add_diff(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c =
      add_command(app, chosen, "diff",
                  "Measures how far two images, meshes or tables are apart; exit 1 beyond a tolerance.",
                  "frustum diff out/teapot.exr reference.exr --metric rmse=1e-4 --metric flip=0.01",
                  [args, &chosen] { return diff(*args, chosen.json); });
  c.add_option("a", args->a, "The first file: an image, a mesh, or a table as .csv.")
      ->required()
      ->type_name("A");
  c.add_option("b", args->b, "The second file, which is the reference.")->required()->type_name("B");
  c.add_option("--metric", args->metrics, metric_help())->type_name("M=TOL")->allow_extra_args(false);
}

}  // namespace frustum::cli
