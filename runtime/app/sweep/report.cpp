#include "runtime/app/sweep/report.h"

#include "runtime/app/files.h"
#include "runtime/app/metrics/metrics.h"
#include "runtime/app/sweep/analysis.h"
#include "runtime/buffers/numbers.h"
#include "runtime/core/text.h"
#include "runtime/core/version.h"
#include "runtime/io/buffer_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace frustum {
namespace {

double milliseconds(std::chrono::nanoseconds t) {
  return std::chrono::duration<double, std::milli>(t).count();
}

Json fit_json(const std::optional<SlopeFit>& f) {
  if (!f) return nullptr;
  return {{"slope", f->slope}, {"intercept", f->intercept}, {"r2", f->r2}, {"points", f->points}};
}

Json point_json(const SweepPoint& p) {
  Json errors = Json::object(), times = Json::array();
  for (const auto& [metric, v] : p.errors) errors[metric] = json_number(v);
  for (const auto t : p.times) times.push_back(milliseconds(t));
  Json out = {{"key", p.key},
              {"values", p.values},
              {"errors", errors},
              {"ms",
               {{"min", milliseconds(min_of(p))},
                {"median", milliseconds(median_of(p))},
                {"mad", milliseconds(deviation_of(p))},
                {"all", times}}},
              {"work", p.work},
              {"counters", p.counters},
              {"pareto", p.pareto}};
  if (p.knob) out["knob"] = *p.knob;
  if (p.own_error()) out["own_error"] = json_number(*p.own_error());
  if (!p.knob && !p.own_errors.empty())
    for (const auto& [k, v] : p.own_errors)
      out["own_errors"].push_back({{"knob", k}, {"error", json_number(v)}});
  return out;
}

Json costs_json(const SweepCosts& c) {
  return {{"total", c.total},         {"timed_runs", c.timed}, {"first_runs", c.first},
          {"reference", c.reference}, {"loading", c.loading},  {"errors_and_pictures", c.judging},
          {"journal", c.journal},     {"report", c.report}};
}

std::string fitted(const std::optional<SlopeFit>& f) {
  if (!f) return "-";
  if (f->r2 < least_r2) return fmt::format("no line (r2 {:.2f})", f->r2);
  return fmt::format("{:+.2f} (r2 {:.3f}, {} points)", f->slope, f->r2, f->points);
}

// Adds the time since `began` to what the report of the sweep has cost.
void add_report_time(Sweep& s, std::chrono::steady_clock::time_point began) {
  const double more = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  s.costs.report += more, s.costs.total += more;
}

}  // namespace

std::string costs_text(const SweepCosts& c) {
  if (c.runs() == 0)
    return fmt::format(
        "{:.1f} s: nothing was run, all is from an earlier sweep (loading {:.2f}, report {:.2f} s)", c.total,
        c.loading, c.report);
  return fmt::format(
      "{:.1f} s: {:.1f} s in runs (timed {:.1f}, first {:.1f}, reference {:.1f}); measuring overhead {:.1f} "
      "% "
      "(loading {:.2f}, errors and pictures {:.2f}, journal {:.2f}, report {:.2f} s)",
      c.total, c.runs(), c.timed, c.first, c.reference, 100 * c.overhead(), c.loading, c.judging, c.journal,
      c.report);
}

std::string theory_text(const KnobFit& fit, const SweepKnob& knob) {
  const auto agrees = agrees_with_theory(fit, knob);
  if (!agrees) return {};
  return fmt::format("{} {} of theory", *agrees ? "within" : "outside", slope_tolerance);
}

std::string name_of(const Sweep& s, const SweepPoint& p) {
  if (p.knob) {
    const SweepKnob& k = s.knobs[*p.knob];
    return k.current.empty() ? fmt::format("{} = {}", k.address, p.values[*p.knob])
                             : fmt::format("{}: {} -> {}", k.address, k.current, p.values[*p.knob]);
  }
  if (!s.options.grid) return "as it is";
  std::string out;
  for (std::size_t k = 0; k < p.values.size(); ++k)
    out += fmt::format("{}{} {}", k == 0 ? "" : ", ", s.knobs[k].address, p.values[k]);
  return out;
}

Json to_json(const Sweep& s) {
  Json knobs = Json::array(), points = Json::array(), fits = Json::array(), steps = Json::array();
  for (const SweepKnob& k : s.knobs) {
    knobs.push_back(
        {{"address", k.address}, {"values", k.values}, {"current", k.current}, {"basis", k.basis}});
    if (k.slope) knobs.back()["expected_slope"] = *k.slope;
  }
  for (const SweepPoint& p : s.points) points.push_back(point_json(p));
  for (const KnobFit& f : s.fits) {
    fits.push_back({{"knob", f.knob},
                    {"over_value", fit_json(f.over_value)},
                    {"over_time", fit_json(f.over_time)},
                    {"over_work", fit_json(f.over_work)},
                    {"without_effect", f.without_effect}});
    if (const auto agrees = agrees_with_theory(f, s.knobs[f.knob]))
      fits.back()["agrees_with_theory"] = *agrees;
  }
  for (const SweepStep& t : s.steps)
    steps.push_back({{"point", t.point},
                     {"ms", t.time_ms},
                     {"error_ratio", json_number(t.error_ratio)},
                     {"halvings_per_ms", json_number(t.halvings_per_ms)}});
  return {{"format", "frustum.sweep/1"},
          {"graph", s.options.graph},
          {"title", s.title},
          {"port", s.port},
          {"kind", s.kind},
          {"reference", s.reference},
          {"metrics", s.options.metrics},
          {"grid", s.options.grid},
          {"repeats", s.options.repeats},
          {"machine", s.machine},
          {"version", fmt::format("{} ({})", version, build_id())},
          {"seconds", costs_json(s.costs)},
          {"overhead", s.costs.overhead()},
          {"resumed", s.resumed},
          {"knobs", knobs},
          {"points", points},
          {"fits", fits},
          {"steps", steps}};
}

std::string sweep_csv(const Sweep& s) {
  Json columns = {"turned"}, rows = Json::array();
  for (const SweepKnob& k : s.knobs) columns.push_back(k.address);
  for (const std::string& m : s.options.metrics) columns.push_back(m);
  for (const char* name : {"own_error", "min_ms", "median_ms", "mad_ms", "runs", "work", "pareto"})
    columns.push_back(name);
  for (const SweepPoint& p : s.points) {
    Json row = {p.knob ? s.knobs[*p.knob].address : std::string()};
    for (const std::string& v : p.values) row.push_back(v);
    for (const std::string& m : s.options.metrics) row.push_back(json_number(p.error(m)));
    row.push_back(p.own_error() ? json_number(*p.own_error()) : Json(nullptr));
    for (const auto t : {min_of(p), median_of(p), deviation_of(p)}) row.push_back(milliseconds(t));
    row.push_back(p.times.size()), row.push_back(p.work), row.push_back(p.pareto ? 1 : 0);
    rows.push_back(std::move(row));
  }
  std::string text = csv_row(columns);
  for (const Json& row : rows) text += csv_row(row);
  return text;
}

std::string sweep_text(const Sweep& s, std::size_t steps) {
  std::string out = fmt::format("{}, {} points, {} against {}\n", s.port, s.points.size(),
                                s.options.metrics.front(), s.reference);
  if (!s.fits.empty()) {
    std::vector<std::vector<std::string>> rows{{"knob", "error ~ value^", "theory", "", "error ~ time^"}};
    for (const KnobFit& f : s.fits) {
      const SweepKnob& k = s.knobs[f.knob];
      rows.push_back({k.address, f.without_effect ? "no effect here" : fitted(f.over_value),
                      k.slope ? fmt::format("{:+.2f}", *k.slope) : "", theory_text(f, k),
                      f.without_effect ? "" : fitted(f.over_time)});
    }
    out += "\n" + aligned(rows);
  }
  if (!s.steps.empty()) {
    std::vector<std::vector<std::string>> rows{{"best buys", "time", "error", "halvings/ms"}};
    for (std::size_t i = 0; i < std::min(steps, s.steps.size()); ++i) {
      const SweepStep& t = s.steps[i];
      rows.push_back({name_of(s, s.points[t.point]), fmt::format("{:+.2f} ms", t.time_ms),
                      fmt::format("x {:.3g}", t.error_ratio),
                      std::isinf(t.halvings_per_ms) ? "free" : fmt::format("{:.3g}", t.halvings_per_ms)});
    }
    out += "\n" + aligned(rows);
  }
  return out + "\n" + costs_text(s.costs) + "\n";
}

Plot error_plot(const Sweep& s) {
  const std::string& metric = s.options.metrics.front();
  const auto plotted = [&](std::size_t i, bool ring) {
    const SweepPoint& p = s.points[i];
    const double time = milliseconds(median_of(p)), error = p.error(metric);
    return PlotPoint{time, error,
                     fmt::format("{}\n{} {:.3g}, {:.3g} ms (min {:.3g}, deviation {:.2g})", name_of(s, p),
                                 metric, error, time, milliseconds(min_of(p)), milliseconds(deviation_of(p))),
                     i, ring};
  };
  Plot plot;
  plot.x_label = "time of a run, ms (median)";
  plot.y_label = metric + " against the reference";
  plot.title = "Error against time, both logarithmic";
  for (std::size_t i = 0; i < s.points.size(); ++i)
    if (s.points[i].pareto) plot.front.push_back(plotted(i, false));
  std::sort(plot.front.begin(), plot.front.end(),
            [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  for (std::size_t k = 0; k < s.knobs.size() && !s.options.grid; ++k) {
    PlotSeries series{s.knobs[k].address, k, {}};
    for (const std::string& v : s.knobs[k].values)
      for (std::size_t i = 0; i < s.points.size(); ++i)
        if ((s.points[i].knob == k && s.points[i].values[k] == v) || (i == 0 && s.knobs[k].current == v))
          series.points.push_back(plotted(i, false));
    plot.series.push_back(std::move(series));
  }
  if (s.options.grid)
    for (std::size_t v = 0; v < s.knobs.front().values.size(); ++v) {
      PlotSeries series{s.knobs.front().values[v], v, {}};
      for (std::size_t i = 0; i < s.points.size(); ++i)
        if (s.points[i].values.front() == s.knobs.front().values[v])
          series.points.push_back(plotted(i, false));
      series.joined = s.knobs.size() == 2;
      plot.series.push_back(std::move(series));
    }
  else if (!s.points.empty())
    plot.series.push_back({"", 7u, {plotted(0, true)}});
  return plot;
}

std::vector<std::string> write_sweep(Sweep& s) {
  const std::filesystem::path folder = s.options.folder;
  write_text(folder / "sweep.html", sweep_html(s));
  const auto began = std::chrono::steady_clock::now();
  write_text(folder / "sweep.csv", sweep_csv(s));
  add_report_time(s, began);
  write_text(folder / "sweep.json", to_json(s).dump(1) + "\n");
  return {(folder / "sweep.json").string(), (folder / "sweep.csv").string(),
          (folder / "sweep.html").string()};
}

}  // namespace frustum
