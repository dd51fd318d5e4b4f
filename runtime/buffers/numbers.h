// Arrays of numbers as evidence: what is not finite and where, statistics, digests, cells of a table.
#pragma once

#include "runtime/core/buffer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace frustum {

// Counts of values that are not finite, and the index of the first of them.
struct Scan {
  std::uint64_t nan = 0, positive_infinity = 0, negative_infinity = 0;
  std::optional<std::size_t> first;
};

// One pass with bit tests (the compiler vectorises them), parallel above 2^18 values; about memory speed
// where all is finite. Integers are always finite. The result does not depend on the number of threads.
Scan scan(std::span<const float>);
Scan scan(std::span<const double>);

// `found` as health of `values` numbers; `place` is asked for the text of the first place only where there
// is one.
template <class Place>
Health to_health(const Scan& found, std::size_t values, Place&& place) {
  Health h{values, found.nan, found.positive_infinity, found.negative_infinity, {}};
  if (found.first) h.first = place(*found.first);
  return h;
}

// Health of a few named doubles: parameters of a camera, a light.
Health health_of(std::string_view owner, std::span<const std::pair<std::string_view, double>> values);

struct Statistics {
  static constexpr std::array<double, 7> quantiles{0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99};
  static constexpr std::size_t bins = 64;

  std::uint64_t count = 0;  // of finite values: everything below is about these
  std::uint64_t nan = 0, positive_infinity = 0, negative_infinity = 0;
  std::uint64_t denormal = 0;  // below the smallest normal number of the stored type, and not zero
  double min = 0, max = 0;     // 0 where count is 0, like the rest
  double mean = 0;             // the sum in order of the values, in double, over count
  std::array<double, quantiles.size()>
      percentiles{};  // the value of rank floor(q (count - 1)): always one that occurs
  std::array<std::uint64_t, bins> histogram{};  // equal bins from min to max, the last one closed
};

// Takes the values (they are reordered). Cost: O(n), some 15 ns a value.
Statistics measure(std::vector<float> values);
Statistics measure(std::vector<double> values);
Statistics measure(std::vector<std::uint32_t> values);
Statistics measure(std::vector<std::int32_t> values);

// {"count", "min", "max", "mean", "percentiles": {"1": ...}, "histogram": [...], "nan", ...}; min to
// histogram are absent where no value is finite, counts of the unusual where they are zero.
Json to_json(const Statistics&);

// A number as JSON: a float by its shortest decimal form, what is not finite as "nan", "inf", "-inf" (JSON
// has none).
Json json_number(float);
Json json_number(double);
Json json_number(std::uint32_t);
Json json_number(std::int32_t);

// Rows [first, first + count) of `total`, cut to what there is: {"columns", "rows", "total"}. `row` makes
// one.
Json json_table(Json columns, std::size_t total, std::size_t first, std::size_t count,
                const std::function<Json(std::size_t)>& row);

}  // namespace frustum
