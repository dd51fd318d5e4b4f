#include "nodes/clip/homogeneous.h"

#include "nodes/clip.h"
#include "nodes/kernels/vector.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <nlohmann/json.hpp>

#include <limits>
#include <map>

namespace frustum {
namespace {

using Points = std::vector<glm::vec4>;

Ref<Mesh> clip(const Ref<Mesh>& m, const Json& params = Json::object(), Context* ctx = nullptr) {
  return test::run_node(nodes::clip_homogeneous(), params, {{m}}, ctx).at(0).as<Mesh>();
}
Ref<Mesh> mesh(const Points& p, const std::vector<glm::uvec3>& t) {
  return test::shared(test::mesh_of(p, t, Space::clip));
}

// One inside, one cut at x = w, one outside; every kind of column.
Mesh three_faces() {
  Mesh m = test::mesh_of(
      Points{{-1, 0, 0, 1}, {0, 0, 0, 1}, {0, 1, 0, 1}, {3, 0, 0, 1}, {5, 0, 0, 1}, {5, 1, 0, 1}},
      {{0, 1, 2}, {1, 3, 2}, {3, 4, 5}}, Space::clip);
  m.columns.push_back(Column::make<glm::vec2>(
      "uv", Domain::vertex, std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}, {4, 3}, {6, 0}, {6, 1}}));
  m.columns.push_back(
      Column::make<float>("heat", Domain::corner, std::vector<float>{1, 2, 3, 10, 20, 30, 7, 8, 9}));
  m.columns.push_back(
      Column::make<std::uint32_t>("material", Domain::face, std::vector<std::uint32_t>{5, 6, 7}));
  m.columns.push_back(
      Column::make<std::uint32_t>("part", Domain::vertex, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
  auto materials = std::make_shared<MaterialSet>();
  materials->materials.resize(8);
  m.materials = std::move(materials);
  m.closed = true;
  return m;
}

TEST(ClipHomogeneous, CutsByHandAndCarriesEveryColumn) {
  Context ctx;
  const auto out = clip(test::shared(three_faces()), Json::object(), &ctx);
  EXPECT_EQ(out->validate(), "");
  // Edge 1-3 leaves at x = 1, a third of the way, and edge 3-2 comes back there, two thirds of the way.
  EXPECT_EQ(test::column<glm::uvec3>(*out, "triangle"),
            (std::vector<glm::uvec3>{{0, 1, 2}, {1, 6, 7}, {1, 7, 2}}));
  const auto p = test::column<glm::vec4>(*out, "position");
  EXPECT_EQ(p[6], glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(p[7], glm::vec4(1, static_cast<float>(2.0 / 3), 0, 1));
  const auto uv = test::column<glm::vec2>(*out, "uv");
  EXPECT_EQ(uv[6], glm::vec2(2, 1));
  EXPECT_EQ(uv[7], glm::vec2(static_cast<float>(4.0 / 3), static_cast<float>(5.0 / 3)));
  EXPECT_EQ(test::column<std::uint32_t>(*out, "origin"), (std::vector<std::uint32_t>{0, 1, 1}));
  EXPECT_EQ(test::column<std::uint32_t>(*out, "material"), (std::vector<std::uint32_t>{5, 6, 6}));
  const auto heat = test::column<float>(*out, "heat");
  const auto third = [](double a, double b) { return static_cast<float>(a + (b - a) / 3); };
  EXPECT_EQ(heat, (std::vector<float>{1, 2, 3, 10, third(10, 20), third(30, 20), 10, third(30, 20), 30}));
  EXPECT_EQ(test::column<std::uint32_t>(*out, "part")[7], 2U);  // whole numbers come from the nearest corner
  EXPECT_EQ(out->closed, false);
  EXPECT_TRUE(ctx.warnings().empty());
}

TEST(ClipHomogeneous, ReturnsTheSameMeshWhenNothingIsOutside) {
  const auto inside = mesh({{-1, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}}, {{0, 1, 2}});
  EXPECT_EQ(clip(inside), inside);
  const auto empty = mesh({}, {});
  EXPECT_EQ(clip(empty), empty);
}

TEST(ClipHomogeneous, SharesVertexColumnsWhenFacesOnlyGo) {
  const auto m = mesh({{0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}, {2, 0, 0, 1}, {3, 0, 0, 1}, {3, 1, 0, 1}},
                      {{3, 4, 5}, {0, 1, 2}});
  const auto out = clip(m);
  EXPECT_EQ(out->at("position").data(), m->at("position").data());
  EXPECT_EQ(test::column<std::uint32_t>(*out, "origin"), (std::vector<std::uint32_t>{1}));
}

// A torus around the camera: many faces cut by every plane.
Ref<Mesh> torus_across_the_volume() {
  const Mesh torus = test::torus(60, 40);
  Points p;
  for (const auto& q : test::column<glm::vec3>(torus, "position"))
    p.emplace_back(q.x * 0.6F, q.y * 1.5F, q.z, q.z + 0.8F);
  return test::shared(torus.with(Column::make<glm::vec4>("position", Domain::vertex, p, Space::clip)));
}

TEST(ClipHomogeneous, LeavesOnlyPointsInsideAndIsIdempotent) {
  const auto once = clip(torus_across_the_volume());
  EXPECT_GT(once->faces(), 100U);
  const auto p = test::column<glm::vec4>(*once, "position");
  for (const auto& t : test::column<glm::uvec3>(*once, "triangle"))
    for (glm::length_t k = 0; k < 3; ++k) {
      EXPECT_EQ(kernels::volume_outcode({}, 1.0F, p[t[k]]), 0);
      EXPECT_GT(p[t[k]].w, 0);
    }
  const auto twice = clip(once);
  EXPECT_EQ(test::column<glm::uvec3>(*twice, "triangle"), test::column<glm::uvec3>(*once, "triangle"));
  EXPECT_TRUE(test::same_bytes(*once, *twice));
}

// No cracks: every edge inside the volume has its other half, by position.
TEST(ClipHomogeneous, KeepsClosedMeshesClosedInsideTheVolume) {
  const auto out = clip(torus_across_the_volume());
  const auto p = test::column<glm::vec4>(*out, "position");
  using Key = std::array<float, 4>;
  std::map<std::pair<Key, Key>, int> balance;
  const auto key = [&](std::uint32_t i) { return Key{p[i].x, p[i].y, p[i].z, p[i].w}; };
  const auto on_side = [&](std::uint32_t i, std::uint32_t j) {
    const auto side = [&](auto f) { return f(p[i]) == 0 && f(p[j]) == 0; };
    return side([](const glm::vec4& v) { return v.x - v.w; }) ||
           side([](const glm::vec4& v) { return v.x + v.w; }) ||
           side([](const glm::vec4& v) { return v.y - v.w; }) ||
           side([](const glm::vec4& v) { return v.y + v.w; }) ||
           side([](const glm::vec4& v) { return v.z - v.w; }) ||
           side([](const glm::vec4& v) { return v.z + v.w; });
  };
  for (const auto& t : test::column<glm::uvec3>(*out, "triangle"))
    for (glm::length_t k = 0; k < 3; ++k) {
      const std::uint32_t i = t[k], j = t[(k + 1) % 3];
      if (on_side(i, j) || key(i) == key(j)) continue;
      if (key(i) < key(j))
        ++balance[{key(i), key(j)}];
      else
        --balance[{key(j), key(i)}];
    }
  EXPECT_GT(balance.size(), 1000U);
  for (const auto& [edge, sum] : balance) EXPECT_EQ(sum, 0);
}

TEST(ClipHomogeneous, GivesTheSameBytesForAnyNumberOfThreads) {
  const auto m = torus_across_the_volume();
  Ref<Mesh> first;
  for (const std::size_t threads : {1U, 2U, 7U}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const auto out = clip(m);
    if (!first) first = out;
    EXPECT_TRUE(test::same_bytes(*first, *out));
  }
}

TEST(ClipHomogeneous, CutsLessWithAGuardBandAndNearOnly) {
  const auto m = torus_across_the_volume();
  const auto cuts = [&m](const Json& params) {
    Context ctx;
    const auto out = clip(m, params, &ctx);
    for (const auto& t : out->triangles())
      for (glm::length_t k = 0; k < 3; ++k) {
        const auto q = out->at("position").values<glm::vec4>()[t[k]];
        EXPECT_GE(q.z + q.w, 0) << "the near plane always cuts";
      }
    for (const auto& [name, n] : ctx.counters())
      if (name == "triangles_cut") return n;
    return std::uint64_t{0};
  };
  const auto all = cuts(Json::object()), guarded = cuts({{"guard_band", 1.5}}),
             near_only = cuts({{"planes", "near"}});
  EXPECT_LT(guarded, all);
  EXPECT_LE(near_only, guarded);
  EXPECT_GT(near_only, 0U);
  EXPECT_THROW(clip(m, {{"guard_band", 0.5}}), std::runtime_error);
  EXPECT_THROW(clip(m, {{"gaurd_band", 2}}), std::runtime_error);
}

TEST(ClipHomogeneous, FollowsTheCamerasDepthConvention) {
  auto camera = std::make_shared<Camera>();
  camera->reversed_z = true;
  Mesh m = test::mesh_of(Points{{0, 0, -0.5F, 1},
                                {1, 0, -0.5F, 1},
                                {0, 1, -0.5F, 1},
                                {0, 0, 0.5F, 1},
                                {1, 0, 0.5F, 1},
                                {0, 1, 0.5F, 1}},
                         {{0, 1, 2}, {3, 4, 5}}, Space::clip);
  EXPECT_EQ(clip(test::shared(m))->faces(), 2U);
  m.camera = camera;
  EXPECT_EQ(clip(test::shared(m))->faces(), 1U);  // z < 0 is beyond the far plane
}

TEST(ClipHomogeneous, DropsFacesThatAreNotFiniteAndSaysSo) {
  const float inf = std::numeric_limits<float>::infinity();
  Context ctx;
  const auto out = clip(mesh({{0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}, {inf, 0, 0, 1}, {NAN, 0, 0, 1}},
                             {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}),
                        Json::object(), &ctx);
  EXPECT_EQ(out->faces(), 1U);
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "undefined_positions");
  EXPECT_EQ(clip(mesh({{0, 0, 0, -1}, {1, 0, 0, -1}, {0, 1, 0, -1}}, {{0, 1, 2}}))->faces(),
            0U);  // all behind the eye
}

TEST(ClipHomogeneous, WorksInDouble) {
  Context ctx;
  ctx.precision = Precision::real_double;
  const auto out = clip(test::shared(three_faces()), Json::object(), &ctx);
  EXPECT_EQ(out->validate(), "");
  EXPECT_EQ(test::column<glm::dvec4>(*out, "position")[6], glm::dvec4(1, 0, 0, 1));
}

}  // namespace
}  // namespace frustum
