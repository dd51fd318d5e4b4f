// A depth buffer of few bits, and depths found in another way: what resolution of depth costs, and what it hides.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "nodes/kernels/clip_space.h"
#include "nodes/kernels/fill_triangles.h"

namespace frustum::zbuffer {

using kernels::PixelRect;
using kernels::PlaneView;

// In what a depth is kept. Whole numbers divide the range of depths evenly; reals are finest around 0, where
// reversed depth has the far plane.
enum class Format : std::uint8_t { unorm16, unorm24, unorm32, float32, real };
// How the depth between corners is found: from the plane through them, or along two sides and then along the line
// between those. The same but for rounding, since depth after the divide is linear on the screen.
enum class Interpolation : std::uint8_t { plane, edges };

// The nearest depth that the format holds. `low` is the least depth of the range (-1 or 0); depths
// outside [low, 1] become its ends, and 1 stays 1. Monotone. Computed in binary64: in binary32 2^24 - 1 would round up.
inline double kept(Format format, double depth, double low) {
  if (format == Format::real) return depth;
  if (format == Format::float32) return static_cast<double>(static_cast<float>(depth));
  const double steps = format == Format::unorm16   ? 0x1p16 - 1
                       : format == Format::unorm24 ? 0x1p24 - 1
                                                   : 0x1p32 - 1;
  double unit = (depth - low) / (1 - low);
  unit = unit > 0 ? unit : 0;  // NaN too
  unit = unit < 1 ? unit : 1;
  return low + (1 - low) * (std::floor(unit * steps + 0.5) / steps);
}

// An offset of depth that is one number for a face, in window depth, which runs from 0 to 1 whatever the range of NDC:
// slope * m + constant * r, cut off at `clamp` on its side of 0 (0: not at all).
//   m  the greater of |dz / dx| and |dz / dy|, per px
//   r  the least difference of depths that the format keeps apart: see least_difference
// Positive offsets add to depth: farther away, or with reversed depth nearer.
// Source: Vulkan 1.3, Depth Bias; OpenGL 4.6 core profile, 14.6.5 Depth Offset; Direct3D 11.3, 15.10 Depth Bias.
struct Bias {
  double constant = 0, slope = 0, clamp = 0;

  bool any() const { return constant != 0 || slope != 0; }
  double offset(double m, double r) const {
    const double o = slope * m + constant * r;
    return clamp > 0 ? std::min(o, clamp) : clamp < 0 ? std::max(o, clamp) : o;
  }
};

// r in window depth: 2^-n of whole numbers of n bits (Direct3D: 1 / (2^n - 1)); of reals with a significand of `digits`
// bits after the point 2^(e - digits), where 2^e <= |z| < 2^(e + 1) for the greatest |z| of the face's corners. The depth
// kept is that of NDC, so z is too, and where NDC is `range` = 2 deep a difference of it is half as much of the window's.
inline double least_difference(Format format, double greatest, int digits, double range) {
  switch (format) {
    case Format::unorm16: return 0x1p-16;
    case Format::unorm24: return 0x1p-24;
    case Format::unorm32: return 0x1p-32;
    case Format::float32: digits = std::min(digits, 23); break;
    case Format::real: break;
  }
  const int least = digits == 23 ? -126 : -1022;
  const int e = greatest > 0 ? std::max(std::ilogb(greatest), least) : least;
  return std::ldexp(1.0, e - digits) / range;
}

// Depth along the sides of a triangle whose corners stand in order of y, then x.
template <std::floating_point R>
struct EdgeDepth {
  std::array<R, 3> x, y, z;

  static EdgeDepth make(const std::array<kernels::GridPoint, 3>& corner, const std::array<R, 3>& depth) {
    std::array<std::size_t, 3> by{0, 1, 2};
    std::sort(by.begin(), by.end(), [&](std::size_t i, std::size_t j) {
      return std::pair(corner[i].y, corner[i].x) < std::pair(corner[j].y, corner[j].x);
    });
    EdgeDepth e;
    for (std::size_t k = 0; k < 3; ++k) {
      e.x[k] = static_cast<R>(corner[by[k]].x) / R(kernels::corner_unit);
      e.y[k] = static_cast<R>(corner[by[k]].y) / R(kernels::corner_unit);
      e.z[k] = depth[by[k]];
    }
    return e;
  }

  // Within the corners' depths. A flat side gives the depth of one of its ends.
  R at(R px, R py) const {
    const auto along = [&](std::size_t i, std::size_t j) {
      const R t = y[j] != y[i] ? (py - y[i]) / (y[j] - y[i]) : R(0);
      return std::pair(x[i] + (x[j] - x[i]) * t, z[i] + (z[j] - z[i]) * t);
    };
    const auto [xa, za] = along(0, 2);
    const auto [xb, zb] = py < y[1] ? along(0, 1) : along(1, 2);
    const R depth = xb != xa ? za + (zb - za) * ((px - xa) / (xb - xa)) : za;
    const auto [least, greatest] = std::minmax({z[0], z[1], z[2]});
    return depth < least ? least : depth > greatest ? greatest : depth;
  }
};

template <std::floating_point R>
class DepthBuffer {
 public:
  //   claim  called with bytes of memory before they are taken; may throw
  DepthBuffer(const kernels::ScreenMesh<R>& mesh, const kernels::SamplePositions& pattern, PixelRect window,
              kernels::DepthRange depth, Format format, Interpolation interpolation,
              const std::function<void(std::uint64_t)>& claim)
      : scene_{mesh, pattern, nullptr,
               kernels::is_reversed(depth) ? kernels::DepthOrder::reversed : kernels::DepthOrder::standard},
        low_(kernels::least_depth(depth)),
        format_(format),
        interpolation_(interpolation),
        bins_(kernels::bin_triangles(mesh, pattern, window, claim)) {}

  const kernels::TriangleBins& bins() const { return bins_; }

  // From here on the faces f with faces[f] != 0, or all where that is empty, are moved. Biased depths stay within the
  // range of depths, in every format.
  void set_bias(const Bias& bias, std::vector<std::uint8_t> faces) {
    bias_ = bias, biased_ = std::move(faces);
  }

  // Fills `id` and `z` (the depth as it was kept) at every sample of `rect`, or no_face and the far depth. With
  // Format::real and Interpolation::plane the bytes of fill_triangles. A pure function of (x, y, sample).
  void fill(PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<R> z) const;

 private:
  struct Drawn {
    kernels::ScreenTriangle<R> triangle;
    EdgeDepth<R> edges;
    std::uint32_t face;
    double offset;  // of NDC depth
  };

  double offset_of(std::uint32_t face, const kernels::DepthPlane<R>& plane) const {
    if (!bias_.any() || (!biased_.empty() && biased_[face] == 0)) return 0;
    const double range = 1 - low_, greatest = std::max(std::fabs(plane.least), std::fabs(plane.greatest));
    const double m = std::max(std::fabs(plane.dx), std::fabs(plane.dy)) / range;
    return range *
           bias_.offset(m, least_difference(format_, greatest, std::numeric_limits<R>::digits - 1, range));
  }

  Drawn drawn(std::uint32_t face) const {
    std::array<kernels::GridPoint, 3> corner;
    std::array<R, 3> z;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& p = scene_.mesh.position[scene_.mesh.face[face][static_cast<glm::length_t>(k)]];
      corner[k] = *kernels::snap(p, scene_.mesh.corner_bits);  // binned faces have passed this
      z[k] = p.z;
    }
    const auto triangle = *kernels::screen_triangle(scene_.mesh, face, scene_.sign());
    return {triangle, EdgeDepth<R>::make(corner, z), face, offset_of(face, triangle.depth)};
  }

  // What the buffer would keep of a covered sample, less is nearer.
  R depth(const Drawn& t, int x, int y, std::int32_t ox, std::int32_t oy) const {
    const R found = interpolation_ == Interpolation::plane
                        ? scene_.sign() * t.triangle.depth.at(x, y, ox, oy)
                        : t.edges.at(static_cast<R>(x + ox * (1.0 / kernels::sample_unit)),
                                     static_cast<R>(y + oy * (1.0 / kernels::sample_unit)));
    double z = static_cast<double>(found);
    if (t.offset != 0) z = std::clamp(z + t.offset, low_, 1.0);
    return scene_.sign() * static_cast<R>(kept(format_, z, low_));
  }

  void draw(const Drawn& t, int sample, PixelRect box, PixelRect rect, PlaneView<std::uint32_t> id,
            PlaneView<R> z) const;

  kernels::FillScene<R> scene_;
  double low_;  // least depth
  Format format_;
  Interpolation interpolation_;
  kernels::TriangleBins bins_;
  Bias bias_;
  std::vector<std::uint8_t> biased_;
};

template <std::floating_point R>
void DepthBuffer<R>::draw(const Drawn& t, int sample, PixelRect box, PixelRect rect,
                          PlaneView<std::uint32_t> id, PlaneView<R> z) const {
  const kernels::SamplePositions& pattern = scene_.pattern;
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) {
      const std::size_t i = pattern.index(sample, x, y);
      const std::int32_t ox = pattern.x[i], oy = pattern.y[i];
      const auto& edge = t.triangle.edge;
      if (!std::all_of(edge.begin(), edge.end(), [&](const kernels::Edge& e) {
            return kernels::Edge::covers(e.at_pixel(x, y), e.at_offset(ox, oy));
          }))
        continue;
      const R found = depth(t, x, y, ox, oy);
      R& there = z.row(sample, y - rect.y0)[x - rect.x0];
      if (!(found < there)) continue;
      there = found;
      id.row(sample, y - rect.y0)[x - rect.x0] = t.face;
    }
}

template <std::floating_point R>
void DepthBuffer<R>::fill(PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<R> z) const {
  const int width = rect.x1 - rect.x0, height = rect.y1 - rect.y0;
  const auto each_row = [&](const auto& visit) {
    for (int s = 0; s < scene_.pattern.samples; ++s)
      for (int y = 0; y < height; ++y) visit(id.row(s, y), z.row(s, y));
  };
  each_row([&](std::uint32_t* ids, R* depths) {
    std::fill_n(ids, width, kernels::no_face);
    std::fill_n(depths, width, std::numeric_limits<R>::infinity());
  });
  kernels::each_bin_of(bins_, rect,
                       [&](PixelRect part, glm::ivec2 corner, std::span<const kernels::BinEntry> entries) {
                         for (const kernels::BinEntry& e : entries) {
                           const PixelRect box = kernels::box_in(part, corner, e);
                           if (box.empty()) continue;
                           const Drawn t = drawn(e.face);
                           for (int s = 0; s < scene_.pattern.samples; ++s) draw(t, s, box, rect, id, z);
                         }
                       });
  each_row([&](std::uint32_t* ids, R* depths) {
    for (int x = 0; x < width; ++x)
      depths[x] = ids[x] == kernels::no_face ? scene_.far() : scene_.sign() * depths[x];
  });
}

}  // namespace frustum::zbuffer
