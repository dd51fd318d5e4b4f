#include "nodes/cull/backface.h"

#include "nodes/cull.h"
#include "nodes/kernels/camera.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

namespace frustum {
namespace {

Ref<Mesh> culled(const Ref<Mesh>& m, const Json& params = Json::object(), Context* ctx = nullptr) {
  return test::run_node(nodes::cull_backface(), params, {{m}}, ctx).at(0).as<Mesh>();
}

template <class Point>
std::vector<std::uint32_t> fronts(const std::vector<Point>& p, Space space,
                                  const Json& params = Json::object()) {
  // Face 0 counter-clockwise, face 1 clockwise, face 2 edge-on or degenerate.
  const auto out = culled(test::shared(test::mesh_of(p, {{0, 1, 2}, {0, 2, 1}, {0, 1, 1}}, space)), params);
  return test::column<std::uint32_t>(*out, "origin");
}

TEST(CullBackface, KeepsCounterClockwiseFacesInEverySpace) {
  const std::vector<std::uint32_t> first = {0}, second = {1};
  EXPECT_EQ(fronts<glm::vec3>({{0, 0, -2}, {1, 0, -2}, {0, 1, -2}}, Space::eye), first);
  EXPECT_EQ(fronts<glm::vec3>({{0, 0, -2}, {1, 0, -2}, {0, 1, -2}}, Space::eye, {{"drop", "front"}}), second);
  EXPECT_EQ(
      fronts<glm::vec3>({{0, 0, -2}, {1, 0, -2}, {0, 1, -2}}, Space::eye, {{"projection", "orthographic"}}),
      first);
  EXPECT_EQ(fronts<glm::vec4>({{0, 0, 0, 2}, {1, 0, 0, 2}, {0, 1, 0, 2}}, Space::clip), first);
  EXPECT_EQ(fronts<glm::vec3>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, Space::ndc), first);
  EXPECT_EQ(fronts<glm::vec4>({{0, 0, 0, 1}, {9, 0, 0, 1}, {0, 9, 0, 1}}, Space::screen), second);  // y down
  EXPECT_EQ(fronts<glm::vec4>({{0, 9, 0, 1}, {9, 9, 0, 1}, {0, 0, 0, 1}}, Space::screen), first);
}

TEST(CullBackface, TwoSidedMaterialsStay) {
  auto m = std::make_shared<Mesh>(test::mesh_of<glm::vec3>({{0, 0, -2}, {1, 0, -2}, {0, 1, -2}},
                                                           {{0, 2, 1}, {0, 1, 2}, {0, 2, 1}}, Space::eye));
  const std::uint32_t material[] = {1, 0, 0};
  m->columns.push_back(Column::make<std::uint32_t>("material", Domain::face, material));
  auto set = std::make_shared<MaterialSet>();
  set->materials = {Material{}, Material{.two_sided = true}};
  m->materials = set;
  const Ref<Mesh> mesh = m;
  EXPECT_EQ(test::column<std::uint32_t>(*culled(mesh), "origin"), (std::vector<std::uint32_t>{0, 1}));
  const auto with = [&](bool two_sided) {
    const Ref<Material> one = std::make_shared<const Material>(Material{.two_sided = two_sided});
    const test::NodeInputs in = {{mesh}, {one}};
    return test::run_node(nodes::cull_backface(), Json::object(), in).at(0).as<Mesh>();
  };
  EXPECT_EQ(test::column<std::uint32_t>(*with(false), "origin"), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(with(true)->faces(), 3u);
}

// E23: the sign of n_z is wrong in perspective off the axis, where the plane test is right.
TEST(CullBackface, SeesPerspectiveFromTheEyeAndNotAlongTheAxis) {
  // Far to the left, faces whose normals are (0.5, 0, -0.1) and its opposite: the eye is on the side of the first, although
  // the second has the positive n_z.
  const std::vector<glm::vec3> p = {{-5, 0, -1}, {-5.1F, 0, -1.5F}, {-5, 1, -1}};
  const auto m = test::shared(test::mesh_of(p, {{0, 1, 2}, {0, 2, 1}}, Space::eye));
  const auto perspective = test::column<std::uint32_t>(*culled(m), "origin");
  const auto parallel = test::column<std::uint32_t>(*culled(m, {{"projection", "orthographic"}}), "origin");
  EXPECT_EQ(perspective, (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(parallel, (std::vector<std::uint32_t>{1}));
}

// Row 38 and 39: eye space and clip space agree on every face of a torus, and on half of a closed one.
TEST(CullBackface, AgreesBetweenSpaces) {
  const Mesh torus = test::torus(64, 48);
  const auto view = kernels::look_at({2, 1.5, 2.5}, {0, 0, 0}, {0, 1, 0}).eye_from_world;
  const auto volume = kernels::perspective(0.8, 1, 0.1, 100);
  std::vector<glm::vec3> eye;
  std::vector<glm::vec4> clip;
  for (const auto& p : test::column<glm::vec3>(torus, "position")) {
    eye.push_back(kernels::PointMap<float>(view)(p));
    clip.push_back(kernels::ClipMap<float>(volume)(eye.back()));
  }
  const auto in_eye =
      culled(test::shared(torus.with(Column::make<glm::vec3>("position", Domain::vertex, eye, Space::eye))));
  const auto in_clip = culled(
      test::shared(torus.with(Column::make<glm::vec4>("position", Domain::vertex, clip, Space::clip))));
  const auto a = test::column<std::uint32_t>(*in_eye, "origin"),
             b = test::column<std::uint32_t>(*in_clip, "origin");
  std::vector<std::uint32_t> differ;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(differ));
  EXPECT_LE(differ.size(), 4U);  // rounding of the projection may turn faces that are all but edge-on
  EXPECT_GT(a.size(), torus.faces() / 3);
  EXPECT_LT(a.size(), torus.faces() * 2 / 3);
}

// CLP-10: the eye within an ulp of the face's plane at coordinates of 1e7.
TEST(CullBackface, HasTheExactSignNextToEdgeOn) {
  test::Random random(1);
  __extension__ using quad = __float128;
  int naive_wrong = 0, edge_on = 0;
  for (int i = 0; i < 20000; ++i) {
    // Two rows of 24-bit integers and a combination of them, off by at most one unit in one place: 72 bits exactly.
    const auto component = [&random] {
      return static_cast<float>(static_cast<int>(random.below(1 << 12)) - (1 << 11));
    };
    glm::vec3 a(component(), component(), component()), b(component(), component(), component());
    const float s = static_cast<float>(random.below(1 << 10)), t = static_cast<float>(random.below(1 << 10));
    glm::vec3 c = a * s + b * t;
    c[i % 3] += static_cast<float>(static_cast<int>(random.below(3)) - 1);
    const auto q = [](float v) { return static_cast<quad>(v); };
    const quad det = q(a.x) * (q(b.y) * q(c.z) - q(b.z) * q(c.y)) +
                     q(a.y) * (q(b.z) * q(c.x) - q(b.x) * q(c.z)) +
                     q(a.z) * (q(b.x) * q(c.y) - q(b.y) * q(c.x));
    const auto m = test::shared(test::mesh_of(std::vector<glm::vec3>{a, b, c}, {{0, 1, 2}}, Space::eye));
    EXPECT_EQ(culled(m)->faces(), det < 0 ? 1U : 0U);  // (x, y, -z): the sign turns
    EXPECT_EQ(culled(m, {{"drop", "front"}})->faces(), det > 0 ? 1U : 0U);
    edge_on += det == 0 ? 1 : 0;
    const float naive =
        a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
    naive_wrong += (naive > 0) != (det > 0) || (naive < 0) != (det < 0) ? 1 : 0;
  }
  EXPECT_GT(edge_on, 100);
  EXPECT_GT(naive_wrong, 100);
}

TEST(CullBackface, DropsWhatIsNotFiniteAndKeepsEmptyMeshes) {
  const auto bad = test::shared(test::mesh_of(
      std::vector<glm::vec4>{{NAN, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}}, {{0, 1, 2}}, Space::clip));
  EXPECT_EQ(culled(bad)->faces(), 0U);
  const auto empty = test::shared(test::mesh_of(std::vector<glm::vec4>{}, {}, Space::clip));
  EXPECT_EQ(culled(empty), empty);
  EXPECT_THROW(culled(empty, {{"drop", "bakc"}}), std::runtime_error);
}

}  // namespace
}  // namespace frustum
