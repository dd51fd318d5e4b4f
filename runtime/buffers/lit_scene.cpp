#include "runtime/buffers/lit_scene.h"

#include "nodes/kernels/face_light.h"
#include "nodes/kernels/parallel.h"
#include "runtime/buffers/shading_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace frustum {
namespace {

// Sums over 2^16 such lights, each at its greatest strength of 2^96 (nodes/kernels/lighting.h), times such a surface stay
// below 2^127, the greatest exponent of binary32.
constexpr double most = 0x1p14;
bool tame(const glm::dvec3& c) { return c.r >= 0 && c.g >= 0 && c.b >= 0 && c.r + c.g + c.b <= most; }
glm::dvec3 cross(const glm::dvec3& a, const glm::dvec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot(const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

bool black(const glm::dvec3& c) { return c == glm::dvec3{0}; }

// A lamp with an area shines with its colour times that.
bool tame(const Light& l) {
  const glm::dvec3 n = cross(l.edge_u, l.edge_v);
  return tame(l.color) && (l.kind != Light::Kind::area || tame(l.color * std::sqrt(dot(n, n))));
}
bool tame(const Material& m) {
  return tame(m.ambient) && tame(m.diffuse) && tame(m.specular) && tame(m.emission) && m.shininess >= 0 &&
         m.shininess <= 0x1p100;
}
bool shines(const Light& l) { return l.kind != Light::Kind::ambient && !black(l.color); }

// Why nothing may be left out; empty where it may.
std::string wild(const LitScene& s) {
  if (const auto l = s.light([](const Light& x) { return !tame(x); }))
    return fmt::format("light {} is brighter than {}: 0 times what it gives may be no 0", *l, most);
  if (const auto m = s.used([](const Material& x) { return !tame(x); }))
    return fmt::format("{} has a colour above {} or a shininess without bound",
                       name_of_material(s.materials, *m), most);
  return "";
}

// A vertex that stands in front of a face's plane by more than rounding of positions explains.
struct InFront {
  std::size_t vertex, face;
};

constexpr std::size_t most_tests = std::size_t{1} << 20;

double extent(std::span<const glm::dvec3> p) {
  glm::dvec3 low(p[0]), high(p[0]);
  for (const glm::dvec3& q : p) {
    low = glm::dvec3(std::min(low.x, q.x), std::min(low.y, q.y), std::min(low.z, q.z));
    high = glm::dvec3(std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z));
  }
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

// Null where there is none, or where `tests` ran out.
std::optional<InFront> find_in_front(const Mesh& mesh, std::span<const glm::dvec3> position,
                                     std::size_t& tests) {
  const auto triangles = mesh.triangles();
  std::vector<std::uint8_t> has_face(position.size(), 0);
  for (const glm::uvec3& t : triangles) has_face[t[0]] = has_face[t[1]] = has_face[t[2]] = 1;
  const double slack = 1e-6 * extent(position);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const glm::dvec3 a(position[triangles[f][0]]);
    const glm::dvec3 n =
        cross(glm::dvec3(position[triangles[f][1]]) - a, glm::dvec3(position[triangles[f][2]]) - a);
    const double length = std::sqrt(dot(n, n));
    for (std::size_t v = 0; v < position.size(); ++v) {
      if (tests == 0) return std::nullopt;
      --tests;
      if (has_face[v] != 0 && dot(n, glm::dvec3(position[v]) - a) > slack * length) return InFront{v, f};
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<Ref<Material>> materials_of(const Mesh& mesh) {
  if (!mesh.materials || mesh.materials->materials.empty()) return {std::make_shared<const Material>()};
  std::vector<Ref<Material>> all;
  for (const Material& m : mesh.materials->materials) all.push_back({mesh.materials, &m});
  return all;
}

std::string name_of_material(std::span<const Ref<Material>> materials, std::size_t index) {
  const std::string& name = materials[index]->name;
  if (!name.empty()) return fmt::format("material \"{}\"", name);
  return materials.size() == 1 ? std::string("the material") : fmt::format("material {}", index);
}

std::optional<std::size_t> LitScene::used(const std::function<bool(const Material&)>& is) const {
  std::vector<bool> holds;
  for (const Ref<Material>& m : materials) holds.push_back(is(*m));
  if (std::find(holds.begin(), holds.end(), true) == holds.end() || mesh.faces() == 0) return std::nullopt;
  const Column* column = materials.size() > 1 ? mesh.find("material") : nullptr;
  if (column == nullptr) return holds[0] ? std::optional<std::size_t>(0) : std::nullopt;
  for (const std::uint32_t m : column->values<std::uint32_t>())
    if (m < holds.size() && holds[m]) return m;
  return std::nullopt;
}

std::optional<std::size_t> LitScene::light(const std::function<bool(const Light&)>& is) const {
  std::size_t n = 0;
  for (const Ref<LightSet>& set : lights)
    for (const Light& l : set->lights) {
      if (is(l)) return n;
      ++n;
    }
  return std::nullopt;
}

Verdict needs_highlights(const LitScene& s, std::uint64_t points) {
  if (const std::string why = wild(s); !why.empty()) return on(why, points);
  const auto shiny = s.used(
      [](const Material& m) { return !m.unlit && m.model != Reflection::lambert && !black(m.specular); });
  if (!shiny)
    return off_exact("no face has a material with a highlight: model lambert, specular 0 or unlit", points);
  const auto lamp = s.light(shines);
  if (!lamp) return off_exact("no light but ambient light, which makes no highlight", points);
  return on(fmt::format("{} is shiny, and light {} shines", name_of_material(s.materials, *shiny), *lamp),
            points);
}

Verdict needs_ambient(const LitScene& s, std::uint64_t points) {
  if (const std::string why = wild(s); !why.empty()) return on(why, points);
  if (const auto m = s.used([](const Material& x) { return x.unlit; }))
    return on(fmt::format("{} shows its colour without light", name_of_material(s.materials, *m)), points);
  const auto sky = s.light([](const Light& l) { return l.kind == Light::Kind::ambient && !black(l.color); });
  if (!sky) return off_exact("no ambient light shines", points);
  const auto receiver = s.used([](const Material& m) { return !black(m.ambient * m.diffuse); });
  if (!receiver) return off_exact("no face has a material that sends ambient light back", points);
  return on(fmt::format("light {} is ambient, and {} sends it back", *sky,
                        name_of_material(s.materials, *receiver)),
            points);
}

bool falls_off(const Light& l) {
  return l.has_place() && !black(l.color) &&
         (l.kind == Light::Kind::area || l.attenuation != glm::dvec3(1, 0, 0));
}

Verdict needs_attenuation(const LitScene& s, std::uint64_t points) {
  const auto place = s.light([](const Light& l) { return l.has_place() && !black(l.color); });
  if (!place) return off_exact("no light shines from a place", points);
  if (const auto falls = s.light(falls_off))
    return on(fmt::format("light {} grows weaker with the distance", *falls), points);
  return off_exact("every light that has a place has attenuation (1, 0, 0), which divides by 1", points);
}

Verdict needs_shadows(const LitScene& s, std::span<const glm::dvec3> position) {
  const auto lamp = s.light(shines);
  if (!lamp) return off_exact("no light but ambient light, which casts no shadow");
  if (!s.used([](const Material& m) { return !m.unlit && !(black(m.diffuse) && black(m.specular)); }))
    return off_exact("no face has a material that sends the light of a lamp back");
  constexpr std::string_view nothing = "shade.shadow, linked to 'visibility', would find what it hides";
  if (position.size() != s.mesh.vertices())
    return absent(
        fmt::format("light {} shines, and the mesh has no world positions that could rule shadows out; {}",
                    *lamp, nothing));
  if (s.mesh.closed != true)
    return absent(
        fmt::format("light {} shines, and the mesh is not closed: what would cast a shadow may be culled or "
                    "clipped away; {}",
                    *lamp, nothing));
  std::size_t tests = most_tests;
  const auto blocker = find_in_front(s.mesh, position, tests);
  if (blocker)
    return absent(fmt::format("light {} shines, and vertex {} stands in front of face {}; {}", *lamp,
                              blocker->vertex, blocker->face, nothing));
  if (tests != 0)
    return off_exact(
        "the mesh is closed and no vertex stands in front of a face: a convex body shades nothing");
  return absent(fmt::format("light {} shines, and {} faces are too many to be shown to be convex; {}", *lamp,
                            s.mesh.faces(), nothing));
}

Verdict needs_shadows(const LitScene& s) {
  const bool own = s.mesh.find("world") == nullptr && s.mesh.space() == Space::world;
  const Column* column = s.mesh.find(own ? "position" : "world");
  if (column == nullptr || (column->name() == "position" && !own) || column->width() != 3)
    return needs_shadows(s, {});
  const Ref<Column> world = s.mesh.real<double>(column->name());
  return needs_shadows(s, world->values<glm::dvec3>());
}

Verdict needs_sides(const LitScene& s, bool all, const Camera* camera, std::uint64_t points,
                    const Context& ctx) {
  if (!all && !s.used([](const Material& m) { return m.two_sided; }))
    return off_exact("no face has a material with two sides", points);
  if (camera == nullptr) return on("a material has two sides", points);
  return ctx.real([&]<class R>() {
    const Ref<Column> world = world_positions<R>(s.mesh);
    const auto q = world->template values<glm::vec<3, R>>();
    const auto triangles = s.mesh.triangles();
    const kernels::Triple<R> eye = eye_of<R>(*camera);
    const std::size_t face = kernels::first_where(triangles.size(), [&](std::size_t f) {
      const glm::uvec3& t = triangles[f];
      return kernels::seen_side(q[t[0]], q[t[1]], q[t[2]], eye) < R(0);
    });
    if (face == triangles.size()) return off_exact("no face turns its back to the camera", points);
    return on(fmt::format("face {} turns its back to the camera", face), points);
  });
}

}  // namespace frustum
