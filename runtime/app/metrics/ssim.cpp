#include "runtime/app/metrics/ssim.h"

#include "nodes/kernels/parallel.h"
#include "nodes/kernels/transfer.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace frustum {
namespace {

constexpr int radius = 5;
constexpr double sigma = 1.5, c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;

std::array<double, 2 * radius + 1> gaussian() {
  std::array<double, 2 * radius + 1> g{};
  for (int i = -radius; i <= radius; ++i)
    g[static_cast<std::size_t>(i + radius)] = std::exp(-i * i / (2 * sigma * sigma));
  return g;
}

// The weighted mean over the window around each value of one row or column; `at` reads, i runs over n values.
template <class At, class Put>
void window_means(int n, const At& at, const Put& put) {
  static const auto g = gaussian();
  for (int i = 0; i < n; ++i) {
    double s = 0, w = 0;
    for (int k = std::max(-radius, -i); k <= std::min(radius, n - 1 - i); ++k) {
      const double weight = g[static_cast<std::size_t>(k + radius)];
      s += weight * at(i + k), w += weight;
    }
    put(i, s / w);
  }
}

Grid blurred(const Grid& in) {
  Grid rows(in.width, in.height), out(in.width, in.height);
  kernels::parallel_blocks(static_cast<std::size_t>(in.height), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      window_means(
          in.width, [&](int x) { return in.at(x, y); }, [&](int x, double v) { rows.at(x, y) = v; });
  });
  kernels::parallel_blocks(static_cast<std::size_t>(in.width), 16, [&](std::size_t begin, std::size_t end) {
    for (int x = static_cast<int>(begin); x < static_cast<int>(end); ++x)
      window_means(
          in.height, [&](int y) { return rows.at(x, y); }, [&](int y, double v) { out.at(x, y) = v; });
  });
  return out;
}

Grid product(const Grid& a, const Grid& b) {
  Grid out(a.width, a.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = a.values[i] * b.values[i];
  return out;
}

}  // namespace

Grid display_luma(const Picture& p) {
  constexpr std::array weights{0.2126, 0.7152, 0.0722};
  Grid out(p.width(), p.height());
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < out.values.size(); ++i)
      out.values[i] +=
          weights[c] * std::clamp(kernels::encode(kernels::Curve::srgb, p.rgb[c].values[i]), 0.0, 1.0);
  return out;
}

Grid ssim_map(const Grid& a, const Grid& b) {
  const Grid ma = blurred(a), mb = blurred(b);
  const Grid aa = blurred(product(a, a)), bb = blurred(product(b, b)), ab = blurred(product(a, b));
  Grid out(a.width, a.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    const double x = ma.values[i], y = mb.values[i];
    const double variances = aa.values[i] - x * x + (bb.values[i] - y * y), covariance = ab.values[i] - x * y;
    out.values[i] = (2 * x * y + c1) * (2 * covariance + c2) / ((x * x + y * y + c1) * (variances + c2));
  }
  return out;
}

double ssim(const Grid& a, const Grid& b) {
  const Grid map = ssim_map(a, b);
  if (map.width <= 2 * radius || map.height <= 2 * radius) return map.values.empty() ? 1 : mean(map);
  Grid inner(map.width - 2 * radius, map.height - 2 * radius);
  for (int y = 0; y < inner.height; ++y)
    for (int x = 0; x < inner.width; ++x) inner.at(x, y) = map.at(x + radius, y + radius);
  return mean(inner);
}

}  // namespace frustum
