#include "nodes/kernels/transfer.h"
#include "runtime/io/mesh_writers.h"
#include "runtime/io/vertex_split.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>

namespace frustum {
namespace {

// Lines go to the file in blocks.
class Lines {
 public:
  Lines(PartialFile& to, const Context& ctx) : to_(to), ctx_(ctx) {}
  template <class... T>
  void add(fmt::format_string<T...> format, T&&... values) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<T>(values)...);
    if (text_.size() > (1 << 20)) flush();
  }
  void flush() {
    to_.add({text_.data(), text_.size()});
    to_.check();
    ctx_.poll();
    text_.clear();
  }

 private:
  PartialFile& to_;
  const Context& ctx_;
  fmt::memory_buffer text_;
};

// One row of reals, each in the shortest decimal of its own kind.
void add_numbers(Lines& lines, const Column& c, std::size_t row) {
  const std::size_t first = row * static_cast<std::size_t>(c.width());
  for (std::size_t k = 0; k < static_cast<std::size_t>(c.width()); ++k) {
    if (c.kind() == NumberKind::f32)
      lines.add(" {}", as_text(static_cast<const float*>(c.data())[first + k]));
    else
      lines.add(" {}", as_text(static_cast<const double*>(c.data())[first + k]));
  }
}

// The lines of a column, and which of them a corner points at. Readers join corners by these numbers, so corners of
// one vertex whose values are equal by bits share a line: a line each would take every triangle apart.
class Lookup {
 public:
  Lookup(const Mesh& mesh, std::string_view column, Context& ctx) : column_(mesh.share(column)) {
    if (column_ != nullptr && column_->domain() == Domain::corner)
      split_ = split_vertices(mesh, std::span(&column_, 1), ctx);
  }
  explicit operator bool() const { return column_ != nullptr; }
  void add_lines(Lines& lines, std::string_view key) const {
    const std::size_t count = split_ ? split_->corners.size() : column_ != nullptr ? column_->rows() : 0;
    for (std::size_t i = 0; i < count; ++i) {
      lines.add("{}", key);
      add_numbers(lines, *column_, split_ ? split_->corners[i] : i);
      lines.add("\n");
    }
  }
  // Counted from 1, of corner k of face f, which is at a vertex.
  std::size_t line(std::size_t f, glm::length_t k, std::size_t vertex) const {
    return 1 + (split_ ? split_->triangles->values<glm::uvec3>()[f][k] : vertex);
  }

 private:
  Ref<Column> column_;
  std::optional<VertexSplit> split_;
};

void add_positions(Lines& lines, const Mesh& mesh, const Column* color) {
  const Column& position = mesh.at("position");
  for (std::size_t i = 0; i < position.rows(); ++i) {
    lines.add("v");
    add_numbers(lines, position, i);
    for (int k = 0; color != nullptr && k < 3; ++k)
      lines.add(" {}",
                as_text(static_cast<float>(kernels::encode(kernels::Curve::srgb, color->number(i, k)))));
    lines.add("\n");
  }
}

// A name that stands on one line, as usemtl reads it.
std::string line_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c >= 0 && c < ' '; }, '_');
  while (!name.empty() && name.back() == '\\') name.back() = '_';
  return name.empty() ? "unnamed" : name;
}

void add_faces(Lines& lines, const Mesh& mesh, const Lookup& uv, const Lookup& normal,
               const Column* material) {
  const auto triangles = mesh.triangles();
  std::optional<std::uint32_t> now;
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (material != nullptr) {
      const std::uint32_t m = material->values<std::uint32_t>()[f];
      if (now != m) lines.add("usemtl {}\n", line_name(mesh.materials->materials[m].name));
      now = m;
    }
    lines.add("f");
    for (glm::length_t k = 0; k < 3; ++k) {
      const std::size_t v = triangles[f][k];
      lines.add(" {}", v + 1);
      if (uv) lines.add("/{}", uv.line(f, k, v));
      if (normal) lines.add("{}{}", uv ? "/" : "//", normal.line(f, k, v));
    }
    lines.add("\n");
  }
}

}  // namespace

void write_obj(const Mesh& mesh, const SaveRequest& request, PartialFile& to, Context& ctx) {
  const Column *color = mesh.find("color"), *material = mesh.materials ? mesh.find("material") : nullptr;
  if (color != nullptr && color->domain() != Domain::vertex) {
    warn_left_out(request, "OBJ", "colours of corners");
    color = nullptr;
  }
  const std::set<std::string_view> kept{"triangle", "position", "uv", "normal", "color", "material"};
  for (const Ref<Column>& c : mesh.columns)
    if (!kept.contains(c->name())) warn_left_out(request, "OBJ", fmt::format("column '{}'", c->name()));
  if (color != nullptr && color->width() == 4) warn_left_out(request, "OBJ", "the opacity of column 'color'");
  if (material != nullptr) warn_left_out(request, "OBJ", "what its materials are, only for their names");

  Lines lines(to, ctx);
  for (const auto& [key, value] : request.metadata) lines.add("# {} {}\n", key, line_name(value));
  add_positions(lines, mesh, color);
  const Lookup uv_lines(mesh, "uv", ctx), normal_lines(mesh, "normal", ctx);
  uv_lines.add_lines(lines, "vt");
  normal_lines.add_lines(lines, "vn");
  add_faces(lines, mesh, uv_lines, normal_lines, material);
  lines.flush();
}

}  // namespace frustum
