// Every way in which two buffers are measured against each other, by name: `frustum diff`, suites and sweeps
// use these and no others.
//
// NaN passes nothing: a value that is NaN on either side makes every metric of numbers or colours NaN, is
// counted, and breaks every bound.
#pragma once

#include "runtime/app/metrics/difference.h"

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

struct Metric {
  std::string_view name, unit, doc;
  bool at_least = false;   // a bound is a least value (psnr, ssim) and not a greatest one
  bool picture = false;    // looks at colours: needs the planes R, G, B or Y and one value a pixel
  bool yes_or_no = false;  // identical: 1 or 0, and its bound takes no number
};
// rmse, mrse, max, ulp, psnr, ssim, flip, delta_e_2000, delta_e_2000_max, wrong_ids, identical.
std::span<const Metric> metrics();
const Metric* find_metric(std::string_view name);  // null where there is none
std::vector<std::string> metric_names();

struct Measured {
  Difference difference;
  std::map<std::string, double, std::less<>> values;  // of the metrics asked for; NaN for a mismatch
};

// `b` is the reference. Throws NodeError("metric_without_picture") where a metric looks at colours and there
// are none. Cost: one pass for all the metrics of numbers; 0.1 to 0.5 us a pixel for each that looks at
// colours.
Measured measure(const Buffer& a, const Buffer& b, std::span<const std::string> metrics);
Measured measure(const Raster& a, const Raster& b, std::span<const std::string> metrics);
Measured measure(Difference difference, std::span<const std::string> metrics);  // of what is no pixels

struct MetricBound {
  std::string metric;
  double tolerance = 0;  // not read for identical
};
// The same as the value of `measured`, which has it: false for a mismatch, any NaN, and where ids are wrong
// (unless wrong_ids is what is asked).
bool holds(const Measured& measured, const MetricBound& bound);

// The bounds that do not hold. Wrong ids break a bound on numbers or colours only where wrong_ids has no
// bound of its own.
std::vector<MetricBound> broken(const Measured& measured, std::span<const MetricBound> bounds);

// "rmse=0.01", "identical". Throws NodeError("bad_metric") for an unknown name (with the nearest) or no
// number.
MetricBound parse_metric_bound(std::string_view text);

// to_json(difference) with the values of all metrics asked for.
Json to_json(const Measured& measured);

// Per pixel, the largest distance of any plane of numbers over all samples (1 for a wrong id where there are
// no numbers, infinity for NaN): for heat maps. The frames match.
std::vector<float> error_map(const Raster& a, const Raster& b);

}  // namespace frustum
