#include "runtime/buffers/numbers.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

namespace frustum {
namespace {

template <class R>
using Bits = std::conditional_t<sizeof(R) == 4, std::int32_t, std::int64_t>;

// The magnitude bits of the largest finite number: every NaN and infinity has larger ones.
template <class R>
constexpr Bits<R> largest_finite = std::bit_cast<Bits<R>>(std::numeric_limits<R>::max());

// 256 values at once: the sign bit of `over` is set where one of them exceeds the largest finite magnitude.
// Subtraction of two non-negative integers does not overflow; and, sub, or exist in every vector
// instruction set.
template <class R>
bool all_finite(const R* v) {
  Bits<R> over = 0;
  for (int i = 0; i < 256; ++i)
    over |= largest_finite<R> - (std::bit_cast<Bits<R>>(v[i]) & std::numeric_limits<Bits<R>>::max());
  return over >= 0;
}

template <class R>
void count_each(const R* values, std::size_t begin, std::size_t end, Scan& out) {
  for (std::size_t i = begin; i < end; ++i) {
    if (std::isfinite(values[i])) continue;
    if (std::isnan(values[i]))
      ++out.nan;
    else if (values[i] > 0)
      ++out.positive_infinity;
    else
      ++out.negative_infinity;
    if (!out.first) out.first = i;
  }
}

template <class R>
Scan scan_range(const R* values, std::size_t begin, std::size_t end, Scan out = {}) {
  for (; begin + 256 <= end; begin += 256)
    if (!all_finite(values + begin)) count_each(values, begin, begin + 256, out);
  count_each(values, begin, end, out);
  return out;
}

Scan joined(Scan a, const Scan& b) {
  a.nan += b.nan, a.positive_infinity += b.positive_infinity, a.negative_infinity += b.negative_infinity;
  if (!a.first) a.first = b.first;
  return a;
}

template <class R>
Scan scan_all(std::span<const R> v) {
  constexpr std::size_t grain = std::size_t{1} << 17;
  if (v.size() <= 2 * grain) return scan_range(v.data(), 0, v.size());
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, v.size(), grain), Scan{},
      [&](const auto& r, Scan s) { return scan_range(v.data(), r.begin(), r.end(), std::move(s)); }, joined);
}

// Moves what is finite to the front, in order, and counts the rest.
template <class T>
void keep_finite(std::vector<T>& values, Statistics& s) {
  if constexpr (std::is_floating_point_v<T>) {
    const Scan found = scan(std::span<const T>(values));
    s.nan = found.nan;
    s.positive_infinity = found.positive_infinity, s.negative_infinity = found.negative_infinity;
    if (found.first) std::erase_if(values, [](T v) { return !std::isfinite(v); });
    s.denormal = static_cast<std::uint64_t>(std::count_if(values.begin(), values.end(), [](T v) {
      return v != 0 && std::abs(v) < std::numeric_limits<T>::min();
    }));
  }
  s.count = values.size();
}

template <class T>
void fill_histogram(const std::vector<T>& values, Statistics& s) {
  // Halves before the difference, so that a range of the whole of double does not overflow.
  const double half_width = s.max / 2 - s.min / 2;
  for (const T v : values) {
    const double t = half_width > 0 ? (static_cast<double>(v) / 2 - s.min / 2) / half_width : 0;
    const auto bin = static_cast<std::size_t>(t * static_cast<double>(Statistics::bins));
    ++s.histogram[std::min(bin, Statistics::bins - 1)];
  }
}

template <class T>
Statistics measure_all(std::vector<T> values) {
  Statistics s;
  keep_finite(values, s);
  if (values.empty()) return s;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  s.min = static_cast<double>(*low), s.max = static_cast<double>(*high);
  // Each term is divided first where the plain sum would overflow.
  double sum = 0;
  for (const T v : values) sum += static_cast<double>(v);
  const auto n = static_cast<double>(values.size());
  if (!std::isfinite(sum)) {
    sum = 0;
    for (const T v : values) sum += static_cast<double>(v) / n;
    s.mean = sum;
  } else {
    s.mean = sum / n;
  }
  fill_histogram(values, s);
  auto from = values.begin();
  for (std::size_t q = 0; q < Statistics::quantiles.size(); ++q) {
    const auto rank = static_cast<std::ptrdiff_t>(Statistics::quantiles[q] * (n - 1));
    const auto nth = values.begin() + rank;
    std::nth_element(from, nth, values.end());
    s.percentiles[q] = static_cast<double>(*nth);
    from = nth;
  }
  return s;
}

}  // namespace

Scan scan(std::span<const float> v) { return scan_all(v); }
Scan scan(std::span<const double> v) { return scan_all(v); }

Health health_of(std::string_view owner, std::span<const std::pair<std::string_view, double>> values) {
  std::vector<double> numbers;
  for (const auto& [name, v] : values) numbers.push_back(v);
  return to_health(scan(std::span<const double>(numbers)), numbers.size(),
                   [&](std::size_t i) { return std::string(owner) + ", " + std::string(values[i].first); });
}

Statistics measure(std::vector<float> values) { return measure_all(std::move(values)); }
Statistics measure(std::vector<double> values) { return measure_all(std::move(values)); }
Statistics measure(std::vector<std::uint32_t> values) { return measure_all(std::move(values)); }
Statistics measure(std::vector<std::int32_t> values) { return measure_all(std::move(values)); }

Json to_json(const Statistics& s) {
  Json out = {{"count", s.count}};
  if (s.count != 0) {
    out["min"] = s.min, out["max"] = s.max, out["mean"] = s.mean;
    Json& percentiles = out["percentiles"] = Json::object();
    for (std::size_t i = 0; i < Statistics::quantiles.size(); ++i)
      percentiles[std::to_string(std::lround(Statistics::quantiles[i] * 100))] = s.percentiles[i];
    out["histogram"] = s.histogram;
  }
  const std::pair<const char*, std::uint64_t> unusual[] = {{"nan", s.nan},
                                                           {"positive_infinity", s.positive_infinity},
                                                           {"negative_infinity", s.negative_infinity},
                                                           {"denormal", s.denormal}};
  for (const auto& [name, n] : unusual)
    if (n != 0) out[name] = n;
  return out;
}

Json json_number(double v) {
  if (std::isnan(v)) return "nan";
  if (std::isinf(v)) return v > 0 ? "inf" : "-inf";
  return v;
}

Json json_number(float v) {
  if (!std::isfinite(v)) return json_number(static_cast<double>(v));
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), v).ptr;
  double shortest = 0;
  std::from_chars(text.data(), end, shortest);
  return shortest;
}

Json json_number(std::uint32_t v) { return v; }
Json json_number(std::int32_t v) { return v; }

Json json_table(Json columns, std::size_t total, std::size_t first, std::size_t count,
                const std::function<Json(std::size_t)>& row) {
  Json rows = Json::array();
  const std::size_t end = first < total ? first + std::min(count, total - first) : first;
  for (std::size_t i = first; i < end; ++i) rows.push_back(row(i));
  return {{"columns", std::move(columns)}, {"rows", std::move(rows)}, {"total", total}};
}

}  // namespace frustum
