#include "runtime/buffers/light.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"

#include <nlohmann/json.hpp>

namespace frustum {
namespace {

constexpr std::array kind_names{"ambient", "directional", "point"};

Json json(const glm::dvec3& v) { return {json_number(v.x), json_number(v.y), json_number(v.z)}; }

struct Ops {
  static std::size_t bytes(const Light& l) { return sizeof l; }
  static void hash(const Light& l, Hasher& h) {
    h.value(l.kind);
    for (const glm::dvec3& v : {l.color, l.direction, l.position, l.attenuation})
      h.value(v.x).value(v.y).value(v.z);
  }
  static Health health(const Light& l) {
    const std::pair<std::string_view, double> values[] = {{"color", l.color.x},
                                                          {"color", l.color.y},
                                                          {"color", l.color.z},
                                                          {"direction", l.direction.x},
                                                          {"direction", l.direction.y},
                                                          {"direction", l.direction.z},
                                                          {"position", l.position.x},
                                                          {"position", l.position.y},
                                                          {"position", l.position.z},
                                                          {"attenuation", l.attenuation.x},
                                                          {"attenuation", l.attenuation.y},
                                                          {"attenuation", l.attenuation.z}};
    return health_of("light", values);
  }
  static Json summary(const Light& l) {
    Json out = {{"kind", kind_names[static_cast<std::size_t>(l.kind)]}, {"color", json(l.color)}};
    if (l.kind == Light::Kind::directional) out["direction"] = json(l.direction);
    if (l.kind == Light::Kind::point)
      out["position"] = json(l.position), out["attenuation"] = json(l.attenuation);
    return out;
  }
};

}  // namespace

template <>
const BufferType& buffer_type<Light>() {
  static const BufferType type = make_buffer_type<Light, Ops>("light", "A source of light.", "#e8d35a");
  return type;
}

}  // namespace frustum
