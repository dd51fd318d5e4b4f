#include "nodes/cull/frustum.h"

#include "nodes/cull.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace frustum {
namespace {

using Points = std::vector<glm::vec4>;

Ref<Mesh> culled(const Ref<Mesh>& m, Context* ctx = nullptr) {
  return test::run_node(nodes::cull_frustum(), Json::object(), {{m}}, ctx).at(0).as<Mesh>();
}
Ref<Mesh> mesh(const Points& p, const std::vector<glm::uvec3>& t) {
  return test::shared(test::mesh_of(p, t, Space::clip));
}

TEST(CullFrustum, DropsWhatIsOutsideOneSideAndCutsNothing) {
  const auto m = mesh(
      {{-1, 0, 0, 1}, {3, 0, 0, 1}, {0, 1, 0, 1}, {2, 0, 0, 1}, {2, 1, 0, 1}, {0, 9, 0, 1}, {-9, 0, 0, 1}},
      {{0, 1, 2}, {1, 3, 4}, {1, 5, 6}});
  Context ctx;
  const auto out = culled(m, &ctx);
  // The last one misses the volume, but no one side has all of it: conservative.
  EXPECT_EQ(test::column<std::uint32_t>(*out, "origin"), (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(out->at("position").data(), m->at("position").data());
  EXPECT_EQ(ctx.counters().at(0).second, 1U);
}

// CLP-09: touching the volume within an ulp is not outside.
TEST(CullFrustum, KeepsFacesThatTouchTheVolume) {
  const float above = std::nextafter(1.0F, 2.0F);
  EXPECT_EQ(culled(mesh({{1, 0, 0, 1}, {2, 0, 0, 1}, {2, 1, 0, 1}}, {{0, 1, 2}}))->faces(), 1U);
  EXPECT_EQ(culled(mesh({{above, 0, 0, 1}, {2, 0, 0, 1}, {2, 1, 0, 1}}, {{0, 1, 2}}))->faces(), 0U);
}

// Row 37: it never drops a face that clipping would keep a part of.
TEST(CullFrustum, NeverDropsAFaceThatShows) {
  test::Random random(1);
  Points p;
  std::vector<glm::uvec3> t;
  for (std::uint32_t i = 0; i < 60000; ++i) {
    p.emplace_back(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3),
                   random.uniform(-1, 1.5));
    if (i % 3 == 2) t.emplace_back(i - 2, i - 1, i);
  }
  const auto m = mesh(p, t);
  const auto out = culled(m);
  const auto kept = test::column<std::uint32_t>(*out, "origin");
  std::vector<bool> is_kept(t.size());
  for (const auto f : kept) is_kept[f] = true;
  const auto planes = kernels::view_volume();
  std::size_t shown = 0;
  for (std::size_t f = 0; f < t.size(); ++f)
    if (kernels::clip_triangle(planes, 63, p[t[f].x], p[t[f].y], p[t[f].z]).size > 0) {
      ++shown;
      EXPECT_TRUE(is_kept[f]);
    }
  EXPECT_GT(shown, 1000U);
  EXPECT_LT(kept.size(), 3 * shown);
}

TEST(CullFrustum, ReturnsTheSameMeshWhenAllMayShow) {
  const auto m = mesh({{0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}}, {{0, 1, 2}});
  EXPECT_EQ(culled(m), m);
  const auto empty = mesh({}, {});
  EXPECT_EQ(culled(empty), empty);
  EXPECT_EQ(culled(mesh({{NAN, 0, 0, 1}, {NAN, 0, 0, 1}, {NAN, 1, 0, 1}}, {{0, 1, 2}}))->faces(), 0U);
}

}  // namespace
}  // namespace frustum
