#include "runtime/io/gltf_scene.h"

#include "nodes/kernels/vector.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace frustum::gltf {
namespace {

Placement composed(const Placement& outer, const Placement& inner) {
  return {outer.linear * inner.linear, outer.linear * inner.translation + outer.translation};
}

// Homogeneous in q, so that q needs no unit length and equal components cancel without a rounding.
glm::dmat3 rotation(double x, double y, double z, double w) {
  const double xx = x * x, yy = y * y, zz = z * z, ww = w * w, n = xx + yy + zz + ww;
  glm::dmat3 m;
  m[0] = glm::dvec3(ww + xx - yy - zz, 2 * (x * y + w * z), 2 * (x * z - w * y)) / n;
  m[1] = glm::dvec3(2 * (x * y - w * z), ww - xx + yy - zz, 2 * (y * z + w * x)) / n;
  m[2] = glm::dvec3(2 * (x * z + w * y), 2 * (y * z - w * x), ww - xx - yy + zz) / n;
  return m;
}

Placement placement_of(const Object& node) {
  Placement p;
  if (const auto m = node.numbers<16>("matrix")) {
    if ((*m)[3] != 0 || (*m)[7] != 0 || (*m)[11] != 0 || (*m)[15] != 1)
      node.fail_at("matrix", "this is not affine: its last row must be 0 0 0 1");
    for (std::size_t c = 0; c < 3; ++c)
      p.linear[static_cast<glm::length_t>(c)] = {(*m)[4 * c], (*m)[4 * c + 1], (*m)[4 * c + 2]};
    p.translation = {(*m)[12], (*m)[13], (*m)[14]};
    if (node.has("rotation") || node.has("scale") || node.has("translation"))
      node.fail("it has both a matrix and its parts");
    return p;
  }
  if (const auto q = node.numbers<4>("rotation")) {
    const double n = (*q)[0] * (*q)[0] + (*q)[1] * (*q)[1] + (*q)[2] * (*q)[2] + (*q)[3] * (*q)[3];
    if (!(n > 0) || !std::isfinite(n)) node.fail_at("rotation", "this quaternion has no length");
    p.linear = rotation((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  }
  if (const auto s = node.numbers<3>("scale"))
    for (glm::length_t c = 0; c < 3; ++c) p.linear[c] *= (*s)[static_cast<std::size_t>(c)];
  if (const auto t = node.numbers<3>("translation")) p.translation = {(*t)[0], (*t)[1], (*t)[2]};
  return p;
}

glm::dvec3 axis(const Placement& p, glm::length_t column, const Object& node) {
  const glm::dvec3 none{0}, unit = kernels::normalized_or(p.linear[column], none);
  if (unit == none) node.fail("its scale leaves no direction to look along");
  return unit;
}

class Walker {
 public:
  Walker(const Object& document, Notes& notes)
      : document_(document),
        notes_(notes),
        nodes_(document.objects("nodes")),
        cameras_(document.objects("cameras")),
        meshes_(document.objects("meshes").size()),
        skins_(document.objects("skins").size()) {
    if (const auto extension = document.extension("KHR_lights_punctual"))
      lights_ = extension->objects("lights");
    if (!document.objects("animations").empty()) notes_.add("animations", "are not played");
  }

  Flattened run() {
    std::vector<Visit> stack;
    state_.assign(nodes_.size(), State::unseen);
    for (const std::size_t root : roots()) {
      enter(root, {}, stack);
      while (!stack.empty()) {
        if (stack.back().next < stack.back().children.size()) {
          Visit& v = stack.back();
          const std::size_t child = v.children[v.next++];
          enter(child, Placement(v.world), stack);
        } else {
          state_[stack.back().node] = State::done;
          stack.pop_back();
        }
      }
    }
    return std::move(out_);
  }

 private:
  enum class State : std::uint8_t { unseen, open, done };
  struct Visit {
    std::size_t node;
    Placement world;
    std::vector<std::size_t> children;
    std::size_t next = 0;
  };

  std::vector<std::size_t> roots() const {
    const auto scenes = document_.objects("scenes");
    const auto chosen = document_.index("scene", "scenes", scenes.size());
    if (!scenes.empty()) return scenes[chosen.value_or(0)].indices("nodes", "nodes", nodes_.size());
    std::vector<char> is_child(nodes_.size(), 0);
    for (const Object& n : nodes_)
      for (const std::size_t c : n.indices("children", "nodes", nodes_.size())) is_child[c] = 1;
    std::vector<std::size_t> out;
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      if (is_child[n] == 0) out.push_back(n);
    return out;
  }

  void enter(std::size_t n, const Placement& parent, std::vector<Visit>& stack) {
    const Object& node = nodes_[n];
    if (state_[n] == State::open) node.fail("it is its own ancestor");
    if (state_[n] == State::done) node.fail("it has two parents: nodes form trees");
    state_[n] = State::open;
    const Placement world = composed(parent, placement_of(node));
    double sum = 0;  // x - x is 0, or NaN where x is not finite
    for (const glm::dvec3& v : {world.linear[0], world.linear[1], world.linear[2], world.translation})
      sum += (v.x - v.x) + (v.y - v.y) + (v.z - v.z);
    if (sum != 0 || sum != sum) node.fail("its place in the world is not finite");
    add_mesh(node, world);
    add_camera(node, world);
    add_light(node, world);
    stack.push_back({n, world, node.indices("children", "nodes", nodes_.size())});
  }

  void add_mesh(const Object& node, const Placement& world) {
    const auto mesh = node.index("mesh", "meshes", meshes_);
    if (!mesh) return;
    if (node.extension("EXT_mesh_gpu_instancing"))
      notes_.add(node.path(),
                 "is one of many instances (EXT_mesh_gpu_instancing), which are left out but for one");
    const bool skinned = node.index("skin", "skins", skins_).has_value();
    if (skinned) notes_.add(node.path(), "has a skin: its mesh stays in the bind pose");
    out_.instances.push_back({*mesh, skinned ? Placement{} : world});
  }

  void add_camera(const Object& node, const Placement& world) {
    const auto at = node.index("camera", "cameras", cameras_.size());
    if (!at) return;
    const Object& o = cameras_[*at];
    Camera c;
    c.eye = world.translation;
    c.target = c.eye - axis(world, 2, node);
    c.up = axis(world, 1, node);
    if (std::abs(kernels::dot(c.up, c.target - c.eye)) > 1 - 0x1p-20)
      node.fail("its camera has no upward direction");
    const std::string type = o.text("type").value_or("");
    const auto shape = type == "perspective" || type == "orthographic" ? o.object(type) : std::nullopt;
    if (!shape) o.fail("it must be a perspective or an orthographic camera, with its numbers");
    const auto positive = [&](const char* key) {
      const auto v = shape->number(key);
      if (!v || !(*v > 0)) shape->fail(fmt::format("\"{}\" must be there, and above 0", key));
      return *v;
    };
    const bool perspective = type == "perspective";
    c.near_z = perspective ? positive("znear") : shape->number("znear", 0);
    c.far_z = perspective && !shape->has("zfar") ? std::numeric_limits<double>::infinity() : positive("zfar");
    if (!(c.far_z > c.near_z) || c.near_z < 0) shape->fail("zfar must lie behind znear");
    if (perspective) {
      c.fov_y = positive("yfov");
      if (!(c.fov_y < std::numbers::pi)) shape->fail_at("yfov", "an angle of view is below pi");
    } else {
      c.height = 2 * positive("ymag");
      // Ours has its near plane in front of the eye; what lies between is as good as nothing.
      if (c.near_z == 0) c.near_z = c.far_z * 1e-6;
      notes_.add(o.path(), "is orthographic: only project.orthographic shows it so");
    }
    out_.cameras.push_back({node.text("name").value_or(""), o.text("name").value_or(""), c});
  }

  static void read_cone(const Object& light, Light& l) {
    const auto spot = light.object("spot");
    if (!spot) light.fail("a spot has an object \"spot\"");
    l.inner = spot->number("innerConeAngle", 0);
    l.outer = spot->number("outerConeAngle", std::numbers::pi / 4);
    if (!(l.inner >= 0 && l.inner < l.outer && l.outer <= std::numbers::pi / 2))
      spot->fail("0 <= innerConeAngle < outerConeAngle <= pi / 2 must hold");
  }

  void add_light(const Object& node, const Placement& world) {
    const auto extension = node.extension("KHR_lights_punctual");
    if (!extension) return;
    const auto at = extension->index("light", "lights", lights_.size());
    if (!at) extension->fail("there is no \"light\"");
    const Object& o = lights_[*at];
    const std::string type = o.text("type").value_or("");
    const bool directional = type == "directional";
    if (!directional && type != "point" && type != "spot")
      o.fail("its type must be directional, point or spot");
    const auto color = o.numbers<3>("color").value_or(std::array{1.0, 1.0, 1.0});
    const double intensity = o.number("intensity", 1);
    for (const double v : {color[0], color[1], color[2], intensity})
      if (!(v >= 0)) o.fail("colour and intensity must not be negative");
    if (!directional && o.has("range")) notes_.add(o.path(), "has a range: it shines on beyond");
    Light l{.kind = directional      ? Light::Kind::directional
                    : type == "spot" ? Light::Kind::spot
                                     : Light::Kind::point,
            .color = glm::dvec3(color[0], color[1], color[2]) * (intensity / std::numbers::pi)};
    if (!std::isfinite(l.color.x + l.color.y + l.color.z))
      o.fail("colour times intensity is larger than any number");
    if (l.kind == Light::Kind::spot) read_cone(o, l);
    if (l.kind != Light::Kind::point) l.direction = -axis(world, 2, node);
    if (!directional) l.position = world.translation, l.attenuation = {0, 0, 1};
    out_.lights.push_back(l);
  }

  const Object& document_;
  Notes& notes_;
  std::vector<Object> nodes_, cameras_, lights_;
  std::size_t meshes_, skins_;
  std::vector<State> state_;
  Flattened out_;
};

}  // namespace

Flattened flatten(const Object& document, Notes& notes) { return Walker(document, notes).run(); }

}  // namespace frustum::gltf
