#include "runtime/io/vertex_split.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <cstring>
#include <numeric>

namespace frustum {
namespace {

std::size_t row_bytes(const Column& c) { return static_cast<std::size_t>(c.width()) * bytes_of(c.kind()); }

}  // namespace

VertexSplit split_vertices(std::span<const glm::uvec3> triangles,
                           std::span<const Ref<Column>> corner_columns) {
  const std::size_t corners = 3 * triangles.size();
  const auto vertex = [&](std::uint32_t corner) {
    return triangles[corner / 3][static_cast<glm::length_t>(corner % 3)];
  };
  // Of two corners: by vertex, then by the bytes of their values.
  const auto order = [&](std::uint32_t a, std::uint32_t b) {
    if (vertex(a) != vertex(b)) return vertex(a) < vertex(b) ? -1 : 1;
    for (const Ref<Column>& c : corner_columns) {
      const auto* data = static_cast<const char*>(c->data());
      const std::size_t n = row_bytes(*c);
      if (const int d = std::memcmp(data + n * a, data + n * b, n); d != 0) return d;
    }
    return 0;
  };
  std::vector<std::uint32_t> sorted(corners);
  std::iota(sorted.begin(), sorted.end(), 0u);
  tbb::parallel_sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    const int d = order(a, b);
    return d != 0 ? d < 0 : a < b;
  });
  std::vector<std::uint32_t> first(corners);
  for (std::size_t i = 0; i < corners; ++i)
    first[sorted[i]] = i > 0 && order(sorted[i - 1], sorted[i]) == 0 ? first[sorted[i - 1]] : sorted[i];
  VertexSplit out;
  auto column = Column::make<glm::uvec3>("triangle", Domain::face, triangles.size());
  const auto to = column->values<glm::uvec3>();
  for (std::uint32_t i = 0; i < corners; ++i) {
    if (first[i] == i) {
      first[i] = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.push_back(vertex(i)), out.corners.push_back(i);
    } else {
      first[i] = first[first[i]];  // stands before this corner, and is a vertex by now
    }
    to[i / 3][static_cast<glm::length_t>(i % 3)] = first[i];
  }
  out.triangles = std::move(column);
  return out;
}

Ref<Column> gather_rows(const Column& from, std::span<const std::uint32_t> rows, Domain domain) {
  auto out =
      std::make_shared<Column>(from.name(), domain, from.kind(), from.width(), rows.size(), from.space());
  const std::size_t n = row_bytes(from);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows.size(), 1 << 14), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      std::memcpy(static_cast<char*>(out->data()) + n * i,
                  static_cast<const char*>(from.data()) + n * rows[i], n);
  });
  return out;
}

}  // namespace frustum
