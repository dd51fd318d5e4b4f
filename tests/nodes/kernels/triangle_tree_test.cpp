// What hides a point from a light, against exact signs; and that closed surfaces have no gaps.
#include "nodes/kernels/occluders.h"
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/random.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace frustum {
namespace {

using glm::dvec3;
using kernels::Occluders, kernels::Sight, kernels::orientation;

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

TEST(Occluders, AgreeWithExactSignsWhateverTheTree) {
  std::mt19937 random(7);
  const Soup s = soup(random, 300);
  const Occluders all(s.position, s.triangle);
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
TEST(Occluders, WhatIsBehindTheLightDoesNotHideIt) {
  const std::vector<dvec3> p{{-1, 2, -1}, {1, 2, -1}, {0, 2, 1}};
  const std::vector<glm::uvec3> t{{0, 1, 2}};
  const Occluders one(p, t);
  std::uint32_t last = 0;
  EXPECT_FALSE(one.hide({dvec3(0), {0, 1, 0}, true}, 0, last)) << "a lamp before it";
  EXPECT_FALSE(one.hide({dvec3(0), {0, 2, 0}, true}, 0, last)) << "a lamp on it";
  EXPECT_TRUE(one.hide({dvec3(0), {0, 3, 0}, true}, 0, last)) << "a lamp behind it";
  EXPECT_TRUE(one.hide({dvec3(0), {0, 1, 0}, false}, 0, last)) << "the sun";
  EXPECT_FALSE(one.hide({dvec3(0), {0, -1, 0}, false}, 0, last)) << "the sun on the other side";
}

TEST(Occluders, AClosedSurfaceHidesItsInsideThroughEveryCornerAndSide) {
  const Mesh ring = test::torus(40, 24);
  const auto position = ring.at("position").values<glm::vec3>();
  const std::vector<dvec3> p(position.begin(), position.end());
  const Occluders all(p, ring.triangles());
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

TEST(Occluders, APointLiesOnWhatItIsNoFartherFromThanItsSlack) {
  const std::vector<dvec3> p{{-1, 1e-6, -1}, {1, 1e-6, -1}, {0, 1e-6, 1}};
  const std::vector<glm::uvec3> t{{0, 1, 2}};
  const Occluders one(p, t);
  std::uint32_t last = 0;
  EXPECT_TRUE(one.hide({dvec3(0), {0, 1, 0}, false}, 0.9e-6, last));
  EXPECT_FALSE(one.hide({dvec3(0), {0, 1, 0}, false}, 1.1e-6, last));
}

TEST(Occluders, DegenerateInputHidesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::uint32_t last = 0;
  EXPECT_FALSE(Occluders().hide({dvec3(0), {0, 1, 0}, false}, 0, last));
  const std::vector<dvec3> p{{0, 1, 0},   {0, 1, 0},  {1, 1, 0}, {nan, 1, 0},
                             {-1, 1, -1}, {1, 1, -1}, {0, 1, 1}};
  const std::vector<glm::uvec3> t{{0, 1, 2}, {3, 4, 5}, {4, 5, 6}};
  const Occluders all(p, t);
  EXPECT_EQ(all.triangles(), 2u) << "one corner is no number";
  EXPECT_TRUE(all.hide({dvec3(0), {0, 1, 0}, false}, 0, last));
  EXPECT_FALSE(all.hide({{nan, 0, 0}, {0, 1, 0}, false}, 0, last));
  EXPECT_FALSE(all.hide({dvec3(0), {0, 0, 0}, true}, 0, last)) << "a point where the light is";
  EXPECT_FALSE(all.hide({dvec3(0), {0, nan, 0}, false}, 0, last));
}

}  // namespace
}  // namespace frustum
