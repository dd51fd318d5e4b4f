#include "runtime/buffers/mesh_faces.h"

#include "nodes/kernels/parallel.h"

#include <cstring>

namespace frustum {
namespace {

template <std::size_t bytes>
void gather_bytes(const std::byte* from, std::byte* to, std::span<const std::uint32_t> rows) {
  kernels::parallel_blocks(rows.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      std::memcpy(to + i * bytes, from + std::size_t{rows[i]} * bytes, bytes);
  });
}

void gather_bytes(const std::byte* from, std::byte* to, std::span<const std::uint32_t> rows,
                  std::size_t bytes) {
  switch (bytes) {
    case 4: return gather_bytes<4>(from, to, rows);
    case 8: return gather_bytes<8>(from, to, rows);
    case 12: return gather_bytes<12>(from, to, rows);
    case 16: return gather_bytes<16>(from, to, rows);
    default: break;
  }
  kernels::parallel_blocks(rows.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      std::memcpy(to + i * bytes, from + std::size_t{rows[i]} * bytes, bytes);
  });
}

// `run` rows at a time.
Ref<Column> gather(const Column& column, std::span<const std::uint32_t> runs, std::size_t run) {
  auto out = std::make_shared<Column>(column.name(), column.domain(), column.kind(), column.width(),
                                      runs.size() * run, column.space());
  gather_bytes(static_cast<const std::byte*>(column.data()), static_cast<std::byte*>(out->data()), runs,
               run * static_cast<std::size_t>(column.width()) * bytes_of(column.kind()));
  return out;
}

bool is_everything(std::span<const std::uint32_t> faces, std::size_t count) {
  if (faces.size() != count) return false;
  for (std::size_t i = 0; i < count; ++i)
    if (faces[i] != i) return false;
  return true;
}

}  // namespace

Ref<Column> gather_faces(const Column& column, std::span<const std::uint32_t> faces) {
  return gather(column, faces, column.domain() == Domain::corner ? 3 : 1);
}

Ref<Column> gather_rows(const Column& column, std::span<const std::uint32_t> rows) {
  return gather(column, rows, 1);
}

Ref<Column> origin_of(const Mesh& mesh) {
  if (auto origin = mesh.share("origin")) return origin;
  auto own = Column::make<std::uint32_t>("origin", Domain::face, mesh.faces());
  const auto values = own->values<std::uint32_t>();
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::uint32_t>(i);
  return own;
}

Mesh select_faces(const Mesh& mesh, std::span<const std::uint32_t> faces) {
  if (is_everything(faces, mesh.faces())) return mesh;
  Mesh out = mesh;
  out.columns.clear();
  for (const auto& column : mesh.columns) {
    const bool moves = column->domain() == Domain::face || column->domain() == Domain::corner;
    out.columns.push_back(moves ? gather_faces(*column, faces) : column);
  }
  if (mesh.find("origin") == nullptr) {
    auto origin = Column::make<std::uint32_t>("origin", Domain::face, faces);
    out.columns.push_back(std::move(origin));
  }
  if (mesh.closed == true) out.closed = false;
  return out;
}

std::uint64_t bytes_of_faces(const Mesh& mesh, std::size_t faces) {
  if (faces == mesh.faces()) return 0;
  std::uint64_t a_face = mesh.find("origin") == nullptr ? sizeof(std::uint32_t) : 0;
  for (const auto& c : mesh.columns) {
    const std::uint64_t row = static_cast<std::uint64_t>(c->width()) * bytes_of(c->kind());
    if (c->domain() == Domain::face) a_face += row;
    if (c->domain() == Domain::corner) a_face += 3 * row;
  }
  return a_face * faces;
}

}  // namespace frustum
