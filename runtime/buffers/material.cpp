#include "runtime/buffers/material.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"
#include "runtime/buffers/texture.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

Json json(const glm::dvec3& v) { return {json_number(v.x), json_number(v.y), json_number(v.z)}; }

void hash_material(const Material& m, Hasher& h) {
  h.text(m.name).value(m.model);
  for (const glm::dvec3& v : {m.ambient, m.diffuse, m.specular, m.emission})
    h.value(v.x).value(v.y).value(v.z);
  h.value(m.shininess).value(m.two_sided).value(m.unlit).value(m.uv_set).value(m.texture != nullptr);
  if (m.texture) h.value(m.texture->digest());
  for (glm::length_t column = 0; column < 3; ++column)
    for (glm::length_t row = 0; row < 3; ++row) h.value(m.texture_from_uv[column][row]);
}

// Of its numbers, without its texture.
Health health_of_numbers(const Material& m, std::string_view owner) {
  const std::pair<std::string_view, double> values[] = {
      {"ambient", m.ambient.x},   {"ambient", m.ambient.y},   {"ambient", m.ambient.z},
      {"diffuse", m.diffuse.x},   {"diffuse", m.diffuse.y},   {"diffuse", m.diffuse.z},
      {"specular", m.specular.x}, {"specular", m.specular.y}, {"specular", m.specular.z},
      {"emission", m.emission.x}, {"emission", m.emission.y}, {"emission", m.emission.z},
      {"shininess", m.shininess}};
  return health_of(owner, values);
}

// Everything but the texture, which is named by its place among those of the set; 0: none.
void save_numbers(const Material& m, std::uint32_t texture, ArchiveWriter& w) {
  w.text(m.name).value(m.model);
  for (const glm::dvec3& v : {m.ambient, m.diffuse, m.specular, m.emission}) w.raw(&v, sizeof v);
  w.value(m.shininess).value(m.two_sided).value(m.unlit).value(m.uv_set).value(texture);
  w.raw(&m.texture_from_uv, sizeof m.texture_from_uv);
}

Material load_numbers(const std::vector<Ref<Texture>>& textures, ArchiveReader& r) {
  Material m;
  m.name = r.text();
  m.model = r.choice(Reflection::blinn);
  for (glm::dvec3* v : {&m.ambient, &m.diffuse, &m.specular, &m.emission}) r.raw(v, sizeof *v);
  m.shininess = r.value<double>();
  m.two_sided = r.flag();
  m.unlit = r.flag();
  m.uv_set = r.value<std::uint32_t>();
  const auto texture = r.value<std::uint32_t>();
  if (texture > textures.size()) throw ArchiveError("a texture that is not there");
  if (texture != 0) m.texture = textures[texture - 1];
  r.raw(&m.texture_from_uv, sizeof m.texture_from_uv);
  return m;
}

struct Ops {
  static std::size_t bytes(const Material& m) {
    return sizeof m + m.name.size() + (m.texture ? m.texture->bytes() : 0);
  }
  static void save(const Material& m, ArchiveWriter& w) { save_materials({{m}}, w); }
  static Material load(ArchiveReader& r) {
    MaterialSet set = load_materials(r);
    if (set.materials.size() != 1) throw ArchiveError("one material is wanted");
    return std::move(set.materials[0]);
  }
  static void parts(const Material& m, const std::function<void(const void*, std::size_t)>& visit) {
    visit(&m, sizeof m + m.name.size());
    if (m.texture) visit(m.texture.get(), m.texture->bytes());
  }
  static void hash(const Material& m, Hasher& h) { hash_material(m, h); }
  static Health health(const Material& m) {
    Health sum = health_of_numbers(m, "material");
    if (m.texture) sum.add(m.texture->health());
    return sum;
  }
  static Json summary(const Material& m) {
    Json out = {{"name", m.name},
                {"model", choices(m.model)[static_cast<std::size_t>(m.model)].second},
                {"ambient", json(m.ambient)},
                {"diffuse", json(m.diffuse)},
                {"specular", json(m.specular)},
                {"shininess", json_number(m.shininess)},
                {"emission", json(m.emission)},
                {"two_sided", m.two_sided},
                {"unlit", m.unlit}};
    if (m.texture) {
      out["texture"] = buffer_type<Texture>().summary(m.texture.get());
      out["uv"] = uv_column_name(m.uv_set);
    }
    return out;
  }
};

}  // namespace

std::string uv_column_name(std::uint32_t set) { return set == 0 ? "uv" : fmt::format("uv{}", set); }

bool is_uv_column(std::string_view name) {
  if (!name.starts_with("uv")) return false;
  name.remove_prefix(2);
  return name.empty() || (name[0] != '0' &&
                          std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; }));
}

void visit_textures(const MaterialSet& set,
                    const std::function<void(const void* storage, std::size_t bytes)>& visit) {
  std::vector<const Texture*> seen;
  for (const Material& m : set.materials)
    if (m.texture) seen.push_back(m.texture.get());
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  for (const Texture* t : seen) visit(t, t->bytes());
}

std::size_t bytes_of(const MaterialSet& set) {
  std::size_t sum = sizeof set + set.materials.size() * sizeof(Material);
  for (const Material& m : set.materials) sum += m.name.size();
  visit_textures(set, [&](const void*, std::size_t bytes) { sum += bytes; });
  return sum;
}

void hash_materials(const MaterialSet& set, Hasher& h) {
  h.value(set.materials.size());
  for (const Material& m : set.materials) hash_material(m, h);
}

Health health_of_materials(const MaterialSet& set) {
  Health sum;
  for (const Material& m : set.materials) sum.add(health_of_numbers(m, fmt::format("material {}", m.name)));
  visit_textures(set, [&](const void* texture, std::size_t) {
    sum.add(static_cast<const Texture*>(texture)->health());
  });
  return sum;
}

void save_materials(const MaterialSet& set, ArchiveWriter& w) {
  std::vector<const Texture*> textures;
  visit_textures(set,
                 [&](const void* t, std::size_t) { textures.push_back(static_cast<const Texture*>(t)); });
  w.value(std::uint64_t{textures.size()});
  for (const Texture* t : textures) buffer_type<Texture>().save(t, w);
  w.value(std::uint64_t{set.materials.size()});
  for (const Material& m : set.materials) {
    const auto at = std::find(textures.begin(), textures.end(), m.texture.get());
    save_numbers(m, m.texture ? static_cast<std::uint32_t>(at - textures.begin()) + 1 : 0, w);
  }
}

MaterialSet load_materials(ArchiveReader& r) {
  std::vector<Ref<Texture>> textures;
  for (std::size_t n = r.count(1); n > 0; --n)
    textures.push_back(buffer_type<Texture>().load(r).as<Texture>());
  MaterialSet set;
  for (std::size_t n = r.count(1); n > 0; --n) set.materials.push_back(load_numbers(textures, r));
  return set;
}

template <>
const BufferType& buffer_type<Material>() {
  static const BufferType type =
      make_buffer_type<Material, Ops>("material", "What a surface is made of.", "#c76f5a");
  return type;
}

}  // namespace frustum
