#include "nodes/kernels/transfer.h"
#include "runtime/io/mesh_writers.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
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
      lines.add(" {}", static_cast<const float*>(c.data())[first + k]);
    else
      lines.add(" {}", static_cast<const double*>(c.data())[first + k]);
  }
}

void add_rows(Lines& lines, std::string_view key, const Column* c) {
  for (std::size_t i = 0; c != nullptr && i < c->rows(); ++i) {
    lines.add("{}", key);
    add_numbers(lines, *c, i);
    lines.add("\n");
  }
}

void add_positions(Lines& lines, const Mesh& mesh, const Column* color) {
  const Column& position = mesh.at("position");
  if (color == nullptr) return add_rows(lines, "v", &position);
  for (std::size_t i = 0; i < position.rows(); ++i) {
    lines.add("v");
    add_numbers(lines, position, i);
    for (int k = 0; k < 3; ++k)
      lines.add(" {}", static_cast<float>(kernels::encode(kernels::Curve::srgb, color->number(i, k))));
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

}  // namespace

void write_obj(const Mesh& mesh, const SaveRequest& request, PartialFile& to, Context& ctx) {
  const Column *uv = mesh.find("uv"), *normal = mesh.find("normal"), *color = mesh.find("color"),
               *material = mesh.materials ? mesh.find("material") : nullptr;
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
  add_rows(lines, "vt", uv);
  add_rows(lines, "vn", normal);
  const auto triangles = mesh.triangles();
  std::optional<std::uint32_t> now;
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (material != nullptr) {
      const std::uint32_t m = material->values<std::uint32_t>()[f];
      if (now != m) lines.add("usemtl {}\n", line_name(mesh.materials->materials[m].name));
      now = m;
    }
    lines.add("f");
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = triangles[f][static_cast<glm::length_t>(k)];
      const auto index = [&](const Column& c) { return 1 + (c.domain() == Domain::corner ? 3 * f + k : v); };
      lines.add(" {}", v + 1);
      if (uv != nullptr) lines.add("/{}", index(*uv));
      if (normal != nullptr) lines.add("{}{}", uv == nullptr ? "//" : "/", index(*normal));
    }
    lines.add("\n");
  }
  lines.flush();
}

}  // namespace frustum
