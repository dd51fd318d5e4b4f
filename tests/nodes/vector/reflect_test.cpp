#include "nodes/vector/reflect.h"

#include "tests/nodes/vector/rows.h"

namespace frustum {
namespace {

using test::Quad;

TEST(VectorReflect, MirrorsAboutTheNormal) {
  const auto out = test::run_node(nodes::vector_reflect(), Json::object(),
                                  {{test::vectors({{1, 2, 0}, {0, 1, 0}})}, {test::vectors({{0, 5, 0}})}});
  EXPECT_THAT(out.at(0).as<Vectors>()->along,
              testing::ElementsAre(glm::dvec3(-1, 2, 0), glm::dvec3(0, 1, 0)));
}

TEST(VectorReflect, IsWithinAnUlpForNormalsOfAnyLength) {
  std::mt19937_64 random(3);
  double worst_naive = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const glm::dvec3 l = test::random_row(random),
                     n = test::random_row(random) * std::ldexp(1.0, trial % 40 - 20);
    const auto r = vector::mirrored(l, n);
    const Quad nl = Quad(n.x) * Quad(l.x) + Quad(n.y) * Quad(l.y) + Quad(n.z) * Quad(l.z);
    const Quad nn = Quad(n.x) * Quad(n.x) + Quad(n.y) * Quad(n.y) + Quad(n.z) * Quad(n.z);
    const double length = kernels::norm(l);
    for (glm::length_t i = 0; i < 3; ++i) {
      const Quad exact = 2 * Quad(n[i]) * nl / nn - Quad(l[i]);
      EXPECT_LE(std::fabs(static_cast<double>(Quad((*r)[i]) - exact)), test::ulp(length));
      const glm::dvec3 unit = *kernels::normalized(n);
      const double naive = 2 * unit[i] * kernels::dot(unit, l) - l[i];
      worst_naive =
          std::max(worst_naive, std::fabs(static_cast<double>(Quad(naive) - exact)) / test::ulp(length));
    }
    EXPECT_LE(std::fabs(kernels::norm(*r) - length), 2 * test::ulp(length));
    EXPECT_LE(kernels::largest_component(*vector::mirrored(*r, n) - l), 4 * test::ulp(length))
        << "twice is once";
    // In the plane of l and n.
    EXPECT_LE(std::fabs(kernels::dot(kernels::cross(l, *r), *kernels::normalized(n))),
              8 * 0x1p-53 * length * length);
  }
  EXPECT_GT(worst_naive, 1);
}

TEST(VectorReflect, KeepsGrazingVectorsAndThoseAlongTheNormal) {
  EXPECT_EQ(*vector::mirrored({3, 4, 5}, {3, 4, 5}), glm::dvec3(3, 4, 5));
  EXPECT_EQ(*vector::mirrored({1, 0, 0}, {0, 0, 7}), glm::dvec3(-1, 0, 0));
  const glm::dvec3 grazing = *vector::mirrored({1, 1e-200, 0}, {0, 1, 0});
  EXPECT_EQ(grazing, glm::dvec3(-1, 1e-200, 0));
  EXPECT_EQ(*vector::mirrored({1, 1, 0}, {0, 1e-300, 0}), glm::dvec3(-1, 1, 0));
}

TEST(VectorReflect, RefusesANormalWithoutDirection) {
  const auto v = test::vectors({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  EXPECT_EQ(
      test::run_error(nodes::vector_reflect(), Json::object(), {{v}, {test::vectors({{0, 0, 0}})}}).first,
      "zero_direction");
  EXPECT_EQ(
      test::run_error(nodes::vector_reflect(), Json::object(), {{v}, {test::vectors({{0, 0, 1}, {0, 0, 1}})}})
          .first,
      "rows_differ");
}

}  // namespace
}  // namespace frustum
