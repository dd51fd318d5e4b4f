#include "runtime/core/health.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numeric>

namespace frustum {
namespace {

// 0 times a real is 0 exactly where the real is finite, and a sum of such products exactly where all are. Sixteen
// sums let the compiler use vectors without changing an order.
template <class R>
bool all_finite(const R* row, int n) {
  constexpr int lanes = 16;
  std::array<R, lanes> sum{};
  int i = 0;
  for (; i + lanes <= n; i += lanes)
    for (int k = 0; k < lanes; ++k) sum[static_cast<std::size_t>(k)] += row[i + k] * R(0);
  for (; i < n; ++i) sum[0] += row[i] * R(0);
  return std::accumulate(sum.begin(), sum.end(), R(0)) == R(0);
}

template <class R>
void inspect_row(const Tile& t, int plane, int sample, int y, Health& h) {
  const R* row = t.row<const R>(plane, sample, y);
  const int n = t.rect().width();
  h.values += static_cast<std::uint64_t>(n);
  if (all_finite(row, n)) return;
  for (int i = 0; i < n; ++i) {
    if (std::isfinite(row[i])) continue;
    if (h.finite()) {
      h.pixel = {t.rect().x0 + i, y};
      h.first =
          fmt::format("plane {}, sample {}, pixel {},{}",
                      t.frame().planes[static_cast<std::size_t>(plane)].name, sample, t.rect().x0 + i, y);
    }
    if (std::isnan(row[i]))
      ++h.nan;
    else if (row[i] > 0)
      ++h.positive_infinity;
    else
      ++h.negative_infinity;
  }
}

}  // namespace

Health health_of(const Tile& t) {
  Health h;
  if (t.empty() || t.rect().empty()) return h;
  for (int p = 0; p < static_cast<int>(t.frame().planes.size()); ++p) {
    const PlaneKind kind = t.frame().planes[static_cast<std::size_t>(p)].kind;
    if (!t.has(p) || kind == PlaneKind::u32) continue;
    for (int s = 0; s < t.samples(); ++s)
      for (int y = t.rect().y0; y < t.rect().y1; ++y) {
        if (kind == PlaneKind::f32)
          inspect_row<float>(t, p, s, y, h);
        else
          inspect_row<double>(t, p, s, y, h);
      }
  }
  return h;
}

}  // namespace frustum
