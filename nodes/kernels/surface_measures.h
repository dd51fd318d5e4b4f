#pragma once
// Box, area, centroid and volume of triangles: sums that keep their digits, and the same bits for any number
// of threads.

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "nodes/kernels/parallel.h"
#include "nodes/kernels/sum.h"
#include "nodes/kernels/vector.h"

namespace frustum::kernels {

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

  bool empty() const { return !(low.x <= high.x); }
  void add(const glm::dvec3& p) {
    for (glm::length_t k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  }
  void add(const Box& b) {
    for (glm::length_t k = 0; k < 3; ++k)
      low[k] = std::min(low[k], b.low[k]), high[k] = std::max(high[k], b.high[k]);
  }
  // Halves are added, for the sum of two large numbers may be out of range.
  glm::dvec3 centre() const { return low * 0.5 + high * 0.5; }
  glm::dvec3 half_size() const { return high * 0.5 - low * 0.5; }
};

template <std::floating_point R>
struct Triangles {
  std::span<const glm::vec<3, R>> position;
  std::span<const glm::uvec3> triangle;

  std::array<glm::dvec3, 3> corners(std::size_t f) const {
    const glm::uvec3& t = triangle[f];
    return {glm::dvec3(position[t.x]), glm::dvec3(position[t.y]), glm::dvec3(position[t.z])};
  }
  bool finite(std::size_t f) const {
    for (const glm::dvec3& p : corners(f))
      if (!std::isfinite(largest_component(p))) return false;
    return true;
  }
};

// The least box around the corners of all faces; vertices that no face uses and corners that are not finite
// do not count. Empty where nothing is left.
template <std::floating_point R>
Box bounds_of(const Triangles<R>& mesh) {
  const std::size_t n = mesh.triangle.size();
  std::vector<Box> boxes((n + usual_block - 1) / usual_block);
  parallel_blocks(n, usual_block, [&](std::size_t begin, std::size_t end) {
    Box& box = boxes[begin / usual_block];
    for (std::size_t f = begin; f < end; ++f)
      for (const glm::dvec3& p : mesh.corners(f))
        if (std::isfinite(largest_component(p))) box.add(p);
  });
  Box all;
  for (const Box& b : boxes) all.add(b);
  return all;
}

struct SurfaceMeasures {
  double area = 0;
  glm::dvec3 centroid{0};  // of the surface, weighted by area; the box's centre where there is no area
  double volume = 0;       // inside a closed surface whose fronts are outside; negative inside out
};

// Measures of the faces whose corners are finite. Coordinates are taken from the middle of the box and scaled
// by a power of two, so that neither distance from the origin nor size costs digits; sums are compensated
// within and over blocks. Error of area and volume: some 10 u of the sum of the faces' absolute terms.
template <std::floating_point R>
SurfaceMeasures measures_of(const Triangles<R>& mesh, const Box& box) {
  SurfaceMeasures m;
  if (box.empty()) return m;
  const glm::dvec3 centre = box.centre();
  m.centroid = centre;
  const double half = largest_component(box.half_size());
  if (!(half > 0)) return m;
  const double scale = power_of_two_towards_one(half);

  struct Sums {
    CompensatedSum<double> area, volume;
    std::array<CompensatedSum<double>, 3> moment;
  };
  const std::size_t n = mesh.triangle.size();
  std::vector<Sums> blocks((n + usual_block - 1) / usual_block);
  parallel_blocks(n, usual_block, [&](std::size_t begin, std::size_t end) {
    Sums& s = blocks[begin / usual_block];
    for (std::size_t f = begin; f < end; ++f) {
      if (!mesh.finite(f)) continue;
      auto [a, b, c] = mesh.corners(f);
      a = (a - centre) * scale, b = (b - centre) * scale, c = (c - centre) * scale;
      const double area = norm(cross(b - a, c - a)) / 2;
      s.area.add(area);
      s.volume.add(dot(a, cross(b, c)) / 6);
      const glm::dvec3 middle = (a + b + c) / 3.0;
      for (std::size_t k = 0; k < 3; ++k) s.moment[k].add(area * middle[static_cast<glm::length_t>(k)]);
    }
  });
  Sums all;
  for (const Sums& s : blocks) {
    all.area.add(s.area.value());
    all.volume.add(s.volume.value());
    for (std::size_t k = 0; k < 3; ++k) all.moment[k].add(s.moment[k].value());
  }
  const double area = all.area.value();
  if (area > 0)
    for (std::size_t k = 0; k < 3; ++k)
      m.centroid[static_cast<glm::length_t>(k)] += all.moment[k].value() / area / scale;
  m.area = area / scale / scale;
  m.volume = all.volume.value() / scale / scale / scale;
  return m;
}

}  // namespace frustum::kernels
