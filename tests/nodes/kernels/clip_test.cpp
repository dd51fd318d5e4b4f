#include "nodes/kernels/clip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "tests/support/clip_spaces.h"
#include "tests/support/ulps.h"

namespace frustum {
namespace {

using kernels::ClipRing;
using kernels::ClipVertex;
using test::Random;

const auto volume = kernels::view_volume();

template <class R>
glm::vec<4, R> random_point(Random& random, double reach) {
  return {static_cast<R>(random.uniform(-reach, reach)), static_cast<R>(random.uniform(-reach, reach)),
          static_cast<R>(random.uniform(-reach, reach)), static_cast<R>(random.uniform(-0.5, 1))};
}

template <class R>
ClipRing<R> clip(const glm::vec<4, R>& a, const glm::vec<4, R>& b, const glm::vec<4, R>& c) {
  const auto cutting = static_cast<std::uint8_t>(kernels::outcode(volume, a) | kernels::outcode(volume, b) |
                                                 kernels::outcode(volume, c));
  return kernels::clip_triangle(volume, cutting, a, b, c);
}

template <class R>
bool same_bits(const glm::vec<4, R>& a, const glm::vec<4, R>& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(ClipTriangle, CutsACornerByHand) {
  // The corner at x = 3 is cut half way along both of its edges, at x = w = 1.
  const auto ring = clip<float>({-1, 0, 0, 1}, {3, 0, 0, 1}, {-1, 1, 0, 1});
  ASSERT_EQ(ring.size, 4U);
  EXPECT_EQ(ring.vertex[0].p, glm::vec4(-1, 0, 0, 1));
  EXPECT_EQ(ring.vertex[1].p, glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(ring.vertex[2].p, glm::vec4(1, 0.5F, 0, 1));
  EXPECT_EQ(ring.vertex[3].p, glm::vec4(-1, 1, 0, 1));
  EXPECT_EQ(ring.vertex[1].weights, glm::dvec3(0.5, 0.5, 0));
  EXPECT_EQ(ring.vertex[2].weights, glm::dvec3(0, 0.5, 0.5));
}

TEST(ClipTriangle, KeepsTrianglesInsideBitForBit) {
  const glm::vec4 a(-1, -1, -1, 1), b(1, -1, 1, 1), c(0, 1, 0, 1);
  const auto ring = clip(a, b, c);
  ASSERT_EQ(ring.size, 3U);
  EXPECT_TRUE(same_bits(ring.vertex[0].p, a) && same_bits(ring.vertex[1].p, b) &&
              same_bits(ring.vertex[2].p, c));
}

// CLP-01.
TEST(ClipTriangle, GivesBothNeighboursOfAnEdgeTheSameBits) {
  Random random(1);
  int crossings = 0, naive_differ = 0;
  for (int i = 0; i < 200000; ++i) {
    const auto a = random_point<float>(random, 2), b = random_point<float>(random, 2);
    const auto c = random_point<float>(random, 2), d = random_point<float>(random, 2);
    const auto left = clip(a, b, c), right = clip(d, b, a);
    // New vertices of edge ab: no weight on the third corner.
    std::vector<glm::vec4> from_left, from_right;
    for (std::size_t k = 0; k < left.size; ++k)
      if (left.vertex[k].weights.z == 0) from_left.push_back(left.vertex[k].p);
    for (std::size_t k = 0; k < right.size; ++k)
      if (right.vertex[k].weights.x == 0) from_right.insert(from_right.begin(), right.vertex[k].p);
    if (left.size == 0 || right.size == 0 || from_left.empty() || from_left.size() != from_right.size())
      continue;
    for (const auto& p : from_left) {
      bool found = false;
      for (const auto& q : from_right) found = found || same_bits(p, q);
      EXPECT_TRUE(found);
    }
    ++crossings;
    const float da = a.x + a.w, db = b.x + b.w;
    if (da * db < 0)
      naive_differ += same_bits(a + (b - a) * (da / (da - db)), b + (a - b) * (db / (db - da))) ? 0 : 1;
  }
  EXPECT_GT(crossings, 10000);
  EXPECT_GT(naive_differ, 1000);
}

// CLP-06, and the weights say where each vertex is.
template <class R>
void expect_inside_and_idempotent(double guard) {
  Random random(2);
  const auto planes = kernels::view_volume({}, guard);
  int naive_outside = 0, cut = 0;
  for (int i = 0; i < 100000; ++i) {
    const glm::vec<4, R> corner[] = {random_point<R>(random, 3), random_point<R>(random, 3),
                                     random_point<R>(random, 3)};
    std::uint8_t cutting = 0;
    for (const auto& p : corner) cutting = static_cast<std::uint8_t>(cutting | kernels::outcode(planes, p));
    const auto ring = kernels::clip_triangle(planes, cutting, corner[0], corner[1], corner[2]);
    for (std::size_t k = 0; k < ring.size; ++k) {
      const auto& v = ring.vertex[k];
      EXPECT_EQ(kernels::outcode(planes, v.p), 0);
      EXPECT_NEAR(v.weights.x + v.weights.y + v.weights.z, 1, 1e-15);
      glm::dvec4 mixed(0);
      for (glm::length_t j = 0; j < 3; ++j) mixed += glm::dvec4(corner[j]) * v.weights[j];
      // At most six cuts in a row, each rounding to R in a triangle of size 3.
      for (glm::length_t j = 0; j < 4; ++j)
        EXPECT_NEAR(static_cast<double>(v.p[j]), mixed[j], 8 * 3 * guard * std::numeric_limits<R>::epsilon());
    }
    for (std::size_t k = 1; k + 1 < ring.size; ++k) {
      const auto again =
          kernels::clip_triangle(planes, 63, ring.vertex[0].p, ring.vertex[k].p, ring.vertex[k + 1].p);
      EXPECT_EQ(again.size, 3U);
      EXPECT_TRUE(same_bits(again.vertex[1].p, ring.vertex[k].p));
    }
    const auto& a = corner[0];
    const auto& b = corner[1];
    const R da = a.x + a.w, db = b.x + b.w;
    if (da >= 0 && db < 0) {
      const auto p = a + (b - a) * (da / (da - db));
      ++cut, naive_outside += p.x + p.w < 0 ? 1 : 0;
    }
  }
  EXPECT_GT(naive_outside, cut / 10);
}
TEST(ClipTriangle, IsInsideEveryPlaneAndIdempotent) {
  expect_inside_and_idempotent<float>(1);
  expect_inside_and_idempotent<double>(1);
  expect_inside_and_idempotent<float>(1.7);
}

// CLP-02: touching from outside leaves nothing, touching from inside changes nothing.
TEST(ClipTriangle, TreatsPointsOnThePlaneAsInside) {
  EXPECT_EQ(clip<float>({1, 0, 0, 1}, {2, 0, 0, 1}, {2, 1, 0, 1}).size, 0U);
  EXPECT_EQ(clip<float>({1, 0, 0, 1}, {1, 1, 0, 1}, {2, 1, 0, 1}).size, 0U);
  EXPECT_EQ(clip<float>({1, 0, 0, 1}, {1, 1, 0, 1}, {0, 1, 0, 1}).size, 3U);
  EXPECT_EQ(clip<float>({1, -1, 0, 1}, {1, 1, 0, 1}, {1, 0, 1, 1}).size, 3U);
  const auto half = clip<float>({1, 0, 0, 1}, {0, -1, 0, 1}, {2, 1, 0, 1});  // one on, one in, one out
  EXPECT_EQ(half.size, 3U);
  EXPECT_EQ(clip<float>({-0.0F, -0.0F, -1, 1}, {1, 0, -1, 1}, {0, 1, -1, 1}).size, 3U);
}

// CLP-03: distances of opposite sign whose difference is all rounding.
TEST(ClipTriangle, StaysOnEdgesAlmostParallelToThePlane) {
  for (const float tiny : {0x1p-149F, 0x1p-126F, 0x1p-60F, 0x1p-24F}) {
    const auto ring = clip<float>({1 - 0x1p-24F, -1, 0, 1}, {1, 1, 0, 1 - tiny}, {0, 0, 0, 1});
    for (std::size_t k = 0; k < ring.size; ++k) {
      EXPECT_EQ(kernels::outcode(volume, ring.vertex[k].p), 0);
      EXPECT_GE(ring.vertex[k].weights.x, 0);
      EXPECT_LE(ring.vertex[k].weights.x, 1);
    }
  }
}

// PRJ-01, CLP-04: corners at w = 0 and behind the eye, all of whose quotients look visible.
TEST(ClipTriangle, LeavesOnlyPointsInFrontOfTheEye) {
  const auto ring = clip<float>({0.5F, 0.5F, 0, 1}, {-0.5F, 0.5F, 0, 1}, {1, -1, 0, -1});
  ASSERT_GE(ring.size, 3U);
  for (std::size_t k = 0; k < ring.size; ++k) EXPECT_GT(ring.vertex[k].p.w, 0);
  EXPECT_EQ(clip<float>({0.5F, 0.5F, 0.2F, -1}, {-0.5F, 0.5F, 0.2F, -1}, {0, -0.5F, 0.2F, -1}).size, 0U);
  for (const float x : {0.0F, 1.0F, -1.0F, 1e-30F}) {
    const auto at_eye = clip<float>({x, 0, 0, 0}, {0, 0.5F, 0, 1}, {0.5F, 0, 0, 1});
    for (std::size_t k = 0; k < at_eye.size; ++k) EXPECT_TRUE(std::isfinite(at_eye.vertex[k].p.x));
  }
}

// CLP-13: float corners at the end of their range; the difference of two overflows in float.
TEST(ClipTriangle, SurvivesTheEndsOfTheRange) {
  const auto ring = clip<float>({-3e38F, 0, 0, 1}, {3e38F, 0, 0, 1}, {0, 1, 0, 1});
  ASSERT_GE(ring.size, 3U);
  for (std::size_t k = 0; k < ring.size; ++k) {
    EXPECT_EQ(kernels::outcode(volume, ring.vertex[k].p), 0);
    EXPECT_TRUE(std::isfinite(ring.vertex[k].p.y));
  }
}

// Row 35: what is kept and what six complements discard cover the triangle: areas add up.
TEST(ClipTriangle, KeepsExactlyTheAreaInside) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    glm::dvec4 p[3];
    for (auto& q : p) q = {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2), 1};
    const auto area = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
      return 0.5 * std::fabs((b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y));
    };
    const auto ring_area = [&area](const ClipRing<double>& r) {
      double sum = 0;
      for (std::size_t k = 1; k + 1 < r.size; ++k)
        sum += area(r.vertex[0].weights, r.vertex[k].weights, r.vertex[k + 1].weights);
      return sum;
    };
    // Peel: the part outside plane 0, then of the rest outside plane 1, ... by the mirrored plane.
    ClipRing<double> rest;
    rest.push({p[0], {1, 0, 0}, 0}), rest.push({p[1], {0, 1, 0}, 1}), rest.push({p[2], {0, 0, 1}, 2});
    double discarded = 0;
    for (std::size_t k = 0; k < 6; ++k) {
      auto mirrored = volume;
      mirrored[0] = {volume[k].axis, -volume[k].sign, -volume[k].bound};
      discarded += ring_area(kernels::clip_halfspace(rest, mirrored, 0));
      rest = kernels::clip_halfspace(rest, volume, k);
    }
    EXPECT_NEAR(ring_area(rest) + discarded, 0.5, 1e-13);  // the area of weight space
  }
}

TEST(Outcode, PutsNaNOutsideEverything) {
  EXPECT_EQ(kernels::outcode(volume, glm::vec4(std::nanf(""))), 63);
  EXPECT_EQ(kernels::outcode(volume, glm::vec4(0, 0, 0, 1)), 0);
  EXPECT_EQ(kernels::outcode(volume, glm::vec4(-1, 1, -1, 1)), 0);
  EXPECT_EQ(kernels::outcode(volume, glm::vec4(0, 0, -2, 1)), 1);
  const auto from_zero = kernels::view_volume({.depth = kernels::DepthRange::zero_to_one});
  EXPECT_EQ(kernels::outcode(from_zero, glm::vec4(0, 0, -0.5F, 1)), 1);
  EXPECT_EQ(kernels::outcode(from_zero, glm::vec4(0, 0, 2, 1)), 2);
  EXPECT_EQ(kernels::outcode(from_zero, glm::vec4(0, 0, 0, 1)), 0);
  EXPECT_EQ(kernels::outcode(kernels::view_volume({.depth = kernels::DepthRange::one_to_zero}),
                             glm::vec4(0, 0, 2, 1)),
            1);
  EXPECT_EQ(kernels::outcode(kernels::view_volume({.depth = kernels::DepthRange::one_to_zero}),
                             glm::vec4(0, 0, -0.5F, 1)),
            2);
}

TEST(Outcode, OfTheVolumeIsThatOfItsPlanes) {
  Random random(4);
  for (int i = 0; i < 100000; ++i) {
    auto p = random_point<float>(random, 1.2);
    if (i % 5 == 0) p[static_cast<int>(random.below(3))] = p.w;
    if (i % 7 == 0) p[static_cast<int>(random.below(3))] = i % 2 == 0 ? std::nanf("") : -0.0F;
    for (const kernels::ClipSpace space : test::clip_spaces)
      for (const double guard : {1.0, 1.3})
        EXPECT_EQ(kernels::volume_outcode(space, static_cast<float>(guard), p),
                  kernels::outcode(kernels::view_volume(space, guard), p));
  }
}

}  // namespace
}  // namespace frustum
