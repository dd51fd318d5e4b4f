// Small pictures made by the real stages (clip, divide, viewport, bins, fill), and what they should show.
#pragma once

#include "nodes/kernels/interpolate_attributes.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frustum::hard {

using ClipTriangle = std::array<glm::vec4, 3>;

// What the rasterizer makes of triangles that are on the screen already: (x_px, y_px, depth, 1/w) a vertex.
struct Picture {
  int width, height;
  std::vector<std::uint32_t> id;
  std::vector<float> z;
  std::uint32_t at(int x, int y) const { return id[static_cast<std::size_t>(y * width + x)]; }
  float depth(int x, int y) const { return z[static_cast<std::size_t>(y * width + x)]; }
};

struct ScreenTriangles {
  std::vector<glm::vec4> position;
  std::vector<glm::uvec3> face;
  std::vector<std::uint32_t> origin;

  void add(const glm::vec4& a, const glm::vec4& b, const glm::vec4& c, std::uint32_t source);
  kernels::ScreenMesh<float> mesh() const { return {position, face, origin}; }
};

// By bins and simd::fill_triangles, one sample in the middle of each pixel (or `pattern`'s first sample).
Picture filled(const kernels::ScreenMesh<float>& mesh, int width, int height,
               const kernels::SamplePositions& pattern = kernels::centre_sample(), int x0 = 0, int y0 = 0);

// One number a vertex, interpolated over the faces seen, at the middle of each pixel; 0 where there is none.
// By simd::interpolate_attributes.
std::vector<float> interpolated(const kernels::ScreenMesh<float>& mesh, const Picture& picture,
                                const std::vector<float>& values, int x0 = 0, int y0 = 0);

// The kernels of clip.homogeneous and project.viewport, then `filled`; ids are indices of `triangles`.
Picture drawn(std::span<const ClipTriangle> triangles, int width, int height, double guard_band = 1);

// The textbook's order: divide by w, map to pixels, rasterize whatever comes out.
Picture drawn_without_clipping(std::span<const ClipTriangle> triangles, int width, int height);

// Whether the ray through each pixel's middle meets the triangle inside the view volume: 1 or 0, or -1 where
// moving it by 2^-6 px decides, which snapping corners to 2^-8 px may. By determinants in 113 bits: those of
// float coordinates are exact.
std::vector<int> seen(const ClipTriangle& triangle, int width, int height);

// Pixels where the picture of one triangle and the rays disagree.
std::size_t wrong_pixels(const Picture& picture, const std::vector<int>& seen);

}  // namespace frustum::hard
