// What hides a point from a light and what a ray meets, against exact signs; and that closed surfaces have no gaps.
#include "nodes/kernels/triangle_tree.h"
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/random.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace frustum {
namespace {

using glm::dvec3;
using kernels::TriangleTree, kernels::Sight, kernels::orientation, kernels::Ray, kernels::RayHit;

struct Soup {
  std::vector<dvec3> position;
  std::vector<glm::uvec3> triangle;
};

// Numbers with 20 bits, so that differences are exact and signs of volumes are those of the tests' own.
double coarse(std::mt19937& random) {
  return static_cast<double>(static_cast<int>(random() >> 12) - (1 << 19)) * 0x1p-19;
}
dvec3 place(std::mt19937& random) { return {coarse(random), coarse(random), coarse(random)}; }

Soup soup(std::mt19937& random, std::uint32_t triangles) {
  Soup s;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    for (int c = 0; c < 3; ++c) s.position.push_back(place(random));
    s.triangle.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  return s;
}

// By exact signs of volumes: the ends on different sides of the plane, and the way inside all three sides.
bool crosses_exactly(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& from, const dvec3& to) {
  if (orientation(a, b, c, from) * orientation(a, b, c, to) >= 0) return false;
  const int u = orientation(from, to, a, b), v = orientation(from, to, b, c), w = orientation(from, to, c, a);
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

TEST(TriangleTree, AgreeWithExactSignsWhateverTheTree) {
  std::mt19937 random(7);
  const Soup s = soup(random, 300);
  const TriangleTree all(s.position, s.triangle);
  std::uint32_t last = 0;
  int hidden = 0;
  for (int i = 0; i < 4000; ++i) {
    const dvec3 from = place(random) * 2.0, to = place(random) * 2.0;
    bool exact = false;
    for (const glm::uvec3& t : s.triangle)
      exact = exact || crosses_exactly(s.position[t.x], s.position[t.y], s.position[t.z], from, to);
    ASSERT_EQ(all.hide({from, to - from, true}, 0, last), exact) << i;
    hidden += exact;
  }
  EXPECT_GT(hidden, 1000);
  EXPECT_LT(hidden, 3900);
}

// Errata E45: what lies beyond a light hides nothing from it.
TEST(TriangleTree, WhatIsBehindTheLightDoesNotHideIt) {
  const std::vector<dvec3> p{{-1, 2, -1}, {1, 2, -1}, {0, 2, 1}};
  const std::vector<glm::uvec3> t{{0, 1, 2}};
  const TriangleTree one(p, t);
  std::uint32_t last = 0;
  EXPECT_FALSE(one.hide({dvec3(0), {0, 1, 0}, true}, 0, last)) << "a lamp before it";
  EXPECT_FALSE(one.hide({dvec3(0), {0, 2, 0}, true}, 0, last)) << "a lamp on it";
  EXPECT_TRUE(one.hide({dvec3(0), {0, 3, 0}, true}, 0, last)) << "a lamp behind it";
  EXPECT_TRUE(one.hide({dvec3(0), {0, 1, 0}, false}, 0, last)) << "the sun";
  EXPECT_FALSE(one.hide({dvec3(0), {0, -1, 0}, false}, 0, last)) << "the sun on the other side";
}

TEST(TriangleTree, AClosedSurfaceHidesItsInsideThroughEveryCornerAndSide) {
  const Mesh ring = test::torus(40, 24);
  const auto position = ring.at("position").values<glm::vec3>();
  const std::vector<dvec3> p(position.begin(), position.end());
  const TriangleTree all(p, ring.triangles());
  std::uint32_t last = 0;
  // From the ring's core through every corner, and through points of every side.
  const dvec3 inside(1, 0, 0);
  for (const glm::uvec3& t : ring.triangles())
    for (int c = 0; c < 3; ++c)
      for (const double share : {0.0, 0.5, 1.0 / 3, 0.9}) {
        const dvec3 at = p[t[c]] * (1 - share) + p[t[(c + 1) % 3]] * share;
        ASSERT_TRUE(all.hide({inside, (at - inside) * 1000.0, true}, 0, last));
        ASSERT_TRUE(all.hide({inside, at - inside, false}, 0, last));
      }
}

TEST(TriangleTree, APointLiesOnWhatItIsNoFartherFromThanItsSlack) {
  const std::vector<dvec3> p{{-1, 1e-6, -1}, {1, 1e-6, -1}, {0, 1e-6, 1}};
  const std::vector<glm::uvec3> t{{0, 1, 2}};
  const TriangleTree one(p, t);
  std::uint32_t last = 0;
  EXPECT_TRUE(one.hide({dvec3(0), {0, 1, 0}, false}, 0.9e-6, last));
  EXPECT_FALSE(one.hide({dvec3(0), {0, 1, 0}, false}, 1.1e-6, last));
}

TEST(TriangleTree, DegenerateInputHidesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::uint32_t last = 0;
  EXPECT_FALSE(TriangleTree().hide({dvec3(0), {0, 1, 0}, false}, 0, last));
  const std::vector<dvec3> p{{0, 1, 0},   {0, 1, 0},  {1, 1, 0}, {nan, 1, 0},
                             {-1, 1, -1}, {1, 1, -1}, {0, 1, 1}};
  const std::vector<glm::uvec3> t{{0, 1, 2}, {3, 4, 5}, {4, 5, 6}};
  const TriangleTree all(p, t);
  EXPECT_EQ(all.triangles(), 2u) << "one corner is no number";
  EXPECT_TRUE(all.hide({dvec3(0), {0, 1, 0}, false}, 0, last));
  EXPECT_FALSE(all.hide({{nan, 0, 0}, {0, 1, 0}, false}, 0, last));
  EXPECT_FALSE(all.hide({dvec3(0), {0, 0, 0}, true}, 0, last)) << "a point where the light is";
  EXPECT_FALSE(all.hide({dvec3(0), {0, nan, 0}, false}, 0, last));
}

// By the triangle's plane in long double: where from + t along meets it.
long double exact_t(const Soup& s, std::uint32_t f, const dvec3& from, const dvec3& along) {
  using V = glm::vec<3, long double>;
  const glm::uvec3 t = s.triangle[f];
  const V a(s.position[t.x]), b(s.position[t.y]), c(s.position[t.z]), n = glm::cross(b - a, c - a);
  return glm::dot(n, a - V(from)) / glm::dot(n, V(along));
}

// Against every triangle by exact signs of volumes, in trees over the triangles in five orders.
TEST(TriangleTree, MeetsTheNearestWhateverTheTree) {
  std::mt19937 random(11);
  Soup s = soup(random, 200);
  std::vector<std::uint32_t> name(s.triangle.size());
  for (std::uint32_t i = 0; i < name.size(); ++i) name[i] = i;
  const Soup first = s;
  const TriangleTree tree(s.position, s.triangle);
  std::vector<RayHit> hits;
  std::vector<Ray> rays;
  for (int i = 0; i < 3000; ++i) {
    const dvec3 from = place(random) * 2.0, along = place(random);
    rays.push_back({from, along});
    std::uint32_t nearest = RayHit{}.face;
    long double least = std::numeric_limits<long double>::infinity();
    for (std::uint32_t f = 0; f < s.triangle.size(); ++f) {
      const glm::uvec3 t = s.triangle[f];
      if (!crosses_exactly(s.position[t.x], s.position[t.y], s.position[t.z], from, from + along * 64.0))
        continue;
      if (const long double at = exact_t(s, f, from, along); at < least) least = at, nearest = f;
    }
    hits.push_back(tree.nearest(rays.back()));
    ASSERT_EQ(hits.back().face, nearest) << i;
    if (nearest == RayHit{}.face) continue;
    ASSERT_NEAR(hits.back().t, static_cast<double>(least), 1e-13) << i;
    const glm::uvec3 t = s.triangle[nearest];
    const double u = hits.back().u, v = hits.back().v;
    const dvec3 p = s.position[t.x] * (1 - u - v) + s.position[t.y] * u + s.position[t.z] * v;
    ASSERT_LT(glm::length(p - (from + along * hits.back().t)), 1e-13) << i;
  }
  for (int order = 0; order < 5; ++order) {
    std::shuffle(name.begin(), name.end(), random);
    for (std::size_t i = 0; i < name.size(); ++i) s.triangle[i] = first.triangle[name[i]];
    const TriangleTree other(s.position, s.triangle);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const RayHit hit = other.nearest(rays[i]);
      ASSERT_EQ(hit.t, hits[i].t);
      if (hits[i].face == RayHit{}.face) continue;
      ASSERT_EQ(name[hit.face], hits[i].face);
    }
  }
}

TEST(TriangleTree, TwoInOnePlaceAreMetAsTheFirst) {
  const std::vector<dvec3> p{{-1, -1, 0.3}, {1.1, -1, 0.3}, {0, 1.7, 0.3}};
  const std::vector<glm::uvec3> t{{0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}};
  const TriangleTree all(p, t);
  EXPECT_EQ(all.nearest({{0.1, 0.2, 5}, {0, 0.01, -1}}).face, 0u);
}

TEST(TriangleTree, RaysInsideAClosedSurfaceMeetItThroughEveryCornerAndSide) {
  const Mesh ring = test::torus(40, 24);
  const auto position = ring.at("position").values<glm::vec3>();
  const std::vector<dvec3> p(position.begin(), position.end());
  const TriangleTree all(p, ring.triangles());
  const dvec3 inside(1, 0, 0);
  for (const glm::uvec3& t : ring.triangles())
    for (int c = 0; c < 3; ++c)
      for (const double share : {0.0, 0.5, 1.0 / 3, 0.9}) {
        const dvec3 at = p[t[c]] * (1 - share) + p[t[(c + 1) % 3]] * share;
        // No farther than where it aims, unless it but touches there, as it can from within a bend.
        for (const double length : {1e-20, 1.0, 1e20}) {
          const RayHit hit = all.nearest({inside, (at - inside) * length});
          ASSERT_NE(hit.face, RayHit{}.face);
          ASSERT_GT(hit.t, 0);
          if (at.x > 1.001) {
            ASSERT_LE(hit.t * length, 1 + 1e-12);
          }
        }
      }
}

// A ray that starts on a face, rounded off it, does not meet it again.
TEST(TriangleTree, WhatARayStartsOnIsNotMet) {
  std::mt19937 random(5);
  const Soup s = soup(random, 100);
  const TriangleTree all(s.position, s.triangle);
  int again = 0;
  for (std::uint32_t f = 0; f < s.triangle.size(); ++f) {
    const glm::uvec3 t = s.triangle[f];
    const glm::vec3 on(s.position[t.x] * 0.3 + s.position[t.y] * 0.3 + s.position[t.z] * 0.4);
    const dvec3 normal = glm::cross(s.position[t.y] - s.position[t.x], s.position[t.z] - s.position[t.x]);
    for (const double side : {1.0, -1.0}) {
      again += all.nearest({dvec3(on), normal * side}).face == f;
      EXPECT_NE(all.nearest({dvec3(on), normal * side, 16 * 0x1p-24 * 1.8}).face, f) << f;
    }
  }
  EXPECT_GT(again, 20) << "without slack some do";
}

TEST(TriangleTree, RaysThatLeadNowhereMeetNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::vector<dvec3> p{{-1, 1, -1}, {1, 1, -1}, {0, 1, 1}, {0, 1, 0}, {0, 1, 0}, {1, 1, 0}};
  const std::vector<glm::uvec3> t{{0, 1, 2}, {3, 4, 5}};
  const TriangleTree all(p, t);
  const auto missed = RayHit{}.face;
  EXPECT_EQ(all.nearest({dvec3(0), {0, 1, 0}}).face, 0u);
  EXPECT_EQ(all.nearest({dvec3(0), {0, -1, 0}}).face, missed);
  EXPECT_EQ(all.nearest({{0, 1, 0}, {0, 1, 0}}).face, missed) << "it starts there";
  EXPECT_EQ(all.nearest({{-2, 1, 0}, {1, 0, 0}}).face, missed) << "edge-on";
  EXPECT_EQ(all.nearest({dvec3(0), {0, 0, 0}}).face, missed);
  EXPECT_EQ(all.nearest({dvec3(0), {0, nan, 0}}).face, missed);
  EXPECT_EQ(all.nearest({dvec3(0), {0, inf, 0}}).face, missed);
  EXPECT_EQ(all.nearest({{0, nan, 0}, {0, 1, 0}}).face, missed);
  EXPECT_EQ(TriangleTree().nearest({dvec3(0), {0, 1, 0}}).face, missed);
}

}  // namespace
}  // namespace frustum
