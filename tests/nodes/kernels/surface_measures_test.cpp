#include "nodes/kernels/surface_measures.h"

#include "tests/support/meshes.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

namespace frustum::kernels {
namespace {

// A cube of this half side around a centre, fronts outside.
template <class R>
struct Cube {
  std::vector<glm::vec<3, R>> position;
  std::vector<glm::uvec3> triangle;

  Cube(const glm::dvec3& centre, double half) {
    for (int k = 0; k < 8; ++k)
      position.emplace_back(centre + half * glm::dvec3((k & 1) * 2 - 1, (k & 2) - 1, (k & 4) / 2 - 1));
    for (const std::array<std::uint32_t, 4>& s : std::vector<std::array<std::uint32_t, 4>>{
             {5, 1, 3, 7}, {0, 4, 6, 2}, {6, 7, 3, 2}, {0, 1, 5, 4}, {4, 5, 7, 6}, {1, 0, 2, 3}}) {
      triangle.emplace_back(s[0], s[1], s[2]);
      triangle.emplace_back(s[0], s[2], s[3]);
    }
  }
  Triangles<R> mesh() const { return {position, triangle}; }
};

TEST(SurfaceMeasures, AreExactForACube) {
  const Cube<float> cube({1, 2, 3}, 0.5);
  const Box box = bounds_of(cube.mesh());
  EXPECT_EQ(box.low, glm::dvec3(0.5, 1.5, 2.5));
  EXPECT_EQ(box.high, glm::dvec3(1.5, 2.5, 3.5));
  const auto m = measures_of(cube.mesh(), box);
  EXPECT_EQ(m.area, 6);
  EXPECT_EQ(m.volume, 1);
  EXPECT_EQ(m.centroid, glm::dvec3(1, 2, 3));
}

// Volumes from the origin cancel: 5e5 from a unit cube its terms are products of size 1e17.
TEST(SurfaceMeasures, KeepTheirDigitsFarAway) {
  const Cube<double> cube({1e6 / 3, -2e6 / 7, 3e6 / 11}, 0.5);  // rounded: volume 1 to 1e-9
  const auto m = measures_of(cube.mesh(), bounds_of(cube.mesh()));
  EXPECT_NEAR(m.volume, 1, 1e-9);
  double plain = 0;
  for (std::size_t f = 0; f < cube.triangle.size(); ++f) {
    const auto [a, b, c] = cube.mesh().corners(f);
    plain += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  }
  EXPECT_GT(std::fabs(plain / 6 - 1), 1e-6);  // what is not done here
}

TEST(SurfaceMeasures, NeitherOverflowNorUnderflowOnTheWay) {
  const Cube<double> large({0, 0, 0}, 1e100), small({0, 0, 0}, 1e-100);
  EXPECT_NEAR(measures_of(large.mesh(), bounds_of(large.mesh())).volume / 8e300, 1, 1e-14);
  EXPECT_NEAR(measures_of(small.mesh(), bounds_of(small.mesh())).volume / 8e-300, 1, 1e-14);
  const Cube<float> big({0, 0, 0}, 1e30);
  EXPECT_NEAR(measures_of(big.mesh(), bounds_of(big.mesh())).area / 24e60, 1, 1e-6);
}

TEST(SurfaceMeasures, LeaveOutWhatIsNotFiniteOrUnused) {
  const std::vector<glm::vec3> p = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 5, 5}, {99, 99, 99}};
  const std::vector<glm::uvec3> t = {{0, 1, 2}, {0, 1, 3}};
  const Triangles<float> mesh{p, t};
  EXPECT_EQ(bounds_of(mesh).high, glm::dvec3(1, 1, 0));
  EXPECT_EQ(measures_of(mesh, bounds_of(mesh)).area, 0.5);
  EXPECT_TRUE(bounds_of(Triangles<float>{p, {}}).empty());
  EXPECT_EQ(measures_of(Triangles<float>{p, {}}, Box{}).area, 0);
}

// A torus: 4 pi^2 R r and 2 pi^2 R r^2 but for what its flat faces leave out.
TEST(SurfaceMeasures, ApproachTheTorus) {
  const Mesh torus = test::torus(512, 256);
  const Triangles<float> mesh{torus.at("position").values<glm::vec3>(), torus.triangles()};
  const auto m = measures_of(mesh, bounds_of(mesh));
  EXPECT_NEAR(m.area, 4 * std::numbers::pi * std::numbers::pi * 0.4, 2e-3);
  EXPECT_NEAR(m.volume, 2 * std::numbers::pi * std::numbers::pi * 0.16, 1e-3);
}

}  // namespace
}  // namespace frustum::kernels
