#include "runtime/buffers/material.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"

#include <nlohmann/json.hpp>

namespace frustum {
namespace {

Json json(const glm::dvec3& v) { return {json_number(v.x), json_number(v.y), json_number(v.z)}; }

struct Ops {
  static std::size_t bytes(const Material& m) { return sizeof m + m.name.size(); }
  static void hash(const Material& m, Hasher& h) {
    h.text(m.name).value(m.model);
    for (const glm::dvec3& v : {m.ambient, m.diffuse, m.specular}) h.value(v.x).value(v.y).value(v.z);
    h.value(m.shininess);
  }
  static Health health(const Material& m) {
    const std::pair<std::string_view, double> values[] = {
        {"ambient", m.ambient.x},   {"ambient", m.ambient.y},   {"ambient", m.ambient.z},
        {"diffuse", m.diffuse.x},   {"diffuse", m.diffuse.y},   {"diffuse", m.diffuse.z},
        {"specular", m.specular.x}, {"specular", m.specular.y}, {"specular", m.specular.z},
        {"shininess", m.shininess}};
    return health_of("material", values);
  }
  static Json summary(const Material& m) {
    return {{"name", m.name},
            {"model", choices(m.model)[static_cast<std::size_t>(m.model)].second},
            {"ambient", json(m.ambient)},
            {"diffuse", json(m.diffuse)},
            {"specular", json(m.specular)},
            {"shininess", json_number(m.shininess)}};
  }
};

}  // namespace

template <>
const BufferType& buffer_type<Material>() {
  static const BufferType type =
      make_buffer_type<Material, Ops>("material", "What a surface is made of.", "#c76f5a");
  return type;
}

}  // namespace frustum
