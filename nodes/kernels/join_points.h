#pragma once
// Which points are the same place: by their numbers, or within a tolerance. Linear in the number of points.

#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "nodes/kernels/vector.h"

namespace frustum::kernels {

// Stirs all bits of x into all bits of the result. Source: Steele, Lea & Flood 2014, "Fast splittable
// pseudorandom number generators", the finaliser of SplitMix64 (Stafford's variant 13).
constexpr std::uint64_t stirred(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

// A hash table of the first of every kind among things that have numbers; open addressing, half full at most.
class FirstSeen {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  // Room for `count` things.
  explicit FirstSeen(std::size_t count) : slots_(std::bit_ceil(2 * count + 2), none) {}

  // The thing that was seen first among those equal to `i`: itself, if it is new. equal(j) says whether a
  // thing seen before is equal; equal things have equal hashes.
  template <class Equal>
  std::uint32_t of(std::uint64_t hash, std::uint32_t i, const Equal& equal) {
    std::uint32_t& slot = slots_[find(hash, equal)];
    if (slot == none) slot = i;
    return slot;
  }
  // The same without adding anything: none where there is no equal one.
  template <class Equal>
  std::uint32_t look_up(std::uint64_t hash, const Equal& equal) const {
    return slots_[find(hash, equal)];
  }

 private:
  template <class Equal>
  std::size_t find(std::uint64_t hash, const Equal& equal) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = stirred(hash) & mask;
    while (slots_[at] != none && !equal(slots_[at])) at = (at + 1) & mask;
    return at;
  }
  std::vector<std::uint32_t> slots_;
};

template <std::floating_point R>
bool is_finite(const glm::vec<3, R>& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

inline std::uint64_t hash_of(const glm::dvec3& p) {
  // x + 0 turns -0 into 0, which is equal to it.
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); };
  return bits(p.x) + 3 * stirred(bits(p.y) + 5 * stirred(bits(p.z)));
}

// first[i] is the least j whose point equals point i; a point that is not finite equals only itself.
template <std::floating_point R>
std::vector<std::uint32_t> equal_points(std::span<const glm::vec<3, R>> points) {
  std::vector<std::uint32_t> first(points.size());
  FirstSeen seen(points.size());
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    const auto& p = points[i];
    const auto same = [&](std::uint32_t j) { return points[j] == p; };
    first[i] = is_finite(p) ? seen.of(hash_of(glm::dvec3(p)), i, same) : i;
  }
  return first;
}

// Points in their order: each joins the earliest representative within `tolerance` (Euclidean), and is one
// itself where there is none. So representatives are more than the tolerance apart, no point is moved further
// than that, and a chain of close points never collapses into one. first[i] is the representative's number.
//
// Space is cut into cubes a little more than twice the tolerance wide: what is close to a point lies in its
// cube or in the 7 on its side of the middle, and a cube holds some 30 representatives at most, however the
// points lie. Points whose cube has no number (not finite, or 2^1023 times the tolerance away) are
// matched exactly.
template <std::floating_point R>
class PointJoiner {
 public:
  PointJoiner(std::span<const glm::vec<3, R>> points, double tolerance)
      : points_(points),
        tolerance_(tolerance),
        width_(tolerance * (2 + 0x1p-10)),  // wide enough for what rounding does to the quotient
        first_(points.size()),
        next_(points.size(), FirstSeen::none),
        cubes_(points.size()) {}

  std::vector<std::uint32_t> joined() && {
    for (std::uint32_t i = 0; i < first_.size(); ++i) {
      first_[i] = representative(i);
      if (first_[i] == i) add(i);
    }
    return std::move(first_);
  }

 private:
  glm::dvec3 cube(std::uint32_t i) const {
    const glm::dvec3 q = glm::dvec3(points_[i]) / width_;
    return {std::floor(q.x), std::floor(q.y), std::floor(q.z)};
  }

  bool close(std::uint32_t i, std::uint32_t j) const {
    if (points_[i] == points_[j]) return true;
    const glm::dvec3 d = (glm::dvec3(points_[i]) - glm::dvec3(points_[j])) / tolerance_;
    return dot(d, d) <= 1;
  }

  std::uint32_t representative(std::uint32_t i) const {
    const glm::dvec3 q = glm::dvec3(points_[i]) / width_, own = cube(i);
    std::uint32_t least = i;
    for (unsigned side = 0; side < 8; ++side) {
      glm::dvec3 at = own;
      for (glm::length_t k = 0; k < 3; ++k)
        if ((side >> k & 1U) != 0) at[k] += q[k] - own[k] < 0.5 ? -1 : 1;
      std::uint32_t j = cubes_.look_up(hash_of(at), [&](std::uint32_t r) { return cube(r) == at; });
      for (; j != FirstSeen::none; j = next_[j])
        if (j < least && close(i, j)) least = j;
    }
    return least;
  }

  void add(std::uint32_t i) {
    const glm::dvec3 own = cube(i);
    if (!is_finite(own)) return;
    const std::uint32_t head = cubes_.of(hash_of(own), i, [&](std::uint32_t r) { return cube(r) == own; });
    if (head == i) return;
    next_[i] = next_[head];
    next_[head] = i;
  }

  std::span<const glm::vec<3, R>> points_;
  double tolerance_, width_;
  std::vector<std::uint32_t> first_, next_;  // next_: representatives of one cube, after its first
  FirstSeen cubes_;                          // the first representative of every cube
};

// equal_points for a tolerance of 0. Requires tolerance >= 0.
template <std::floating_point R>
std::vector<std::uint32_t> joined_points(std::span<const glm::vec<3, R>> points, double tolerance) {
  if (tolerance == 0) return equal_points(points);
  return PointJoiner<R>(points, tolerance).joined();
}

}  // namespace frustum::kernels
