// Vertices that are one, and what that leaves of the faces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "nodes/kernels/join_points.h"
#include "nodes/kernels/parallel.h"

namespace frustum::mesh {

// The rows of a column as bytes.
struct ByteRows {
  const std::byte* data;
  std::size_t row;  // bytes of one
  std::span<const std::byte> at(std::size_t i) const { return {data + i * row, row}; }
};

// same[i] is the least j at the same place (place[j] == place[i]) whose row has the same bytes in every one
// of `attributes`. Cost: one hash and some bytes a vertex.
inline std::vector<std::uint32_t> equal_vertices(std::span<const std::uint32_t> place,
                                                 const std::vector<ByteRows>& attributes) {
  if (attributes.empty()) return {place.begin(), place.end()};
  const auto hash = [&](std::uint32_t i) {
    std::uint64_t h = place[i];
    for (const ByteRows& a : attributes)
      for (std::size_t at = 0; at < a.row; at += 4) {  // rows are made of 4-byte and 8-byte numbers
        std::uint32_t word = 0;
        std::memcpy(&word, a.at(i).data() + at, 4);
        h = kernels::stirred(h + word);
      }
    return h;
  };
  std::vector<std::uint32_t> same(place.size());
  kernels::FirstSeen seen(place.size());
  for (std::uint32_t i = 0; i < same.size(); ++i)
    same[i] = seen.of(hash(i), i, [&](std::uint32_t j) {
      if (place[j] != place[i]) return false;
      for (const ByteRows& a : attributes)
        if (std::memcmp(a.at(i).data(), a.at(j).data(), a.row) != 0) return false;
      return true;
    });
  return same;
}

// The vertices that stay, ascending, and the new number of each: those with same[i] == i.
struct Kept {
  std::vector<std::uint32_t> vertices, number;
};
inline Kept kept_vertices(std::span<const std::uint32_t> same) {
  Kept k;
  k.number.resize(same.size());
  for (std::uint32_t i = 0; i < same.size(); ++i) {
    if (same[i] == i) {
      k.number[i] = static_cast<std::uint32_t>(k.vertices.size());
      k.vertices.push_back(i);
    } else {
      k.number[i] = k.number[same[i]];  // same[i] < i
    }
  }
  return k;
}

// Whether the face has three corners still.
inline bool has_three_corners(const glm::uvec3& t) { return t.x != t.y && t.y != t.z && t.z != t.x; }

}  // namespace frustum::mesh
