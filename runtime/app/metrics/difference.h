// How far the numbers of two buffers are apart, value by value, in one pass.
#pragma once

#include "runtime/core/buffer.h"

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>

namespace frustum {

// Where two buffers differ most.
struct WorstValue {
  std::string plane;               // "R", "position.y"
  int x = 0, y = 0, sample = 0;    // of pixels
  std::optional<std::size_t> row;  // of anything else: a vertex, corner, face or row of a table
  double a = 0, b = 0;

  std::string place() const;  // "R at 3,4", "position.y of row 17"
};

// Distances in units in the last place: how many numbers of the stored type lie between two values. Where the
// types differ, the double is rounded to float first and the distance is one of floats. Both zeros are one
// number; where one side alone is infinite the distance is `infinite`.
struct UlpHistogram {
  static constexpr std::uint64_t infinite = ~std::uint64_t{0};
  std::array<std::uint64_t, 66>
      bins{};  // bin 0: equal; bin k: distances in [2^(k-1), 2^k); the last: infinite
  std::uint64_t max = 0;

  void add(std::uint64_t ulps) {
    ++bins[ulps == infinite ? 65 : static_cast<std::size_t>(std::bit_width(ulps))];
    max = ulps > max ? ulps : max;
  }
};
std::uint64_t ulps_between(float a, float b);    // neither is NaN
std::uint64_t ulps_between(double a, double b);  // neither is NaN

// Numbers are measured by their distance, b being the reference; ids (planes and columns of integers) are
// right or wrong, whatever their distance.
struct Difference {
  std::string
      mismatch;  // of kind, size, samples, planes: then nothing else was compared; empty where they match
  std::uint64_t values = 0;     // compared: numbers and ids
  std::uint64_t differing = 0;  // not bit for bit the same
  std::uint64_t nan = 0;        // where either side is NaN
  std::uint64_t ids = 0, wrong_ids = 0;
  double rmse = 0, max = 0;  // of the numbers; NaN where any is
  double mrse =
      0;  // mean of (a - b)^2 / (|b| + 0.01)^2: the mean relative squared error of pbrt-v4's imgtool
  double largest = 0;  // of the reference's numbers, without sign; finite ones only
  double psnr = 0;     // dB for a peak of 1; infinite where rmse is 0
  UlpHistogram ulps;
  std::optional<WorstValue> worst;

  bool identical() const { return mismatch.empty() && differing == 0 && nan == 0; }
};

// Planes are matched by name; windows, sample counts and plane names must agree. NaN on either side never
// compares equal. Cost: one pass, some 5 ns a value; sums are taken in a fixed order.
Difference compare(const Raster& a, const Raster& b);

// Pixels as above. Meshes column by column (matched by domain and name). Other kinds by the cells of their
// table, in double. Kinds without a table: whether they are the same bytes.
Difference compare(const Buffer& a, const Buffer& b);

// Tables as buffers and CSV files give them, {"columns", "rows"}, cell by cell; a text is right or wrong like
// an id.
Difference compare_tables(const Json& a, const Json& b);

// Numbers further apart than `tolerance` or NaN, and wrong ids. The frames match.
std::uint64_t count_beyond(const Raster& a, const Raster& b, double tolerance);

// The numbers above; "ulps": {"max", "histogram": {"0": n, "1": n, "2-3": n, ...}} without empty bins.
Json to_json(const Difference&);

}  // namespace frustum
