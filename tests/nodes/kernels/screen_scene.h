// Screen triangles for the tests of the rasterizer's kernels, and an exact reference that shares no code with
// them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "nodes/kernels/fill_triangles.h"
#include "nodes/kernels/simd/fill_triangles.h"
#include "tests/support/ulps.h"

namespace frustum::test {

struct Pattern {
  int samples = 1, period = 1;
  std::vector<std::uint16_t> x{2048}, y{2048};

  kernels::SamplePositions view() const { return {samples, period, x, y}; }
};

inline Pattern random_pattern(Random& random, int samples, int period) {
  Pattern p{samples, period, {}, {}};
  for (int i = 0; i < samples * period * period; ++i) {
    p.x.push_back(static_cast<std::uint16_t>(random.below(4096)));
    p.y.push_back(static_cast<std::uint16_t>(random.below(4096)));
  }
  return p;
}

template <class R>
struct ScreenScene {
  std::vector<glm::vec<4, R>> position;
  std::vector<glm::uvec3> face;
  std::vector<std::uint32_t> origin;
  int corner_bits = 8;

  std::uint32_t vertex(double x, double y, double z = 0.5, double per_w = 1) {
    position.emplace_back(static_cast<R>(x), static_cast<R>(y), static_cast<R>(z), static_cast<R>(per_w));
    return static_cast<std::uint32_t>(position.size() - 1);
  }
  void triangle(std::array<double, 3> a, std::array<double, 3> b, std::array<double, 3> c) {
    const std::uint32_t i = vertex(a[0], a[1], a[2]), j = vertex(b[0], b[1], b[2]),
                        k = vertex(c[0], c[1], c[2]);
    face.emplace_back(i, j, k);
  }
  kernels::ScreenMesh<R> view() const { return {position, face, origin, corner_bits}; }
};

// What a fill gives, sample by sample.
template <class R>
struct Filled {
  kernels::PixelRect window;
  int samples;
  std::vector<std::uint32_t> id;
  std::vector<R> z;

  Filled(kernels::PixelRect w, int n)
      : window(w),
        samples(n),
        id(static_cast<std::size_t>((w.x1 - w.x0) * (w.y1 - w.y0) * n), 0xAAAAAAAAu),
        z(id.size(), R(-77)) {}
  int width() const { return window.x1 - window.x0; }
  int height() const { return window.y1 - window.y0; }
  std::size_t at(int sample, int x, int y) const {
    return static_cast<std::size_t>((sample * height() + y - window.y0) * width() + x - window.x0);
  }
  template <class T>
  kernels::PlaneView<T> plane(std::vector<T>& of, kernels::PixelRect rect) const {
    return {of.data() + at(0, rect.x0, rect.y0), width(), std::ptrdiff_t{width()} * height()};
  }
  bool same_bytes(const Filled& other) const {
    return id == other.id && std::memcmp(z.data(), other.z.data(), z.size() * sizeof(R)) == 0;
  }
};

// Fills the window rectangle by rectangle: with the scalar twin, or with the vectors of the current target.
enum class Twin { scalar, vector };
template <class R>
Filled<R> fill(const ScreenScene<R>& scene, const Pattern& pattern, kernels::PixelRect window, Twin twin,
               const std::vector<kernels::PixelRect>& rects = {},
               kernels::DepthOrder order = kernels::DepthOrder::standard) {
  const kernels::TriangleBins bins = kernels::bin_triangles(scene.view(), pattern.view(), window);
  const kernels::FillScene<R> from{scene.view(), pattern.view(), &bins, order};
  Filled<R> out(window, pattern.samples);
  for (const kernels::PixelRect& rect : rects.empty() ? std::vector{window} : rects) {
    if constexpr (std::is_same_v<R, float>)
      if (twin == Twin::vector) {
        kernels::simd::fill_triangles(from, rect, out.plane(out.id, rect), out.plane(out.z, rect));
        continue;
      }
    kernels::fill_triangles<R>(from, rect, out.plane(out.id, rect), out.plane(out.z, rect));
  }
  return out;
}

inline std::vector<kernels::PixelRect> tiles(kernels::PixelRect window, int width, int height) {
  std::vector<kernels::PixelRect> rects;
  for (int y = window.y0; y < window.y1; y += height)
    for (int x = window.x0; x < window.x1; x += width)
      rects.push_back({x, y, std::min(x + width, window.x1), std::min(y + height, window.y1)});
  return rects;
}

// The reference: is the sample inside the triangle, in 128-bit integers of 2^-12 px? A sample on an edge
// counts as moved by (e, e^2), e -> 0: right into the triangle that has the edge at its left, or down into
// the one that has it on top.
class ExactTriangle {
 public:
  template <class R>
  ExactTriangle(const ScreenScene<R>& scene, std::size_t face) {
    for (int k = 0; k < 3; ++k) {
      const auto& p = scene.position[scene.face[face][k]];
      const bool sane =
          std::fabs(p.x) <= 2097152 && std::fabs(p.y) <= 2097152 && std::isfinite(p.z) && std::isfinite(p.w);
      valid_ = valid_ && sane;
      if (!sane) continue;
      const auto grid = [&](long double v) {
        return static_cast<__int128>(std::nearbyint(std::ldexp(v, scene.corner_bits)))
               << (12 - scene.corner_bits);
      };
      x_[k] = grid(p.x);
      y_[k] = grid(p.y);
      z_[k] = p.z;
    }
    valid_ = valid_ && area() != 0;
  }

  bool valid() const { return valid_; }
  __int128 area() const { return (x_[1] - x_[0]) * (y_[2] - y_[0]) - (x_[2] - x_[0]) * (y_[1] - y_[0]); }

  bool covers(std::int64_t sx, std::int64_t sy) const {
    if (!valid_) return false;
    const int turn = area() > 0 ? 1 : -1;
    for (int k = 0; k < 3; ++k) {
      const int n = (k + 1) % 3;
      const __int128 dx = (x_[n] - x_[k]) * turn, dy = (y_[n] - y_[k]) * turn;
      const __int128 e = dx * (sy - y_[k]) - dy * (sx - x_[k]);
      const bool inside = e != 0 ? e > 0 : dy != 0 ? dy < 0 : dx > 0;
      if (!inside) return false;
    }
    return true;
  }

  // Depth in the plane of the corners, and how much it changes over half a grid step of a corner.
  long double depth(std::int64_t sx, std::int64_t sy) const {
    long double z = 0;
    for (int k = 0; k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      const __int128 e = (x_[b] - x_[a]) * (sy - y_[a]) - (y_[b] - y_[a]) * (sx - x_[a]);
      z += static_cast<long double>(e) / static_cast<long double>(area()) * static_cast<long double>(z_[k]);
    }
    return z;
  }

 private:
  bool valid_ = true;
  __int128 x_[3]{}, y_[3]{};
  double z_[3]{};
};

}  // namespace frustum::test
