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

struct Ops {
  static std::size_t bytes(const Material& m) {
    return sizeof m + m.name.size() + (m.texture ? m.texture->bytes() : 0);
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

template <>
const BufferType& buffer_type<Material>() {
  static const BufferType type =
      make_buffer_type<Material, Ops>("material", "What a surface is made of.", "#c76f5a");
  return type;
}

}  // namespace frustum
