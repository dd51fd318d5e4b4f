#include "runtime/io/vertex_split.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

namespace frustum {
namespace {

constexpr std::size_t block = std::size_t{1} << 14;  // rows between two polls

std::size_t row_bytes(const Column& c) { return static_cast<std::size_t>(c.width()) * bytes_of(c.kind()); }

// Calls body(first, last) for blocks of 0 .. count - 1, one after another.
template <class Body>
void in_blocks(std::size_t count, const Context& ctx, Body&& body) {
  for (std::size_t first = 0; first < count; first += block) {
    ctx.poll();
    body(first, std::min(first + block, count));
  }
}

// Of two corners: by the bytes of their values.
int order_of(std::span<const Ref<Column>> columns, std::uint32_t a, std::uint32_t b) {
  for (const Ref<Column>& c : columns) {
    const auto* data = static_cast<const char*>(c->data());
    const std::size_t n = row_bytes(*c);
    if (const int d = std::memcmp(data + n * a, data + n * b, n); d != 0) return d;
  }
  return 0;
}

// Corners by their vertex, those of one vertex in their order.
struct CornersOfVertices {
  CornersOfVertices(std::span<const std::uint32_t> vertex, std::size_t vertices, const Context& ctx)
      : end(vertices, 0), corners(vertex.size()) {
    in_blocks(vertex.size(), ctx, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) ++end[vertex[i]];
    });
    std::uint32_t sum = 0;
    for (std::uint32_t& e : end) sum += std::exchange(e, sum);
    in_blocks(vertex.size(), ctx, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) corners[end[vertex[i]]++] = static_cast<std::uint32_t>(i);
    });
  }
  std::span<std::uint32_t> of(std::size_t v) {
    const std::size_t begin = v == 0 ? 0 : end[v - 1];
    return {corners.data() + begin, end[v] - begin};
  }
  std::vector<std::uint32_t> end, corners;
};

// same[i]: the first corner of the vertex of corner i that has the values of i.
void find_first_of_same(std::span<const std::uint32_t> vertex, std::size_t vertices,
                        std::span<const Ref<Column>> columns, const Context& ctx,
                        std::span<std::uint32_t> same) {
  CornersOfVertices by_vertex(vertex, vertices, ctx);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertices, block), [&](const auto& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      if (v % 4096 == 0) ctx.poll();
      const std::span<std::uint32_t> corners = by_vertex.of(v);
      std::sort(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) {
        const int d = order_of(columns, a, b);
        return d != 0 ? d < 0 : a < b;
      });
      for (std::size_t i = 0; i < corners.size(); ++i)
        same[corners[i]] =
            i > 0 && order_of(columns, corners[i - 1], corners[i]) == 0 ? same[corners[i - 1]] : corners[i];
    }
  });
}

// The rows listed, in that order, as a column of vertices.
Ref<Column> gather(const Column& from, std::span<const std::uint32_t> rows, Context& ctx) {
  const std::size_t n = row_bytes(from);
  ctx.claim(n * rows.size());
  auto out = std::make_shared<Column>(from.name(), Domain::vertex, from.kind(), from.width(), rows.size(),
                                      from.space());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows.size(), block), [&](const auto& range) {
    ctx.poll();
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      std::memcpy(static_cast<char*>(out->data()) + n * i,
                  static_cast<const char*>(from.data()) + n * rows[i], n);
  });
  return out;
}

bool is_real(const Column& c) { return c.kind() == NumberKind::f32 || c.kind() == NumberKind::f64; }

}  // namespace

VertexSplit split_vertices(const Mesh& mesh, std::span<const Ref<Column>> corner_columns, Context& ctx) {
  const auto triangles = mesh.triangles();
  const std::size_t corners = 3 * triangles.size();
  static_assert(sizeof(glm::uvec3) == 3 * sizeof(std::uint32_t));
  const std::span vertex(reinterpret_cast<const std::uint32_t*>(triangles.data()), corners);
  ctx.claim(sizeof(std::uint32_t) * (2 * corners + mesh.vertices()));
  auto column = Column::make<glm::uvec3>("triangle", Domain::face, triangles.size());
  const std::span to(static_cast<std::uint32_t*>(column->data()), corners);
  find_first_of_same(vertex, mesh.vertices(), corner_columns, ctx, to);
  std::size_t count = 0;
  for (std::size_t i = 0; i < corners; ++i) count += to[i] == i ? 1 : 0;
  ctx.claim(2 * sizeof(std::uint32_t) * count);
  VertexSplit out;
  out.vertices.reserve(count), out.corners.reserve(count);
  in_blocks(corners, ctx, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      if (to[i] == i) {
        to[i] = static_cast<std::uint32_t>(out.vertices.size());
        out.vertices.push_back(vertex[i]), out.corners.push_back(static_cast<std::uint32_t>(i));
      } else {
        to[i] = to[to[i]];  // stands before this corner, and is a vertex by now
      }
    }
  });
  out.triangles = std::move(column);
  return out;
}

Mesh split_corners(const Mesh& mesh, Context& ctx) {
  const auto is_split = [](const Ref<Column>& c) { return c->domain() == Domain::corner && is_real(*c); };
  std::vector<Ref<Column>> corner_columns;
  std::copy_if(mesh.columns.begin(), mesh.columns.end(), std::back_inserter(corner_columns), is_split);
  if (corner_columns.empty()) return mesh;
  const VertexSplit split = split_vertices(mesh, corner_columns, ctx);
  Mesh out = mesh;
  for (Ref<Column>& c : out.columns) {
    if (c->name() == "triangle")
      c = split.triangles;
    else if (c->domain() == Domain::vertex)
      c = gather(*c, split.vertices, ctx);
    else if (is_split(c))
      c = gather(*c, split.corners, ctx);
  }
  return out;
}

}  // namespace frustum
