#include "runtime/buffers/mesh.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace frustum {
namespace {

constexpr std::array component_names{"x", "y", "z", "w"};

std::size_t elements(const Mesh& m, Domain d) {
  switch (d) {
    case Domain::vertex: return m.vertices();
    case Domain::corner: return 3 * m.faces();
    case Domain::face: return m.faces();
    case Domain::mesh: return 1;
  }
  return 0;
}

template <class T>
std::vector<T> component(const Column& c, int k) {
  const auto* v = static_cast<const T*>(c.data());
  const auto width = static_cast<std::size_t>(c.width());
  std::vector<T> out(c.rows());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = v[i * width + static_cast<std::size_t>(k)];
  return out;
}

Statistics measure(const Column& c, int k) {
  switch (c.kind()) {
    case NumberKind::f32: return frustum::measure(component<float>(c, k));
    case NumberKind::f64: return frustum::measure(component<double>(c, k));
    case NumberKind::i32: return frustum::measure(component<std::int32_t>(c, k));
    case NumberKind::u32: return frustum::measure(component<std::uint32_t>(c, k));
  }
  return {};
}

Json cell(const Column& c, std::size_t row, int k) {
  const double v = c.number(row, k);
  switch (c.kind()) {
    case NumberKind::f32: return json_number(static_cast<float>(v));
    case NumberKind::f64: return json_number(v);
    case NumberKind::i32: return json_number(static_cast<std::int32_t>(v));
    case NumberKind::u32: return json_number(static_cast<std::uint32_t>(v));
  }
  return {};
}

Json describe_column(const Column& c) {
  Hasher h;
  c.hash(h);
  Json parts = Json::array();
  for (int k = 0; k < c.width(); ++k) {
    Json part = {{"name", component_names[static_cast<std::size_t>(k)]}};
    part.update(to_json(measure(c, k)));
    parts.push_back(std::move(part));
  }
  return {{"name", c.name()},
          {"domain", name_of(c.domain())},
          {"kind", name_of(c.kind())},
          {"width", c.width()},
          {"rows", c.rows()},
          {"space", name_of(c.space())},
          {"bytes", c.bytes()},
          {"digest", to_hex(h.done())},
          {"components", std::move(parts)}};
}

// The type that a column of a known name must have; null where it is right or the name is free.
std::string wrong_type(const Column& c, const Mesh& m) {
  const bool real = c.kind() == NumberKind::f32 || c.kind() == NumberKind::f64;
  const bool on_surface = c.domain() == Domain::vertex || c.domain() == Domain::corner;
  const auto be = [&](bool right, std::string_view wanted) {
    return right ? std::string() : fmt::format("column {} must be {}", c.name(), wanted);
  };
  if (c.name() == "triangle")
    return be(c.domain() == Domain::face && c.holds<glm::uvec3>(), "u32 x 3 on faces");
  if (c.name() == "position") {
    const int width = m.space() == Space::clip || m.space() == Space::screen ? 4 : 3;
    return be(c.domain() == Domain::vertex && real && c.width() == width,
              fmt::format("real x {} on vertices", width));
  }
  if (c.name() == "normal")
    return be(on_surface && real && c.width() == 3, "real x 3 on vertices or corners");
  if (is_uv_column(c.name()))
    return be(on_surface && real && c.width() == 2, "real x 2 on vertices or corners");
  if (c.name() == "color")
    return be(on_surface && real && (c.width() == 3 || c.width() == 4),
              "real x 3 or 4 on vertices or corners");
  if (c.name() == "world")
    return be(c.domain() == Domain::vertex && real && c.width() == 3, "real x 3 on vertices");
  if (c.name() == "origin" || c.name() == "material")
    return be(c.domain() == Domain::face && c.holds<std::uint32_t>(), "u32 on faces");
  return {};
}

struct Ops {
  static std::size_t bytes(const Mesh& m) {
    std::size_t sum = sizeof m;
    for (const auto& c : m.columns) sum += c->bytes();
    return sum + (m.materials ? bytes_of(*m.materials) : 0);
  }
  static void parts(const Mesh& m, const std::function<void(const void*, std::size_t)>& visit) {
    for (const auto& c : m.columns) visit(c->data(), c->bytes());
    if (!m.materials) return;
    std::size_t textures = 0;
    visit_textures(*m.materials,
                   [&](const void* texture, std::size_t bytes) { visit(texture, bytes), textures += bytes; });
    visit(m.materials.get(), bytes_of(*m.materials) - textures);
  }
  static void hash(const Mesh& m, Hasher& h) {
    h.value(m.columns.size());
    for (const auto& c : m.columns) c->hash(h);
    hash_materials(m.materials ? *m.materials : MaterialSet{}, h);
    h.value(m.camera != nullptr);
    if (m.camera) h.value(Buffer(m.camera).digest());
    h.value(m.closed ? (*m.closed ? 1 : 0) : 2);
  }
  static Health health(const Mesh& m) {
    Health sum;
    for (const auto& c : m.columns) sum.add(c->health());
    if (m.materials) sum.add(health_of_materials(*m.materials));
    return sum;
  }
  static void save(const Mesh& m, ArchiveWriter& w) {
    w.value(std::uint64_t{m.columns.size()});
    for (const auto& c : m.columns) c->save(w);
    w.value(m.materials != nullptr);
    if (m.materials) save_materials(*m.materials, w);
    save_part(m.camera, w);
    w.value(static_cast<std::uint8_t>(m.closed ? *m.closed : 2));
  }
  static Mesh load(ArchiveReader& r) {
    Mesh m;
    for (std::size_t n = r.count(1); n > 0; --n) m.columns.push_back(Column::load(r));
    if (r.flag()) m.materials = std::make_shared<const MaterialSet>(load_materials(r));
    m.camera = load_part<Camera>(r);
    if (const auto closed = r.choice<std::uint8_t>(2); closed != 2) m.closed = closed == 1;
    return m;
  }
  static Json summary(const Mesh& m) {
    Json columns = Json::array();
    for (const auto& c : m.columns) columns.push_back(describe_column(*c));
    Json out = {{"vertices", m.vertices()}, {"faces", m.faces()}, {"space", name_of(m.space())}};
    if (m.closed) out["closed"] = *m.closed;
    if (m.materials) {
      Json names = Json::array();
      for (const Material& material : m.materials->materials) names.push_back(material.name);
      out["materials"] = std::move(names);
    }
    out["columns"] = std::move(columns);
    return out;
  }
  // Row i shows vertex i, corner i and face i side by side; null beyond the end of the shorter ones.
  static Json table(const Mesh& m, std::size_t first, std::size_t count) {
    Json names = Json::array();
    std::size_t total = 0;
    for (const auto& c : m.columns) {
      total = std::max(total, c->rows());
      for (int k = 0; k < c->width(); ++k) {
        const std::string suffix =
            c->width() == 1 ? "" : fmt::format(".{}", component_names[static_cast<std::size_t>(k)]);
        names.push_back(fmt::format("{} {}{}", name_of(c->domain()), c->name(), suffix));
      }
    }
    return json_table(std::move(names), total, first, count, [&](std::size_t i) {
      Json row = Json::array();
      for (const auto& c : m.columns)
        for (int k = 0; k < c->width(); ++k) row.push_back(i < c->rows() ? cell(*c, i, k) : Json());
      return row;
    });
  }
};

}  // namespace

const Column* Mesh::find(std::string_view name) const {
  for (const auto& c : columns)
    if (c->name() == name) return c.get();
  return nullptr;
}

Ref<Column> Mesh::share(std::string_view name) const {
  for (const auto& c : columns)
    if (c->name() == name) return c;
  return nullptr;
}

const Column& Mesh::at(std::string_view name) const {
  const Column* c = find(name);
  if (c == nullptr) throw NodeError("missing_column", fmt::format("the mesh has no column '{}'", name));
  return *c;
}

std::size_t Mesh::vertices() const {
  const Column* c = find("position");
  return c != nullptr ? c->rows() : 0;
}

std::size_t Mesh::faces() const {
  const Column* c = find("triangle");
  return c != nullptr ? c->rows() : 0;
}

Space Mesh::space() const {
  const Column* c = find("position");
  return c != nullptr ? c->space() : Space::none;
}

std::span<const glm::uvec3> Mesh::triangles() const { return at("triangle").values<glm::uvec3>(); }

Mesh Mesh::with(Ref<Column> column) const {
  Mesh m = *this;
  const auto same = std::find_if(m.columns.begin(), m.columns.end(),
                                 [&](const auto& c) { return c->name() == column->name(); });
  if (same != m.columns.end())
    *same = std::move(column);
  else
    m.columns.push_back(std::move(column));
  return m;
}

std::string Mesh::validate() const {
  std::set<std::string_view> names;
  for (const auto& c : columns)
    if (!names.insert(c->name()).second) return fmt::format("there are two columns '{}'", c->name());
  for (const std::string_view needed : {"triangle", "position"})
    if (!names.contains(needed)) return fmt::format("there is no column '{}'", needed);
  for (const auto& c : columns) {
    if (std::string wrong = wrong_type(*c, *this); !wrong.empty()) return wrong;
    if (const std::size_t rows = elements(*this, c->domain()); c->rows() != rows)
      return fmt::format("column {} has {} rows for {} of domain {}", c->name(), c->rows(), rows,
                         name_of(c->domain()));
  }
  const std::size_t n = vertices();
  const auto faces = triangles();
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (std::max({faces[f].x, faces[f].y, faces[f].z}) >= n)
      return fmt::format("face {} names a vertex beyond the {} there are", f, n);
  if (const Column* material = find("material")) {
    const std::size_t known = materials ? materials->materials.size() : 1;
    const auto ids = material->values<std::uint32_t>();
    for (std::size_t f = 0; f < ids.size(); ++f)
      if (ids[f] >= known) return fmt::format("face {} names material {} of {}", f, ids[f], known);
  }
  return {};
}

template <>
const BufferType& buffer_type<Mesh>() {
  static const BufferType type = make_buffer_type<Mesh, Ops>(
      "mesh", "Triangles with columns of attributes over vertices, corners and faces.", "#4f9da6");
  return type;
}

}  // namespace frustum
