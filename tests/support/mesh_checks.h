// What a well-made closed mesh holds, for the tests of what makes meshes.
#pragma once

#include "nodes/mesh.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/value.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>

namespace frustum::test {

// A row of mesh.statistics. Without joining: the mesh's own vertices.
inline double statistic(const Ref<Mesh>& mesh, const std::string& quantity, bool join = false) {
  const auto table = run_node(nodes::mesh_statistics(), {{"join", join}}, {{mesh}}).at(0).as<Table>();
  for (std::size_t i = 0; i < table->rows(); ++i)
    if (table->columns[0].texts[i] == quantity) return table->columns[1].numbers[i];
  ADD_FAILURE() << "no quantity " << quantity;
  return 0;
}

// Column "normal" (vertex or corner) at corner c of face f.
inline glm::dvec3 normal_at(const Mesh& mesh, std::size_t f, std::size_t c) {
  const Column& n = mesh.at("normal");
  const std::size_t row =
      n.domain() == Domain::corner ? 3 * f + c : mesh.triangles()[f][static_cast<glm::length_t>(c)];
  return {n.number(row, 0), n.number(row, 1), n.number(row, 2)};
}

inline glm::dvec3 position_at(const Mesh& mesh, std::size_t vertex) {
  const Column& p = mesh.at("position");
  return {p.number(vertex, 0), p.number(vertex, 1), p.number(vertex, 2)};
}

// The cross product of a face's edges.
inline glm::dvec3 area_vector(const Mesh& mesh, std::size_t f) {
  const glm::uvec3& t = mesh.triangles()[f];
  const glm::dvec3 a = position_at(mesh, t.x), u = position_at(mesh, t.y) - a, v = position_at(mesh, t.z) - a;
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

// Every face has an area and shows its front where its normals point; normals are of unit length; u x v turns
// like the face, so that textures are not mirrored.
inline void expect_consistent(const Mesh& mesh) {
  EXPECT_EQ(mesh.validate(), "");
  const Column* uv = mesh.find("uv");
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const glm::dvec3 across = area_vector(mesh, f);
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::dvec3 n = normal_at(mesh, f, c);
      ASSERT_GT(n.x * across.x + n.y * across.y + n.z * across.z, 0) << "face " << f;
      ASSERT_NEAR(n.x * n.x + n.y * n.y + n.z * n.z, 1, 4e-7) << "face " << f;
    }
    if (uv == nullptr) continue;
    const auto at = [&](std::size_t c, int k) {
      return uv->number(
          uv->domain() == Domain::corner ? 3 * f + c : mesh.triangles()[f][static_cast<glm::length_t>(c)], k);
    };
    ASSERT_GT((at(1, 0) - at(0, 0)) * (at(2, 1) - at(0, 1)) - (at(2, 0) - at(0, 0)) * (at(1, 1) - at(0, 1)),
              0)
        << "face " << f;
  }
}

}  // namespace frustum::test
