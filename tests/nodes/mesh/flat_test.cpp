#include "nodes/mesh/flat.h"

#include "nodes/clip.h"
#include "nodes/mesh.h"
#include "nodes/project.h"
#include "runtime/buffers/camera.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <set>

namespace frustum {
namespace {

Buffer camera(Conventions conventions) {
  return Buffer(std::make_shared<const Camera>(Camera{.conventions = conventions}));
}

// Two faces of four vertices; heat of vertices, colours of corners, and whole numbers.
Mesh two_faces() {
  Mesh m = test::mesh_of(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                         {{0, 1, 2}, {2, 1, 3}}, Space::world);
  m.columns.push_back(Column::make<float>("heat", Domain::vertex, std::vector<float>{10, 11, 12, -0.0F}));
  m.columns.push_back(Column::make<glm::vec2>(
      "uv", Domain::corner, std::vector<glm::vec2>{{0, 1}, {2, 3}, {4, 5}, {6, 7}, {8, 9}, {NAN, 1}}));
  m.columns.push_back(
      Column::make<std::uint32_t>("bone", Domain::vertex, std::vector<std::uint32_t>{5, 6, 7, 8}));
  return m;
}

Ref<Mesh> flat(const Mesh& m, const Json& params, const std::vector<Buffer>& camera = {}) {
  return test::run_node(nodes::mesh_flat(), params, {{test::shared(m)}, camera}).at(0).as<Mesh>();
}
std::string error(const Mesh& m, const Json& params) {
  return test::run_error(nodes::mesh_flat(), params, {{test::shared(m)}, {}}).first;
}

TEST(MeshFlat, TakesTheProvokingCornersBits) {
  const auto first = flat(two_faces(), {{"provoking", "first"}}),
             last = flat(two_faces(), {{"provoking", "last"}});
  EXPECT_EQ(first->at("heat").domain(), Domain::face);
  EXPECT_EQ(test::column<float>(*first, "heat"), (std::vector<float>{10, 12}));
  EXPECT_EQ(test::column<glm::vec2>(*first, "uv"),
            (std::vector<glm::vec2>{{0, 1}, {0, 1}, {0, 1}, {6, 7}, {6, 7}, {6, 7}}));
  EXPECT_EQ(first->at("uv").domain(), Domain::corner);
  EXPECT_EQ(test::column<float>(*last, "heat")[0], 12);
  EXPECT_TRUE(std::signbit(test::column<float>(*last, "heat")[1]));
  EXPECT_EQ(test::column<glm::vec2>(*last, "uv")[0], glm::vec2(4, 5));
  EXPECT_TRUE(std::isnan(test::column<glm::vec2>(*last, "uv")[4].x));
  EXPECT_EQ(first->at("bone").domain(), Domain::vertex);
  EXPECT_EQ(first->at("position").domain(), Domain::vertex);
  EXPECT_EQ(first->validate(), "");
}

// OpenGL: the last vertex unless asked otherwise; Vulkan and Direct3D: the first.
TEST(MeshFlat, FollowsTheCamerasConventions) {
  EXPECT_EQ(test::column<float>(*flat(two_faces(), Json::object(), {camera(Conventions::gl)}), "heat")[0],
            12);
  EXPECT_EQ(test::column<float>(*flat(two_faces(), Json::object(), {camera(Conventions::vulkan)}), "heat")[0],
            10);
  EXPECT_EQ(test::column<float>(*flat(two_faces(), Json::object(), {camera(Conventions::d3d)}), "heat")[0],
            10);
  Mesh seen = two_faces();
  seen.camera = camera(Conventions::vulkan).as<Camera>();
  EXPECT_EQ(test::column<float>(*flat(seen, Json::object()), "heat")[0], 10);
  EXPECT_EQ(test::column<float>(*flat(seen, Json::object(), {camera(Conventions::gl)}), "heat")[0], 12);
  EXPECT_EQ(error(two_faces(), Json::object()), "missing_camera");
}

TEST(MeshFlat, TakesTheColumnsNamed) {
  const auto some = flat(two_faces(), {{"columns", {"bone"}}, {"provoking", "last"}});
  EXPECT_EQ(test::column<std::uint32_t>(*some, "bone"), (std::vector<std::uint32_t>{7, 8}));
  EXPECT_EQ(some->at("heat").domain(), Domain::vertex);
  EXPECT_EQ(error(two_faces(), {{"columns", {"heath"}}, {"provoking", "last"}}), "missing_column");
  EXPECT_EQ(error(two_faces(), {{"columns", {"position"}}, {"provoking", "last"}}), "wrong_column");
  const auto twice = flat(*some, {{"columns", {"bone"}}, {"provoking", "first"}});
  EXPECT_EQ(test::column<std::uint32_t>(*twice, "bone"), (std::vector<std::uint32_t>{7, 8}));
}

// OpenGL 4.6, 13.6 and Vulkan, Flat Shading: clipping makes new corners, and never another provoking value.
TEST(MeshFlat, ValuesOutliveClipping) {
  Mesh m = test::torus(24, 12);
  std::vector<float> heat;
  for (std::size_t v = 0; v < m.vertices(); ++v) heat.push_back(static_cast<float>(v) + 0.25F);
  m.columns.push_back(Column::make<float>("heat", Domain::vertex, heat));
  auto c = std::make_shared<Camera>();
  c->eye = {0.3, 0.4, 1.2}, c->near_z = 0.4, c->fov_y = 0.9, c->conventions = Conventions::vulkan;
  const Buffer eye(Ref<Camera>(std::move(c)));
  const Buffer flat = test::run_node(nodes::mesh_flat(), Json::object(), {{test::shared(m)}, {eye}}).at(0);
  const Buffer view = test::run_node(nodes::project_view(), Json::object(), {{flat}, {eye}}).at(0);
  const Buffer clip = test::run_node(nodes::project_perspective(), Json::object(), {{view}, {eye}}).at(0);
  const auto cut = test::run_node(nodes::clip_homogeneous(), Json::object(), {{clip}}).at(0).as<Mesh>();
  const auto origin = test::column<std::uint32_t>(*cut, "origin");
  const auto got = test::column<float>(*cut, "heat");
  ASSERT_EQ(got.size(), cut->faces());
  const auto normal = test::column<glm::vec3>(*cut, "normal"),
             normal_before = test::column<glm::vec3>(m, "normal");
  for (std::size_t f = 0; f < got.size(); ++f) {
    EXPECT_EQ(got[f], heat[m.triangles()[origin[f]].x]);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(normal[3 * f + k], normal_before[m.triangles()[origin[f]].x]);
  }
  EXPECT_EQ(cut->validate(), "");
  EXPECT_LT(std::set(origin.begin(), origin.end()).size(), origin.size());  // some were cut in pieces
}

}  // namespace
}  // namespace frustum
