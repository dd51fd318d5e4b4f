#include "runtime/buffers/mesh_parts.h"

#include "nodes/kernels/parallel.h"

#include <fmt/format.h>

#include <cstring>

namespace frustum {
namespace {

const std::byte* bytes_at(const Column& c, std::size_t row) {
  return static_cast<const std::byte*>(c.data()) + row * row_bytes(c);
}
std::byte* bytes_at(Column& c, std::size_t row) {
  return static_cast<std::byte*>(c.data()) + row * row_bytes(c);
}

}  // namespace

std::shared_ptr<Column> column_like(const Column& c, std::size_t rows) {
  return std::make_shared<Column>(c.name(), c.domain(), c.kind(), c.width(), rows, c.space());
}

void require_countable(std::size_t vertices, std::size_t faces) {
  constexpr std::size_t limit = 0xFFFFFFFEu;
  if (vertices > limit || 3 * faces > limit)
    throw NodeError("too_large", fmt::format("{} vertices and {} faces are more than 32-bit numbers count",
                                             vertices, faces));
}

void copy_rows(const Column& from, Column& to, std::size_t first) {
  const std::size_t row = row_bytes(from);
  kernels::parallel_blocks(from.rows(), 1 << 18, [&](std::size_t begin, std::size_t end) {
    std::memcpy(bytes_at(to, first + begin), bytes_at(from, begin), (end - begin) * row);
  });
}

void copy_reversed_corners(const Column& from, Column& to, std::size_t first) {
  const std::size_t row = row_bytes(from);
  kernels::parallel_blocks(from.rows() / 3, kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (const auto& [a, b] : {std::pair{0, 0}, std::pair{1, 2}, std::pair{2, 1}})
        std::memcpy(bytes_at(to, first + 3 * f + static_cast<std::size_t>(a)),
                    bytes_at(from, 3 * f + static_cast<std::size_t>(b)), row);
  });
}

Ref<Column> on_corners(const Column& c, std::span<const glm::uvec3> triangles) {
  auto out = std::make_shared<Column>(c.name(), Domain::corner, c.kind(), c.width(), 3 * triangles.size(),
                                      c.space());
  const std::size_t row = row_bytes(c);
  kernels::parallel_blocks(triangles.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (glm::length_t k = 0; k < 3; ++k)
        std::memcpy(bytes_at(*out, 3 * f + static_cast<std::size_t>(k)), bytes_at(c, triangles[f][k]), row);
  });
  return out;
}

}  // namespace frustum
