#pragma once
// For every vertex the corners of faces that meet there.

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace frustum::kernels {

// Corner 3 f + c is corner c of face f. Corners of a vertex come in ascending order. Cost: two passes over
// the faces, 4 bytes a corner and a vertex.
class VertexCorners {
 public:
  // `place` gives every vertex the number of the vertex it stands for. Requires indices within it.
  VertexCorners(std::span<const glm::uvec3> triangle, std::span<const std::uint32_t> place)
      : triangle_(triangle), place_(place), first_(place.size() + 1, 0), corners_(3 * triangle.size()) {
    for (std::size_t k = 0; k < corners_.size(); ++k) ++first_[vertex(k) + 1];
    for (std::size_t v = 0; v < place.size(); ++v) first_[v + 1] += first_[v];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t k = 0; k < corners_.size(); ++k)
      corners_[next[vertex(k)]++] = static_cast<std::uint32_t>(k);
  }

  std::size_t vertices() const { return place_.size(); }
  std::span<const std::uint32_t> of(std::size_t v) const {
    return {corners_.data() + first_[v], first_[v + 1] - first_[v]};
  }
  // The vertex at corner k, at the corner after it in its face, and at the one before.
  std::uint32_t vertex(std::size_t k) const { return at(k / 3, k % 3); }
  std::uint32_t next(std::size_t k) const { return at(k / 3, (k + 1) % 3); }
  std::uint32_t previous(std::size_t k) const { return at(k / 3, (k + 2) % 3); }

 private:
  std::uint32_t at(std::size_t f, std::size_t c) const {
    return place_[triangle_[f][static_cast<glm::length_t>(c)]];
  }
  std::span<const glm::uvec3> triangle_;
  std::span<const std::uint32_t> place_;
  std::vector<std::uint32_t> first_, corners_;
};

// Sets that grow together. Source: Tarjan & van Leeuwen 1984, path halving; the least element stands for all.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n = 0) { reset(n); }
  void reset(std::size_t n) {
    parent_.resize(n);
    for (std::size_t i = 0; i < n; ++i) parent_[i] = static_cast<std::uint32_t>(i);
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace frustum::kernels
