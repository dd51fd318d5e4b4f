// How far two rasters are apart.
#pragma once

#include "runtime/core/diagnostic.h"
#include "runtime/core/raster.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// Where two rasters differ most.
struct WorstValue {
  std::string plane;
  int x = 0, y = 0, sample = 0;
  double a = 0, b = 0;
};

struct Difference {
  std::string mismatch;  // of size, samples or planes: then nothing else was compared; empty where they match
  std::uint64_t values = 0;     // compared: pixels x samples x planes
  std::uint64_t differing = 0;  // not bit for bit the same
  std::uint64_t nan = 0;        // where either side is NaN
  double rmse = 0, max = 0;     // NaN where any value is; planes of counts and ids as numbers
  double psnr = 0;              // dB for a peak of 1; infinite where rmse is 0
  std::optional<WorstValue> worst;

  bool identical() const { return mismatch.empty() && differing == 0 && nan == 0; }
};

// Planes are matched by name; windows, sample counts and plane names must agree. NaN on either side never
// compares equal. Cost: one pass; sums are taken in a fixed order.
Difference compare(const Raster& a, const Raster& b);

// Values further apart than `tolerance`, or NaN.
std::uint64_t count_beyond(const Raster& a, const Raster& b, double tolerance);

Json to_json(const Difference&);

// A bound on one metric: "rmse", "max" (at most), "psnr" (at least), "identical" (no number).
struct MetricBound {
  std::string metric;
  double tolerance = 0;
};
const std::vector<std::string>& metric_names();
double value_of(const Difference&, std::string_view metric);  // identical: 1 or 0
bool holds(const Difference&, const MetricBound&);            // false for a mismatch, and for any NaN

}  // namespace frustum
