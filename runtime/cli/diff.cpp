// frustum diff A B: how far two images are apart.
#include "runtime/app/compare.h"
#include "runtime/app/export.h"
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>

namespace frustum::cli {
namespace {

struct Arguments {
  std::string a, b;
  std::vector<std::string> metrics;
};

// "rmse=0.01", or "identical"; without any, the images have to be identical.
std::vector<MetricBound> bounds(const std::vector<std::string>& texts) {
  std::vector<MetricBound> out;
  for (const std::string& t : texts) {
    const auto equals = t.find('=');
    MetricBound bound{t.substr(0, equals)};
    const auto& names = metric_names();
    if (std::find(names.begin(), names.end(), bound.metric) == names.end()) {
      const auto near = nearest_names(bound.metric, names);
      throw UsageError(fmt::format("no metric '{}'{}", bound.metric,
                                   near.empty() ? "; there are rmse, max, psnr, identical"
                                                : fmt::format("; did you mean '{}'?", near.front())));
    }
    if (bound.metric != "identical") {
      const std::string number = equals == std::string::npos ? "" : t.substr(equals + 1);
      const auto [end, problem] =
          std::from_chars(number.data(), number.data() + number.size(), bound.tolerance);
      if (problem != std::errc{} || end != number.data() + number.size() || !(bound.tolerance >= 0))
        throw UsageError(fmt::format("--metric {}: expected METRIC=TOLERANCE, such as rmse=0.01", t));
    }
    out.push_back(bound);
  }
  if (out.empty()) out.push_back({"identical"});
  return out;
}

std::string text_of(const Difference& d) {
  if (!d.mismatch.empty()) return d.mismatch + "\n";
  if (d.identical()) return fmt::format("identical: {} values\n", d.values);
  std::string out = fmt::format("rmse {:.6g}, max {:.6g}, psnr {:.2f} dB; {} of {} values differ", d.rmse,
                                d.max, d.psnr, d.differing, d.values);
  if (d.nan != 0) out += fmt::format(", {} are NaN", d.nan);
  if (d.worst)
    out += fmt::format("\nworst: {} at {},{}: {:.9g} and {:.9g}", d.worst->plane, d.worst->x, d.worst->y,
                       d.worst->a, d.worst->b);
  return out + "\n";
}

int diff(const Arguments& args, bool json) {
  const auto wanted = bounds(args.metrics);
  const Difference d = compare(load_raster(args.a), load_raster(args.b));
  Json out = to_json(d), broken = Json::array();
  std::string text = text_of(d);
  for (const MetricBound& bound : wanted) {
    if (holds(d, bound)) continue;
    broken.push_back({{"metric", bound.metric}, {"tolerance", bound.tolerance}});
    if (d.mismatch.empty() && bound.metric != "identical")
      text += fmt::format("does not hold: {} {} {}\n", bound.metric,
                          bound.metric == "psnr" ? ">=" : "<=", bound.tolerance);
  }
  out["pass"] = broken.empty();
  out["broken"] = broken;
  if (json)
    print(out);
  else
    print(text);
  return broken.empty() ? done : check_failed;
}

}  // namespace

void add_diff(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c =
      add_command(app, chosen, "diff", "Measures how far two images are apart; exit 1 beyond a tolerance.",
                  "frustum diff out/teapot.exr reference.exr --metric rmse=1e-4 --metric max=0.02",
                  [args, &chosen] { return diff(*args, chosen.json); });
  c.add_option("a", args->a, "The first image.")->required()->type_name("A");
  c.add_option("b", args->b, "The second image.")->required()->type_name("B");
  c.add_option(
       "--metric", args->metrics,
       "A bound: rmse and max at most, psnr at least, identical. Without any: identical. NaN never passes.")
      ->type_name("M=TOL")
      ->allow_extra_args(false);
}

}  // namespace frustum::cli
