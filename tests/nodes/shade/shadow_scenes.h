// A floor seen from anywhere, with things above it: points by formula, shadows in closed form.
#pragma once

#include "nodes/light.h"
#include "nodes/shade.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/mesh.h"
#include "tests/support/meshes.h"
#include "tests/support/tiles.h"

#include <array>
#include <vector>

namespace frustum::test {

// The square |x|, |z| <= size of y = 0, up is its front, and a picture of it from above with edge x edge points.
struct Floor {
  double size = 4;
  int edge = 101;

  glm::dvec3 at(int x, int y) const {
    return {size * ((2 * x + 1.0) / edge - 1), 0, size * ((2 * y + 1.0) / edge - 1)};
  }
  static std::vector<glm::uvec3> faces() { return {{0, 1, 2}, {0, 2, 3}}; }
  std::vector<glm::vec3> corners() const {
    const auto s = static_cast<float>(size);
    return {{-s, 0, -s}, {-s, 0, s}, {s, 0, s}, {s, 0, -s}};
  }
  Ref<Mesh> mesh() const {
    Mesh m = mesh_of(corners(), faces(), Space::world);
    m.columns.push_back(Column::make<glm::vec3>("world", Domain::vertex, corners(), Space::world));
    return shared(m);
  }
  Ref<Image> points() const {
    Frame f{.window = {0, 0, edge, edge}, .planes = {{"id", PlaneKind::u32}}};
    for (const char* name : {"N.x", "N.y", "N.z", "P.x", "P.y", "P.z"}) f.planes.push_back({name});
    Raster r(f);
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x) {
        const glm::dvec3 p = at(x, y);
        r.view().row<std::uint32_t>(0, 0, y)[x] = p.z > p.x ? 0 : 1;
        r.view().row<float>(2, 0, y)[x] = 1;
        for (int k = 0; k < 3; ++k) r.view().row<float>(4 + k, 0, y)[x] = static_cast<float>(p[k]);
      }
    return std::make_shared<Image>(Image{r});
  }
  // The floor and more triangles, as what casts shadows.
  Ref<Mesh> with(const std::vector<glm::vec3>& more) const {
    std::vector<glm::vec3> p = corners();
    std::vector<glm::uvec3> t = faces();
    for (std::size_t i = 0; i + 2 < more.size(); i += 3) {
      const auto n = static_cast<std::uint32_t>(p.size());
      t.emplace_back(n, n + 1, n + 2);
      for (std::size_t c = 0; c < 3; ++c) p.push_back(more[i + c]);
    }
    return shared(mesh_of(p, t, Space::world));
  }
};

// Two triangles: x0 <= x <= x1, z0 <= z <= z1 at height y.
struct Plate {
  float x0, x1, z0, z1, y;
  std::vector<glm::vec3> triangles() const {
    return {{x0, y, z0}, {x0, y, z1}, {x1, y, z1}, {x0, y, z0}, {x1, y, z1}, {x1, y, z0}};
  }
  // How deep inside the plate's shadow a point of the floor lies; < 0: outside.
  double depth_in_shadow(const glm::dvec3& p, const glm::dvec3& to_light) const {
    const glm::dvec3 q = p + to_light * ((y - p.y) / to_light.y);
    return std::min({q.x - x0, x1 - q.x, q.z - z0, z1 - q.z});
  }
};

inline Buffer sun(const glm::dvec3& to_light) {
  const double length =
      std::sqrt(to_light.x * to_light.x + to_light.y * to_light.y + to_light.z * to_light.z);
  return one_light({.kind = Light::Kind::directional, .direction = -to_light / length});
}

}  // namespace frustum::test
