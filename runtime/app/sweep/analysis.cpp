#include "runtime/app/sweep/analysis.h"

#include "runtime/app/observers.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace frustum {
namespace {

double milliseconds(std::chrono::nanoseconds t) {
  return std::chrono::duration<double, std::milli>(t).count();
}

// An error that orders points: smaller is better, whatever the metric says.
double badness(const Sweep& s, const SweepPoint& p) {
  const std::string& metric = s.options.metrics.front();
  const double v = p.error(metric);
  if (metric == "psnr") return std::pow(10, -v / 20);
  return metric == "ssim" || metric == "identical" ? 1 - v : v;
}

// Faster and no worse, or as fast and better. NaN is on no front.
void mark_pareto(Sweep& s) {
  for (SweepPoint& p : s.points) {
    const double time = milliseconds(median_of(p)), error = badness(s, p);
    p.pareto = !std::isnan(error) && std::none_of(s.points.begin(), s.points.end(), [&](const SweepPoint& q) {
      const double t = milliseconds(median_of(q)), e = badness(s, q);
      return (t < time && e <= error) || (t <= time && e < error);
    });
  }
}

KnobFit fit_knob(const Sweep& s, std::size_t k) {
  const SweepKnob& knob = s.knobs[k];
  KnobFit fit{.knob = k, .over_value = {}, .over_time = {}, .over_work = {}};
  const auto exact = number_of_setting(knob.values.back());
  std::vector<std::pair<double, double>> values, times, works;
  bool all_zero = true;
  for (const SweepPoint& p : s.points) {
    const auto own = p.own_error(k);
    if (!own) continue;
    all_zero &= *own == 0;
    const auto v = number_of_setting(p.values[k]);
    if (!v || !exact || !(std::abs(std::log(*v / *exact)) >= std::log(4.0) * (1 - 1e-9))) continue;
    values.emplace_back(*v, *own);
    times.emplace_back(milliseconds(median_of(p)), *own);
    works.emplace_back(static_cast<double>(p.work), *own);
  }
  fit.without_effect = all_zero;
  fit.over_value = fit_slope(values), fit.over_time = fit_slope(times), fit.over_work = fit_slope(works);
  return fit;
}

std::vector<SweepStep> steps_from_the_first(const Sweep& s) {
  std::vector<SweepStep> steps;
  const double time = milliseconds(median_of(s.points.front())), error = badness(s, s.points.front());
  for (std::size_t i = 1; i < s.points.size(); ++i) {
    SweepStep step{.point = i};
    step.time_ms = milliseconds(median_of(s.points[i])) - time;
    step.error_ratio = error > 0 ? badness(s, s.points[i]) / error : 1;
    if (!(step.error_ratio < 1)) continue;
    if (step.error_ratio == 0 && step.time_ms > 0) continue;  // the reference itself: no halving ends there
    step.halvings_per_ms = step.time_ms > 0 ? -std::log2(step.error_ratio) / step.time_ms
                                            : std::numeric_limits<double>::infinity();
    steps.push_back(step);
  }
  std::stable_sort(steps.begin(), steps.end(), [](const SweepStep& a, const SweepStep& b) {
    return a.halvings_per_ms != b.halvings_per_ms ? a.halvings_per_ms > b.halvings_per_ms
                                                  : a.error_ratio < b.error_ratio;
  });
  return steps;
}

}  // namespace

std::optional<SlopeFit> fit_slope(std::span<const std::pair<double, double>> x_and_error) {
  std::vector<std::pair<double, double>> logs;
  for (const auto& [x, e] : x_and_error)
    if (x > 0 && e > 0 && std::isfinite(x) && std::isfinite(e))
      logs.emplace_back(std::log10(x), std::log10(e));
  if (logs.size() < 3) return std::nullopt;
  const auto n = static_cast<double>(logs.size());
  double mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
  for (const auto& [x, y] : logs) mx += x / n, my += y / n;
  for (const auto& [x, y] : logs)
    xx += (x - mx) * (x - mx), xy += (x - mx) * (y - my), yy += (y - my) * (y - my);
  if (xx < 1e-12) return std::nullopt;
  SlopeFit fit{.slope = xy / xx, .points = logs.size()};
  fit.intercept = my - fit.slope * mx;
  fit.r2 = yy > 0 ? xy * xy / (xx * yy) : 1;
  return fit;
}

void analyse(Sweep& s) {
  mark_pareto(s);
  s.fits.clear();
  s.steps.clear();
  if (s.options.grid) return;
  for (std::size_t k = 0; k < s.knobs.size(); ++k) s.fits.push_back(fit_knob(s, k));
  if (!s.points.empty()) s.steps = steps_from_the_first(s);
}

std::optional<bool> agrees_with_theory(const KnobFit& fit, const SweepKnob& knob) {
  if (!fit.over_value || !knob.slope) return std::nullopt;
  return std::abs(fit.over_value->slope - *knob.slope) <= slope_tolerance;
}

std::optional<double> number_of_setting(const std::string& value) {
  char* end = nullptr;
  const double v = std::strtod(value.c_str(), &end);
  if (value.empty() || *end != 0 || !std::isfinite(v)) return std::nullopt;
  return v;
}

std::chrono::nanoseconds min_of(const SweepPoint& p) {
  return *std::min_element(p.times.begin(), p.times.end());
}
std::chrono::nanoseconds median_of(const SweepPoint& p) { return median(p.times); }
std::chrono::nanoseconds deviation_of(const SweepPoint& p) {
  const auto middle = median_of(p);
  std::vector<std::chrono::nanoseconds> away;
  for (const auto t : p.times) away.push_back(t > middle ? t - middle : middle - t);
  return median(away);
}

}  // namespace frustum
