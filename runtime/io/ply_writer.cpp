#include "runtime/io/mesh_writers.h"
#include "runtime/io/vertex_split.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <iterator>
#include <optional>

namespace frustum {
namespace {

static_assert(std::endian::native == std::endian::little,
              "PLY files are written in this processor's byte order");

// The properties of a column: those that read_ply takes it back from, else its name and component.
std::vector<std::string> property_names(const Column& c) {
  if (c.name() == "position") return {"x", "y", "z"};
  if (c.name() == "normal") return {"nx", "ny", "nz"};
  if (c.name() == "uv") return {"s", "t"};
  if (c.name() == "color" && c.width() == 3) return {"red", "green", "blue"};
  if (c.name() == "color") return {"red", "green", "blue", "alpha"};
  std::string name = c.name();
  std::replace_if(
      name.begin(), name.end(), [](char ch) { return ch <= ' ' || ch > '~'; }, '_');
  if (c.width() == 1) return {name};
  std::vector<std::string> out;
  for (int k = 0; k < c.width(); ++k) out.push_back(fmt::format("{}_{}", name, "xyzw"[k]));
  return out;
}

std::string_view type_of(NumberKind k) {
  constexpr std::array<std::string_view, 4> types{"float", "double", "int", "uint"};
  return types[static_cast<std::size_t>(k)];
}

// Columns side by side, a row after another.
class Rows {
 public:
  //   order  which rows of the column, one after another; null: all as they stand
  void add(const Column& c, const std::vector<std::uint32_t>* order = nullptr) {
    columns_.push_back({static_cast<const char*>(c.data()),
                        static_cast<std::size_t>(c.width()) * bytes_of(c.kind()), order});
    for (const std::string& name : property_names(c))
      properties += fmt::format("property {} {}\n", type_of(c.kind()), name);
  }
  char* put(std::size_t row, char* to) const {
    for (const Part& c : columns_) {
      std::memcpy(to, c.data + c.bytes * (c.order != nullptr ? (*c.order)[row] : row), c.bytes);
      to += c.bytes;
    }
    return to;
  }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const Part& c : columns_) sum += c.bytes;
    return sum;
  }

  std::string properties;

 private:
  struct Part {
    const char* data;
    std::size_t bytes;  // of a row
    const std::vector<std::uint32_t>* order;
  };
  std::vector<Part> columns_;
};

// Calls row(i, to) for every row; it returns where the next begins.
template <class Row>
void write_rows(std::size_t rows, std::size_t row_bytes, PartialFile& to, const Context& ctx, Row&& row) {
  constexpr std::size_t block = 1 << 14;
  std::vector<char> bytes(row_bytes * std::min(block, rows));
  for (std::size_t first = 0; first < rows; first += block) {
    char* at = bytes.data();
    for (std::size_t i = first; i < std::min(first + block, rows); ++i) at = row(i, at);
    to.write(bytes.data(), static_cast<std::size_t>(at - bytes.data()));
    to.check();
    ctx.poll();
  }
}

// Every column of corners is of vertices in the file.
std::optional<VertexSplit> split_of(const Mesh& mesh, Context& ctx) {
  std::vector<Ref<Column>> of_corners;
  std::copy_if(mesh.columns.begin(), mesh.columns.end(), std::back_inserter(of_corners),
               [](const Ref<Column>& c) { return c->domain() == Domain::corner; });
  if (of_corners.empty()) return {};
  return split_vertices(mesh, of_corners, ctx);
}

std::string comments(const SaveRequest& request) {
  std::string out;
  for (const auto& [key, value] : request.metadata) {
    std::string line = fmt::format("{} {}", key, value);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c < ' '; }, ' ');
    out += fmt::format("comment {}\n", line);
  }
  return out;
}

}  // namespace

void write_ply(const Mesh& mesh, const SaveRequest& request, PartialFile& to, Context& ctx) {
  const auto split = split_of(mesh, ctx);
  Rows vertices, faces;
  for (const Ref<Column>& c : mesh.columns) {
    if (c->domain() == Domain::vertex)
      vertices.add(*c, split ? &split->vertices : nullptr);
    else if (c->domain() == Domain::corner)
      vertices.add(*c, &split->corners);
    else if (c->domain() == Domain::face && c->name() != "triangle")
      faces.add(*c);
    else if (c->domain() == Domain::mesh)
      warn_left_out(request, "PLY", fmt::format("column '{}' of the mesh", c->name()));
  }
  const std::size_t count = split ? split->vertices.size() : mesh.vertices();
  to.add("ply\nformat binary_little_endian 1.0\n" + comments(request) +
         fmt::format(
             "element vertex {}\n{}element face {}\nproperty list uchar uint vertex_indices\n{}end_header\n",
             count, vertices.properties, mesh.faces(), faces.properties));
  write_rows(count, vertices.bytes(), to, ctx, [&](std::size_t i, char* at) { return vertices.put(i, at); });
  const auto triangles = split ? split->triangles->values<glm::uvec3>() : mesh.triangles();
  write_rows(mesh.faces(), 13 + faces.bytes(), to, ctx, [&](std::size_t i, char* at) {
    *at = 3;
    std::memcpy(at + 1, &triangles[i], 12);
    return faces.put(i, at + 13);
  });
}

}  // namespace frustum
