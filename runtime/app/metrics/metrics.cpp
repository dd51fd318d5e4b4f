#include "runtime/app/metrics/metrics.h"

#include "runtime/app/metrics/delta_e.h"
#include "runtime/app/metrics/flip.h"
#include "runtime/app/metrics/ssim.h"
#include "runtime/buffers/numbers.h"
#include "runtime/core/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

namespace frustum {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

// Infinite where one is NaN.
template <class T>
T distance(T a, T b) {
  if (a == b) return 0;
  const T e = std::abs(a - b);
  return std::isnan(e) ? std::numeric_limits<T>::infinity() : e;
}

constexpr std::array all_metrics{
    Metric{"rmse", "", "Root of the mean squared difference of all numbers."},
    Metric{"mrse", "",
           "Mean of the squared difference over the squared reference, (a-b)^2 / (|b|+0.01)^2: bright places "
           "weigh no more than dark ones."},
    Metric{"max", "", "Largest difference of any number."},
    Metric{"ulp", "ulp", "Largest difference in units in the last place of the stored type."},
    Metric{"psnr", "dB", "Peak signal to noise ratio for a peak of 1.", true},
    Metric{"ssim", "", "Structural similarity of the luma on an sRGB display; 1 is the same.", true, true},
    Metric{"flip", "", "Mean FLIP error: what an eye notices when two pictures alternate; 0 is the same.",
           false, true},
    Metric{"delta_e_2000", "", "Mean CIEDE2000 colour difference; about 1 is just visible.", false, true},
    Metric{"delta_e_2000_max", "", "Largest CIEDE2000 colour difference of any pixel.", false, true},
    Metric{"wrong_ids", "", "How many ids (faces seen, indices) are not the reference's."},
    Metric{"identical", "", "Whether every bit is the same.", true, false, true},
};

// Pictures are made once, however many metrics look at them.
class Pictures {
 public:
  Pictures(const Raster& a, const Raster& b)
      : a_(picture_of(a)), b_(picture_of(b)), nan_(a_.has_nan() || b_.has_nan()) {}

  double value(std::string_view metric) {
    if (nan_) return nan_value;
    if (metric == "ssim") return ssim(display_luma(a_), display_luma(b_));
    if (metric == "flip") return mean(flip_map(b_, a_));
    const Grid& e = delta_e();
    if (metric == "delta_e_2000") return mean(e);
    return e.values.empty() ? 0 : *std::max_element(e.values.begin(), e.values.end());
  }

 private:
  // Light of a display: [0, 1].
  static glm::dvec3 lab(const Picture& p, std::size_t i) {
    const auto cut = [&](std::size_t c) { return std::clamp(p.rgb[c].values[i], 0.0, 1.0); };
    return lab_of_xyz(xyz_of_rec709({cut(0), cut(1), cut(2)}));
  }

  const Grid& delta_e() {
    if (!delta_e_) {
      delta_e_.emplace(a_.width(), a_.height());
      for (std::size_t i = 0; i < delta_e_->values.size(); ++i)
        delta_e_->values[i] = delta_e_2000(lab(b_, i), lab(a_, i));
    }
    return *delta_e_;
  }

  Picture a_, b_;
  bool nan_;
  std::optional<Grid> delta_e_;
};

double number_value(const Difference& d, std::string_view metric) {
  if (metric == "wrong_ids") return static_cast<double>(d.wrong_ids);
  if (metric == "identical") return d.identical() ? 1 : 0;
  if (d.nan != 0) return nan_value;
  if (metric == "rmse") return d.rmse;
  if (metric == "mrse") return d.mrse;
  if (metric == "max") return d.max;
  if (metric == "ulp")
    return d.ulps.max == UlpHistogram::infinite ? std::numeric_limits<double>::infinity()
                                                : static_cast<double>(d.ulps.max);
  return d.psnr;
}

[[noreturn]] void no_picture_for(std::string_view metric, std::string_view why) {
  throw NodeError("metric_without_picture", fmt::format("{} compares pictures: {}", metric, why));
}

Measured measured(Difference difference, const Raster* a, const Raster* b,
                  std::span<const std::string> metrics) {
  Measured m{std::move(difference), {}};
  std::optional<Pictures> pictures;
  for (const std::string& name : metrics) {
    const Metric* metric = find_metric(name);
    if (metric == nullptr) throw NodeError("bad_metric", fmt::format("no metric '{}'", name));
    if (metric->picture) {
      if (a == nullptr) no_picture_for(name, "these are no pixels");
      for (const Raster* r : {a, b})
        if (const std::string why = no_picture(r->frame()); !why.empty()) no_picture_for(name, why);
    }
    double& value = m.values[name] = nan_value;
    if (!m.difference.mismatch.empty()) continue;
    if (!metric->picture) {
      value = number_value(m.difference, name);
      continue;
    }
    if (!pictures) pictures.emplace(*a, *b);
    value = pictures->value(name);
  }
  return m;
}

bool within(const Measured& m, const MetricBound& bound) {
  if (!m.difference.mismatch.empty() || m.difference.nan != 0) return false;
  const auto at = m.values.find(bound.metric);
  const Metric* metric = find_metric(bound.metric);
  if (at == m.values.end() || metric == nullptr) return false;
  if (metric->yes_or_no) return at->second == 1;
  return metric->at_least ? at->second >= bound.tolerance : at->second <= bound.tolerance;
}

}  // namespace

std::span<const Metric> metrics() { return all_metrics; }

const Metric* find_metric(std::string_view name) {
  const auto at =
      std::find_if(all_metrics.begin(), all_metrics.end(), [&](const Metric& m) { return m.name == name; });
  return at == all_metrics.end() ? nullptr : &*at;
}

std::vector<std::string> metric_names() {
  std::vector<std::string> names;
  for (const Metric& m : all_metrics) names.emplace_back(m.name);
  return names;
}

Measured measure(const Raster& a, const Raster& b, std::span<const std::string> metrics) {
  return measured(compare(a, b), &a, &b, metrics);
}

Measured measure(const Buffer& a, const Buffer& b, std::span<const std::string> metrics) {
  const bool pixels = a.type().is_pixels() && b.type().is_pixels();
  return measured(compare(a, b), pixels ? &a.type().raster(a.data()) : nullptr,
                  pixels ? &b.type().raster(b.data()) : nullptr, metrics);
}

Measured measure(Difference difference, std::span<const std::string> metrics) {
  return measured(std::move(difference), nullptr, nullptr, metrics);
}

bool holds(const Measured& m, const MetricBound& bound) {
  return within(m, bound) && (m.difference.wrong_ids == 0 || bound.metric == "wrong_ids");
}

std::vector<MetricBound> broken(const Measured& m, std::span<const MetricBound> bounds) {
  const bool ids_bounded =
      std::any_of(bounds.begin(), bounds.end(), [](const MetricBound& b) { return b.metric == "wrong_ids"; });
  std::vector<MetricBound> out;
  for (const MetricBound& b : bounds)
    if (!(ids_bounded ? within(m, b) : holds(m, b))) out.push_back(b);
  return out;
}

MetricBound parse_metric_bound(std::string_view text) {
  const auto equals = text.find('=');
  MetricBound bound{std::string(text.substr(0, equals))};
  const Metric* metric = find_metric(bound.metric);
  if (metric == nullptr) {
    const auto near = nearest_names(bound.metric, metric_names());
    throw NodeError("bad_metric",
                    fmt::format("no metric '{}'; {}", bound.metric,
                                near.empty() ? fmt::format("there are {}", fmt::join(metric_names(), ", "))
                                             : fmt::format("did you mean '{}'?", near.front())));
  }
  const std::string number(equals == std::string_view::npos ? "" : text.substr(equals + 1));
  const char* const end = number.data() + number.size();
  const auto [at, problem] = std::from_chars(number.data(), end, bound.tolerance);
  const bool is_number = problem == std::errc{} && at == end && bound.tolerance >= 0;
  if (metric->yes_or_no ? equals != std::string_view::npos : !is_number)
    throw NodeError("bad_metric",
                    metric->yes_or_no
                        ? fmt::format("{} takes no number", bound.metric)
                        : fmt::format("{}: expected METRIC=TOLERANCE, such as rmse=0.01", text));
  return bound;
}

Json to_json(const Measured& m) {
  Json out = to_json(m.difference);
  for (const auto& [name, value] : m.values)
    if (!find_metric(name)->yes_or_no) out[name] = json_number(value);
  return out;
}

std::vector<float> error_map(const Raster& a, const Raster& b) {
  const Frame& f = a.frame();
  const auto is_id = [&](std::size_t p) { return f.planes[p].kind == PlaneKind::u32; };
  bool numbers = false;
  for (std::size_t p = 0; p < f.planes.size(); ++p) numbers |= !is_id(p);
  std::vector<float> out(static_cast<std::size_t>(f.window.area()), 0);
  for (std::size_t p = 0; p < f.planes.size() && !out.empty(); ++p) {
    const auto q = b.frame().find(f.planes[p].name);
    if ((numbers && is_id(p)) || !q) continue;
    const auto width = static_cast<std::size_t>(f.window.width());
    const bool floats = f.planes[p].kind == PlaneKind::f32 &&
                        b.frame().planes[static_cast<std::size_t>(*q)].kind == PlaneKind::f32;
    tbb::parallel_for(f.window.y0, f.window.y1, [&](int y) {
      float* row = out.data() + static_cast<std::size_t>(y - f.window.y0) * width;
      for (int s = 0; floats && s < f.samples(); ++s) {
        const float* va = a.view().row<float>(static_cast<int>(p), s, y);
        const float* vb = b.view().row<float>(*q, s, y);
        for (std::size_t i = 0; i < width; ++i) row[i] = std::max(row[i], distance(va[i], vb[i]));
      }
      if (floats) return;
      for (int x = f.window.x0; x < f.window.x1; ++x, ++row)
        for (int s = 0; s < f.samples(); ++s) {
          const double va = a.value(static_cast<int>(p), s, x, y), vb = b.value(*q, s, x, y);
          const double e = !is_id(p) ? distance(va, vb) : va == vb ? 0 : 1;
          *row = std::max(*row, static_cast<float>(e));
        }
    });
  }
  return out;
}

}  // namespace frustum
