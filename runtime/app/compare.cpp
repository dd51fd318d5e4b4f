#include "runtime/app/compare.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <bit>
#include <cmath>
#include <limits>

namespace frustum {
namespace {

struct Pair {
  double a, b;
  bool same_bits;
  double distance() const {
    return a == b ? 0 : std::abs(a - b);
  }  // a == b covers infinities, whose difference is NaN
};

template <class T>
bool equal_bits(T a, T b) {
  if constexpr (std::is_same_v<T, float>)
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
  else if constexpr (std::is_same_v<T, double>)
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  else
    return a == b;
}

// Calls see(x, pair) along one row; T is the kind of both, or void where the kinds differ.
template <class T, class See>
void same_kind_row(const Tile& a, int pa, const Tile& b, int pb, int s, int y, See& see) {
  const T* ra = a.row<T>(pa, s, y);
  const T* rb = b.row<T>(pb, s, y);
  for (int i = 0; i < a.rect().width(); ++i)
    see(a.rect().x0 + i,
        Pair{static_cast<double>(ra[i]), static_cast<double>(rb[i]), equal_bits(ra[i], rb[i])});
}

template <class See>
void plane_row(const Raster& a, int pa, const Raster& b, int pb, int s, int y, See& see) {
  const PlaneKind ka = a.frame().planes[static_cast<std::size_t>(pa)].kind;
  const PlaneKind kb = b.frame().planes[static_cast<std::size_t>(pb)].kind;
  const Tile ta = a.view(), tb = b.view();
  if (ka == kb && ka == PlaneKind::f32) return same_kind_row<float>(ta, pa, tb, pb, s, y, see);
  if (ka == kb && ka == PlaneKind::f64) return same_kind_row<double>(ta, pa, tb, pb, s, y, see);
  if (ka == kb) return same_kind_row<std::uint32_t>(ta, pa, tb, pb, s, y, see);
  for (int x = a.frame().window.x0; x < a.frame().window.x1; ++x) {
    const double va = a.value(pa, s, x, y), vb = b.value(pb, s, x, y);
    see(x, Pair{va, vb, equal_bits(va, vb)});
  }
}

// Calls see(plane of a, sample, y, x, pair) for every value, planes outermost.
template <class See>
void each_value(const Raster& a, const Raster& b, See see) {
  const Frame& f = a.frame();
  for (int p = 0; p < static_cast<int>(f.planes.size()); ++p) {
    const int q = *b.frame().find(f.planes[static_cast<std::size_t>(p)].name);
    for (int s = 0; s < f.samples(); ++s)
      for (int y = f.window.y0; y < f.window.y1; ++y) {
        auto row = [&](int x, const Pair& pair) { see(p, s, y, x, pair); };
        plane_row(a, p, b, q, s, y, row);
      }
  }
}

std::string shown(const Rect& r) { return fmt::format("{}x{} at {},{}", r.width(), r.height(), r.x0, r.y0); }

std::string mismatch(const Frame& a, const Frame& b) {
  if (a.window != b.window)
    return fmt::format("the windows differ: {} and {}", shown(a.window), shown(b.window));
  if (a.samples() != b.samples())
    return fmt::format("the samples a pixel differ: {} and {}", a.samples(), b.samples());
  std::vector<std::string> only_a, only_b;
  for (const Plane& p : a.planes)
    if (!b.find(p.name)) only_a.push_back(p.name);
  for (const Plane& p : b.planes)
    if (!a.find(p.name)) only_b.push_back(p.name);
  if (!only_a.empty()) return fmt::format("only the first has the planes {}", fmt::join(only_a, ", "));
  if (!only_b.empty()) return fmt::format("only the second has the planes {}", fmt::join(only_b, ", "));
  return {};
}

Json number(double v) {  // JSON has no infinities and no NaN
  if (std::isnan(v)) return "nan";
  if (std::isinf(v)) return v > 0 ? "inf" : "-inf";
  return v;
}

}  // namespace

Difference compare(const Raster& a, const Raster& b) {
  Difference d;
  d.mismatch = mismatch(a.frame(), b.frame());
  if (!d.mismatch.empty()) return d;
  double squares = 0, worst = -1;
  each_value(a, b, [&](int plane, int sample, int y, int x, const Pair& pair) {
    ++d.values;
    d.differing += pair.same_bits ? 0 : 1;
    const bool nan = std::isnan(pair.a) || std::isnan(pair.b);
    d.nan += nan ? 1 : 0;
    const double e = nan ? std::numeric_limits<double>::quiet_NaN() : pair.distance();
    squares += e * e;
    const double rank = nan ? std::numeric_limits<double>::infinity() : e;
    if (rank > worst && (nan || !pair.same_bits)) {
      worst = rank;
      d.worst = {a.frame().planes[static_cast<std::size_t>(plane)].name, x, y, sample, pair.a, pair.b};
    }
  });
  d.max = d.nan != 0 ? std::numeric_limits<double>::quiet_NaN() : std::max(worst, 0.0);
  d.rmse = d.values != 0 ? std::sqrt(squares / static_cast<double>(d.values)) : 0;
  d.psnr = d.rmse == 0 ? std::numeric_limits<double>::infinity() : -20 * std::log10(d.rmse);
  return d;
}

std::uint64_t count_beyond(const Raster& a, const Raster& b, double tolerance) {
  std::uint64_t count = 0;
  each_value(a, b,
             [&](int, int, int, int, const Pair& pair) { count += pair.distance() <= tolerance ? 0 : 1; });
  return count;
}

Json to_json(const Difference& d) {
  if (!d.mismatch.empty()) return {{"mismatch", d.mismatch}, {"identical", false}};
  Json out = {
      {"identical", d.identical()}, {"values", d.values},   {"differing", d.differing}, {"nan", d.nan},
      {"rmse", number(d.rmse)},     {"max", number(d.max)}, {"psnr", number(d.psnr)}};
  if (d.worst)
    out["worst"] = {{"plane", d.worst->plane},   {"x", d.worst->x},         {"y", d.worst->y},
                    {"sample", d.worst->sample}, {"a", number(d.worst->a)}, {"b", number(d.worst->b)}};
  return out;
}

const std::vector<std::string>& metric_names() {
  static const std::vector<std::string> names{"rmse", "max", "psnr", "identical"};
  return names;
}

double value_of(const Difference& d, std::string_view metric) {
  if (metric == "rmse") return d.rmse;
  if (metric == "max") return d.max;
  if (metric == "psnr") return d.psnr;
  return d.identical() ? 1 : 0;
}

bool holds(const Difference& d, const MetricBound& bound) {
  if (!d.mismatch.empty() || d.nan != 0) return false;
  if (bound.metric == "identical") return d.identical();
  const double v = value_of(d, bound.metric);
  return bound.metric == "psnr" ? v >= bound.tolerance : v <= bound.tolerance;
}

}  // namespace frustum
