#include "runtime/io/mesh_writers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

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
  void add(const Column& c) {
    columns_.push_back(&c);
    sizes_.push_back(static_cast<std::size_t>(c.width()) * bytes_of(c.kind()));
    for (const std::string& name : property_names(c))
      properties += fmt::format("property {} {}\n", type_of(c.kind()), name);
  }
  char* put(std::size_t row, char* to) const {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      std::memcpy(to, static_cast<const char*>(columns_[i]->data()) + sizes_[i] * row, sizes_[i]);
      to += sizes_[i];
    }
    return to;
  }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const std::size_t n : sizes_) sum += n;
    return sum;
  }

  std::string properties;

 private:
  std::vector<const Column*> columns_;
  std::vector<std::size_t> sizes_;
};

// Calls row(i, to) for every row; it returns where the next begins.
template <class Row>
void write_rows(std::size_t rows, std::size_t row_bytes, PartialFile& to, Row&& row) {
  constexpr std::size_t block = 1 << 14;
  std::vector<char> bytes(row_bytes * std::min(block, rows));
  for (std::size_t first = 0; first < rows; first += block) {
    char* at = bytes.data();
    for (std::size_t i = first; i < std::min(first + block, rows); ++i) at = row(i, at);
    to.write(bytes.data(), static_cast<std::size_t>(at - bytes.data()));
    to.check();
  }
}

}  // namespace

void write_ply(const Mesh& original, const SaveRequest& request, PartialFile& to) {
  const Mesh mesh = split_corners(original);
  Rows vertices, faces;
  for (const Ref<Column>& c : mesh.columns) {
    if (c->domain() == Domain::vertex)
      vertices.add(*c);
    else if (c->domain() == Domain::face && c->name() != "triangle")
      faces.add(*c);
    else if (c->domain() == Domain::mesh)
      warn_left_out(request, "PLY", fmt::format("column '{}' of the mesh", c->name()));
  }
  std::string head = "ply\nformat binary_little_endian 1.0\n";
  for (const auto& [key, value] : request.metadata) {
    std::string line = fmt::format("{} {}", key, value);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c < ' '; }, ' ');
    head += fmt::format("comment {}\n", line);
  }
  to.add(head +
         fmt::format(
             "element vertex {}\n{}element face {}\nproperty list uchar uint vertex_indices\n{}end_header\n",
             mesh.vertices(), vertices.properties, mesh.faces(), faces.properties));
  write_rows(mesh.vertices(), vertices.bytes(), to,
             [&](std::size_t i, char* at) { return vertices.put(i, at); });
  const auto triangles = mesh.triangles();
  write_rows(mesh.faces(), 13 + faces.bytes(), to, [&](std::size_t i, char* at) {
    *at = 3;
    std::memcpy(at + 1, &triangles[i], 12);
    return faces.put(i, at + 13);
  });
}

}  // namespace frustum
