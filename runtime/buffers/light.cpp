#include "runtime/buffers/light.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

constexpr std::array kind_names{"ambient", "directional", "point", "spot", "area"};

Json json(const glm::dvec3& v) { return {json_number(v.x), json_number(v.y), json_number(v.z)}; }

struct Ops {
  static std::size_t bytes(const LightSet& s) { return sizeof s + s.lights.size() * sizeof(Light); }
  static void hash(const LightSet& s, Hasher& h) {
    h.value(s.lights.size());
    for (const Light& l : s.lights) {
      h.value(l.kind);
      for (const glm::dvec3& v : {l.color, l.direction, l.position, l.attenuation, l.edge_u, l.edge_v})
        h.value(v.x).value(v.y).value(v.z);
      h.value(l.inner).value(l.outer).value(l.samples);
    }
  }
  static void save(const LightSet& s, ArchiveWriter& w) {
    w.value(std::uint64_t{s.lights.size()});
    for (const Light& l : s.lights) {
      w.value(l.kind);
      for (const glm::dvec3& v : {l.color, l.direction, l.position, l.attenuation, l.edge_u, l.edge_v})
        w.raw(&v, sizeof v);
      w.value(l.inner), w.value(l.outer), w.value(l.samples);
    }
  }
  static LightSet load(ArchiveReader& r) {
    LightSet s;
    for (std::size_t n = r.count(sizeof(Light::Kind)); n > 0; --n) {
      Light& l = s.lights.emplace_back();
      l.kind = r.choice(Light::Kind::area);
      for (glm::dvec3* v : {&l.color, &l.direction, &l.position, &l.attenuation, &l.edge_u, &l.edge_v})
        r.raw(v, sizeof *v);
      for (double* v : {&l.inner, &l.outer}) r.raw(v, sizeof *v);
      r.raw(&l.samples, sizeof l.samples);
    }
    return s;
  }
  static Health health(const LightSet& s) {
    Health sum;
    for (std::size_t i = 0; i < s.lights.size(); ++i) {
      const Light& l = s.lights[i];
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
                                                            {"attenuation", l.attenuation.z},
                                                            {"inner", l.inner},
                                                            {"outer", l.outer},
                                                            {"edge_u", l.edge_u.x},
                                                            {"edge_u", l.edge_u.y},
                                                            {"edge_u", l.edge_u.z},
                                                            {"edge_v", l.edge_v.x},
                                                            {"edge_v", l.edge_v.y},
                                                            {"edge_v", l.edge_v.z}};
      sum.add(health_of(s.lights.size() == 1 ? "light" : fmt::format("light {}", i), values));
    }
    return sum;
  }
  static Json summary(const LightSet& s) {
    Json lights = Json::array();
    for (const Light& l : s.lights) {
      Json one = {{"kind", kind_names[static_cast<std::size_t>(l.kind)]}, {"color", json(l.color)}};
      const bool spot = l.kind == Light::Kind::spot;
      if (spot || l.kind == Light::Kind::directional) one["direction"] = json(l.direction);
      if (spot || l.kind == Light::Kind::point)
        one["position"] = json(l.position), one["attenuation"] = json(l.attenuation);
      if (l.kind == Light::Kind::area)
        one["position"] = json(l.position), one["edge_u"] = json(l.edge_u), one["edge_v"] = json(l.edge_v),
        one["samples"] = l.samples;
      if (spot) one["inner"] = json_number(l.inner), one["outer"] = json_number(l.outer);
      lights.push_back(std::move(one));
    }
    return {{"lights", std::move(lights)}};
  }
};

}  // namespace

template <>
const BufferType& buffer_type<LightSet>() {
  static const BufferType type =
      make_buffer_type<LightSet, Ops>("light", "Sources of light, one or all of a scene.", "#e8d35a");
  return type;
}

}  // namespace frustum
