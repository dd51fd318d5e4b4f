// Meshes for tests: any triangles, and a closed torus of any size.
#pragma once

#include "runtime/buffers/mesh.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <vector>

namespace frustum::test {

template <class Point>
Mesh mesh_of(const std::vector<Point>& position, const std::vector<glm::uvec3>& triangle, Space space) {
  Mesh m;
  m.columns = {Column::make<glm::uvec3>("triangle", Domain::face, triangle),
               Column::make<Point>("position", Domain::vertex, position, space)};
  return m;
}

inline Ref<Mesh> shared(Mesh m) { return std::make_shared<const Mesh>(std::move(m)); }

template <class T>
std::vector<T> column(const Mesh& m, std::string_view name) {
  const auto values = m.at(name).values<T>();
  return {values.begin(), values.end()};
}

// Equal bytes in every column; NaN equals itself.
inline bool same_bytes(const Mesh& a, const Mesh& b) {
  if (a.columns.size() != b.columns.size()) return false;
  for (const auto& c : a.columns) {
    const Column* other = b.find(c->name());
    if (other == nullptr || other->bytes() != c->bytes() || other->space() != c->space() ||
        std::memcmp(other->data(), c->data(), c->bytes()) != 0)
      return false;
  }
  return true;
}

// 2 rings sides triangles around the y axis, radii 1 and 0.4, fronts outside; columns normal and uv.
inline Mesh torus(std::uint32_t rings, std::uint32_t sides, Space space = Space::world) {
  std::vector<glm::vec3> position, normal;
  std::vector<glm::vec2> uv;
  std::vector<glm::uvec3> triangle;
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const double u = 2 * std::numbers::pi * i / rings, v = 2 * std::numbers::pi * j / sides;
      const glm::dvec3 n(std::cos(u) * std::cos(v), std::sin(v), std::sin(u) * std::cos(v));
      position.emplace_back(glm::dvec3(std::cos(u), 0, std::sin(u)) + 0.4 * n);
      normal.emplace_back(n);
      uv.emplace_back(static_cast<float>(i) / static_cast<float>(rings),
                      static_cast<float>(j) / static_cast<float>(sides));
      const std::uint32_t i1 = (i + 1) % rings, j1 = (j + 1) % sides;
      const std::uint32_t a = i * sides + j, b = i1 * sides + j, c = i1 * sides + j1, d = i * sides + j1;
      triangle.emplace_back(a, c, b);
      triangle.emplace_back(a, d, c);
    }
  Mesh m = mesh_of(position, triangle, space);
  m.columns.push_back(Column::make<glm::vec3>("normal", Domain::vertex, normal, Space::world));
  m.columns.push_back(Column::make<glm::vec2>("uv", Domain::vertex, uv));
  m.closed = true;
  return m;
}

}  // namespace frustum::test
