#include "nodes/vector/plane.h"

#include "tests/nodes/vector/rows.h"

#include <numbers>

namespace frustum {
namespace {

using test::Quad;

TEST(VectorPlane, OfATriangleInThePlaneOfTheFloor) {
  const std::vector<glm::dvec3> t{{0, 2, 0}, {0, 2, 4}, {3, 2, 0}};
  const auto plane = vector::plane_of(t);
  EXPECT_EQ(plane->normal, glm::dvec3(0, 1, 0));
  EXPECT_EQ(plane->d(), -2);
  EXPECT_EQ(plane->area, 6);
  EXPECT_EQ(plane->distance({7, 5, 7}), 3);
  EXPECT_EQ(plane->side({7, 5, 7}), 1);
  EXPECT_EQ(plane->side({7, 2, -7}), 0);
  EXPECT_EQ(plane->side({7, 1.9999999999999998, 7}), -1);
}

// Hard case FND-09: thousand corners far from the origin, where one cross product of neighbours is noise.
TEST(VectorPlane, HoldsForManyCornersFarAway) {
  const glm::dvec3 u = glm::dvec3(2, -1, 2) / 3.0, v = glm::dvec3(-1, 2, 2) / 3.0, far(1e7, -2e7, 3e7);
  std::vector<glm::dvec3> p;
  for (int i = 0; i < 1000; ++i) {
    const double t = i * 2 * std::numbers::pi / 1000;
    p.push_back(far + u * std::cos(t) + v * std::sin(t));
  }
  const glm::dvec3 expected = glm::dvec3(-2, -2, 1) / 3.0;
  const auto plane = vector::plane_of(p);
  ASSERT_TRUE(plane);
  const auto angle = [&](const glm::dvec3& n) { return kernels::angle_between(n, expected); };
  // Corners are rounded by 2^-29, each one's share of the normal is a thousandth.
  EXPECT_LT(angle(plane->normal), 1e-8);
  const glm::dvec3 naive = kernels::cross(p[1] - p[0], p[2] - p[1]);
  EXPECT_GT(angle(naive), 1e-6) << "three neighbours";
  EXPECT_NEAR(plane->area, std::numbers::pi, 1e-4);
  EXPECT_LT(plane->residual, 1e-8);
}

TEST(VectorPlane, RefusesCornersOnALine) {
  EXPECT_FALSE(vector::plane_of(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}}));
  EXPECT_FALSE(vector::plane_of(std::vector<glm::dvec3>{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}}));
  EXPECT_FALSE(vector::plane_of(std::vector<glm::dvec3>{{0.1, 0.1, 0.3}, {0.2, 0.2, 0.6}, {0.3, 0.3, 0.9}}));
  EXPECT_TRUE(vector::plane_of(std::vector<glm::dvec3>{{0, 0, 0}, {1e-20, 0, 0}, {0, 1e-20, 0}}))
      << "small is not flat";
  const auto line = test::points({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  EXPECT_EQ(test::run_error(nodes::vector_plane(), Json::object(), {{line}}).first, "no_plane");
}

// Hard case FND-08: the side by the three corners and not by rounded coefficients.
TEST(VectorPlane, SaysTheSideOfNearlyCoplanarPointsExactly) {
  std::mt19937_64 random(9);
  int by_distance_wrong = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const glm::dvec3 a = test::random_row(random, 1e7), b = test::random_row(random, 1e7),
                     c = test::random_row(random, 1e7);
    const std::vector<glm::dvec3> t{a, b, c};
    const auto plane = vector::plane_of(t);
    ASSERT_TRUE(plane);
    const glm::dvec3 w = test::random_row(random);
    const glm::dvec3 p = a + (b - a) * w.x + (c - a) * w.y;
    const auto row = [&](const glm::dvec3& q) {
      return std::array{Quad(q.x) - Quad(p.x), Quad(q.y) - Quad(p.y), Quad(q.z) - Quad(p.z)};
    };
    const auto A = row(a), B = row(b), C = row(c);
    // Differences of doubles below 2^24 with 29 bits behind the point fit 113 bits; products of three need more, so
    // only what is clear in quad is compared.
    const Quad det = A[0] * (B[1] * C[2] - B[2] * C[1]) + A[1] * (B[2] * C[0] - B[0] * C[2]) +
                     A[2] * (B[0] * C[1] - B[1] * C[0]);
    if (det > -Quad(1e-9) && det < Quad(1e-9)) continue;
    const int expected = det > 0 ? -1 : 1;  // seen from the front, a, b, c turn counter-clockwise
    EXPECT_EQ(plane->side(p), expected) << trial;
    const double distance = plane->distance(p);
    by_distance_wrong += (distance > 0 ? 1 : distance < 0 ? -1 : 0) != expected ? 1 : 0;
  }
  EXPECT_GT(by_distance_wrong, 100);
}

TEST(VectorPlane, ListsCoefficientsAndSides) {
  const auto corners = test::points({{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}),
             asked = test::points({{5, 5, -1}});
  const auto out = test::run_node(nodes::vector_plane(), Json::object(), {{corners}, {asked}});
  EXPECT_EQ(out.at(0).as<Vectors>()->along.at(0), glm::dvec3(0, 0, 1));
  EXPECT_THAT(out.at(1).as<Table>()->columns[1].numbers, testing::ElementsAre(0, 0, 1, -1, 1, 0, 16));
  EXPECT_EQ(out.at(2).as<Table>()->columns[3].numbers.at(0), -2);
  EXPECT_EQ(out.at(2).as<Table>()->columns[4].texts.at(0), "behind");
}

}  // namespace
}  // namespace frustum
