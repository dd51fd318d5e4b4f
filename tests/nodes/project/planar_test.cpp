#include "nodes/project/planar.h"

#include "nodes/kernels/matrix.h"
#include "nodes/kernels/predicates.h"
#include "nodes/project.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "tests/support/run_node.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <random>

namespace frustum {
namespace {

using project::Planar;

TEST(ProjectPlanar, FollowsSimilarTriangles) {
  EXPECT_EQ(*project::projected({3, 2, -4}, Planar::perspective, 2), glm::dvec3(1.5, 1, -2));
  EXPECT_EQ(*project::projected({3, 2, -4}, Planar::orthographic, 2), glm::dvec3(3, 2, -2));
  EXPECT_EQ(*project::projected({3, 2, 4}, Planar::orthographic, 2), glm::dvec3(3, 2, -2))
      << "z does not matter";
}

TEST(ProjectPlanar, ChangesNoBitTheSecondTime) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> in(-5, 5), depth(-50, -1e-3), plane(0.01, 20);
  int printed_differs = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const glm::dvec3 p(in(random), in(random), depth(random));
    const double n = plane(random);
    for (const Planar kind : {Planar::perspective, Planar::orthographic}) {
      const glm::dvec3 once = *project::projected(p, kind, n);
      EXPECT_EQ(*project::projected(once, kind, n), once);
    }
    const auto printed = [&](const glm::dvec3& q) {  // M q, then divided by -z / N
      const double w = q.z * (-1 / n);
      return q / w;
    };
    const glm::dvec3 once = printed(p);
    printed_differs += printed(once) != once ? 1 : 0;
  }
  EXPECT_GT(printed_differs, 100);
}

TEST(ProjectPlanar, IsItsMatrixOfRankThree) {
  for (const Planar kind : {Planar::perspective, Planar::orthographic}) {
    const glm::dmat4 m = project::planar_matrix(kind, 2);
    EXPECT_FALSE(kernels::inverse<4>(m)) << "errata E9: no base for clipping and depth";
    glm::dvec4 h = m * glm::dvec4(3, 2, -4, 1);
    h /= h.w;
    EXPECT_EQ(glm::dvec3(h), *project::projected({3, 2, -4}, kind, 2));
  }
  // Rank 3: three of the perspective's columns are independent. And as the course has it, M_O M_P = M_P.
  const glm::dmat4 perspective = project::planar_matrix(Planar::perspective, 2);
  EXPECT_NE(kernels::determinant_sign(glm::dvec3(perspective[0]), glm::dvec3(perspective[1]),
                                      glm::dvec3(perspective[2])),
            0);
  EXPECT_EQ(project::planar_matrix(Planar::orthographic, 2) * glm::dvec4(1.5, 1, -2, 1),
            glm::dvec4(1.5, 1, -2, 1));
}

TEST(ProjectPlanar, KeepsLinesStraight) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> in(-5, 5), depth(-50, -1);
  for (int trial = 0; trial < 500; ++trial) {
    const glm::dvec3 a(in(random), in(random), depth(random)), b(in(random), in(random), depth(random));
    const glm::dvec3 p = *project::projected(a, Planar::perspective, 1),
                     q = *project::projected(b, Planar::perspective, 1),
                     m = *project::projected(a + (b - a) * 0.3, Planar::perspective, 1);
    const double area = (q.x - p.x) * (m.y - p.y) - (q.y - p.y) * (m.x - p.x);
    EXPECT_NEAR(area, 0, 64 * 0x1p-53 * 25);
  }
}

TEST(ProjectPlanar, LeavesOutWhatTheEyeCannotSee) {
  Context ctx;
  const auto points =
      std::make_shared<const Points>(Points{{{1, 1, -1}, {1, 1, 0}, {1, 1, 5}, {1, 1, -1e-320}, {2, 0, -2}}});
  const auto out = test::run_node(nodes::project_planar(), Json::object(), {{points}}, &ctx);
  EXPECT_THAT(out.at(0).as<Points>()->at, testing::ElementsAre(glm::dvec3(1, 1, -1), glm::dvec3(1, 0, -1)));
  ASSERT_EQ(ctx.warnings().size(), 1u);
  EXPECT_EQ(ctx.warnings()[0].first, "points_behind_the_eye");
}

}  // namespace
}  // namespace frustum
