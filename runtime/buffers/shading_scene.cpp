#include "runtime/buffers/shading_scene.h"

#include "nodes/kernels/lamp_pieces.h"
#include "runtime/buffers/visible_lights.h"

#include <numbers>

namespace frustum {
namespace {

using kernels::Triple;

template <std::floating_point R>
Triple<R> narrow(const glm::dvec3& v) {
  return {static_cast<R>(v.x), static_cast<R>(v.y), static_cast<R>(v.z)};
}

// A colour of -0 becomes 0: what is left out where it is 0 would have made 0 of a sum of -0.
template <std::floating_point R>
Triple<R> narrow_color(const glm::dvec3& v) {
  return narrow<R>(v + glm::dvec3(0.0));
}

bool has_highlight(const Material& m) {
  return !m.unlit && m.model != Reflection::lambert && m.specular != glm::dvec3{0};
}

template <std::floating_point R>
kernels::ShadedSurface<R> surface_of(const Material& m, const glm::dvec3& ambient_light,
                                     const ShadingEffects& asked) {
  kernels::ShadedSurface<R> s{{narrow_color<R>(m.ambient * m.diffuse * ambient_light),
                               narrow_color<R>(m.diffuse),
                               {},
                               narrow_color<R>(m.emission),
                               asked.ambient},
                              asked.all_highlights ? kernels::Highlight::blinn : kernels::Highlight::none,
                              kernels::Exponent<R>(m.shininess),
                              m.two_sided};
  if (m.unlit) {
    s.colors.ambient = s.colors.diffuse, s.colors.diffuse = {};
    s.colors.adds_ambient = true;
    return s;
  }
  if (!asked.highlights || !has_highlight(m)) return s;
  s.colors.specular = narrow_color<R>(m.specular);
  s.highlight = m.model == Reflection::phong ? kernels::Highlight::phong : kernels::Highlight::blinn;
  return s;
}

template <std::floating_point R>
kernels::LightSource<R> source_of(const Light& light, const ShadingEffects& asked) {
  kernels::LightSource<R> s{light.has_place(), narrow_color<R>(light.color),
                            narrow<R>(light.has_place() ? light.position : -light.direction),
                            narrow<R>(light.attenuation)};
  s.falls_off = asked.attenuation && (asked.all_attenuation || falls_off(light));
  if (light.kind == Light::Kind::spot) {
    const kernels::Cone cone(light.inner, light.outer);
    s.is_spot = true, s.axis = narrow<R>(light.direction);
    s.cone_scale = static_cast<R>(cone.scale), s.cone_offset = static_cast<R>(cone.offset);
  }
  return s;
}

// A lamp of radiance L and area A lights a surface like n pieces of L A / n: what a white surface sends back of it is
// E / pi, and each piece adds L A / n cos(surface) cos(lamp) / d^2 to E.
template <std::floating_point R>
void add_pieces(const Light& light, const ShadingEffects& asked, std::vector<kernels::LightSource<R>>& to) {
  const kernels::LampPieces lamp(light.position, light.edge_u, light.edge_v, light.samples);
  for (std::uint32_t i = 0; i < light.samples; ++i) {
    Light piece = light;
    piece.position = lamp.point(i);
    piece.color = light.color * (lamp.area() / (std::numbers::pi * light.samples));
    piece.attenuation = {0, 0, 1};
    kernels::LightSource<R> s = source_of<R>(piece, asked);
    s.is_patch = true, s.axis = narrow<R>(lamp.axis());
    to.push_back(s);
  }
}

template <std::floating_point R>
std::vector<kernels::LightSource<R>> sources_of(std::span<const Ref<LightSet>> lights,
                                                const ShadingEffects& asked) {
  std::vector<kernels::LightSource<R>> all;
  for (const Ref<LightSet>& set : lights)
    for (const Light& light : set->lights) {
      if (light.kind == Light::Kind::ambient || light.color == glm::dvec3{0}) continue;
      if (light.kind == Light::Kind::area)
        add_pieces(light, asked, all);
      else
        all.push_back(source_of<R>(light, asked));
    }
  return all;
}

}  // namespace

template <std::floating_point R>
Ref<Column> world_positions(const Mesh& mesh) {
  const bool placed = mesh.space() == Space::world || mesh.space() == Space::object;
  const bool own = mesh.find("world") == nullptr && placed;
  if (!own && mesh.find("world") == nullptr)
    throw NodeError("missing_column", "the mesh has no world positions: it has not passed project.view",
                    at_input("mesh"));
  Ref<Column> c = mesh.real<R>(own ? "position" : "world");
  if (c->width() != 3)
    throw NodeError("wrong_column", "world positions have three components", at_input("mesh"));
  return c;
}

template <std::floating_point R>
kernels::ShadingScene<R> make_shading_scene(const LitScene& lit, const Camera* camera, bool two_sided,
                                            const ShadingEffects& asked) {
  kernels::ShadingScene<R> s;
  glm::dvec3 ambient{0};
  for (const Ref<LightSet>& set : lit.lights)
    for (const Light& light : set->lights)
      if (light.kind == Light::Kind::ambient) ambient += light.color;
  s.lights = sources_of<R>(lit.lights, asked);
  bool needs_eye = false;
  for (const auto& m : lit.materials) {
    kernels::ShadedSurface<R> surface = surface_of<R>(*m, ambient, asked);
    // Asked for even where no light makes a highlight: whether a graph is right does not depend on its lights.
    needs_eye = needs_eye || m->two_sided || two_sided || has_highlight(*m);
    surface.two_sided = (surface.two_sided || two_sided) && asked.sides;
    s.highlights = s.highlights || surface.highlight != kernels::Highlight::none;
    s.surfaces.push_back(surface);
  }
  if (needs_eye && camera == nullptr)
    throw NodeError("missing_camera", "highlights and two sides need a camera: link one to 'camera'");
  if (camera != nullptr) s.eye = eye_of<R>(*camera);
  if (s.surfaces.size() > 1 && lit.mesh.find("material") != nullptr) {
    const auto of = lit.mesh.at("material").values<std::uint32_t>();
    for (const std::uint32_t m : of)
      if (m >= s.surfaces.size())
        throw NodeError("bad_material", "a face has a material that the mesh does not have",
                        at_input("mesh"));
    s.surface_of.assign(of.begin(), of.end());
  }
  return s;
}

std::vector<kernels::LightSource<double>> light_sources(std::span<const Ref<LightSet>> lights) {
  return sources_of<double>(lights, {.highlights = true,
                                     .ambient = true,
                                     .attenuation = true,
                                     .sides = true,
                                     .all_highlights = false,
                                     .all_attenuation = false,
                                     .all_sides = false});
}

template Ref<Column> world_positions<float>(const Mesh&);
template Ref<Column> world_positions<double>(const Mesh&);
template kernels::ShadingScene<float> make_shading_scene(const LitScene&, const Camera*, bool,
                                                         const ShadingEffects&);
template kernels::ShadingScene<double> make_shading_scene(const LitScene&, const Camera*, bool,
                                                          const ShadingEffects&);

}  // namespace frustum
