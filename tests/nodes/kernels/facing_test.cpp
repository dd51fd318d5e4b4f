// The vector signs against the exact ones, on every SIMD target.
#include "nodes/kernels/simd/facing.h"

#include "nodes/kernels/predicates.h"
#include "tests/support/simd_targets.h"
#include "tests/support/ulps.h"

#include <glm/vec4.hpp>

#include <limits>
#include <vector>

namespace frustum {
namespace {

using test::Random;

class ClearSigns : public test::EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, ClearSigns, test::every_target(), test::target_name);

struct Soup {
  std::vector<glm::vec4> position;
  std::vector<glm::uvec3> triangle;
};

// Triangles of every size and almost every degeneracy: the third corner near the line of the others.
Soup soup(std::uint64_t seed, std::size_t faces) {
  Random random(seed);
  Soup s;
  for (std::uint32_t f = 0; f < faces; ++f) {
    const auto point = [&] {
      return glm::vec4(random.uniform(-1, 1), random.uniform(-1, 1), 7, random.uniform(0.5, 4));
    };
    const float size = static_cast<float>(std::fabs(random.magnitude(-14, 0)));
    const glm::vec4 a = point(), b = a + point() * size,
                    c = f % 2 == 0 ? a + point() * size : a + (b - a) * 0.3F;
    s.position.insert(s.position.end(), {a, b, c});
    s.triangle.emplace_back(3 * f, 3 * f + 1, 3 * f + 2);
  }
  return s;
}

TEST_P(ClearSigns, AreExactOrUnclear) {
  const Soup s = soup(1, 40007);
  std::vector<std::int8_t> sign(s.triangle.size());
  kernels::simd::clear_signs({&s.position[0].x, s.position.size(), 4, 3}, s.triangle, sign);
  std::size_t unclear = 0;
  for (std::size_t f = 0; f < sign.size(); ++f) {
    const auto row = [&](std::uint32_t v) {
      return glm::vec3(s.position[v].x, s.position[v].y, s.position[v].w);
    };
    const auto& t = s.triangle[f];
    if (sign[f] == kernels::simd::unclear_sign)
      ++unclear;
    else
      EXPECT_EQ(sign[f], kernels::determinant_sign(row(t.x), row(t.y), row(t.z)));
  }
  // Half of the faces are collinear up to rounding; of the others nearly all are clear. A target of one lane knows nothing.
  if (unclear < sign.size()) {
    EXPECT_LT(unclear, sign.size() * 55 / 100);
  }
}

TEST_P(ClearSigns, TakeFlatRowsAndRefuseWhatIsNotFinite) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<glm::vec3> p = {{0, 0, 5}, {1, 0, 5}, {0, 1, 5}, {nan, 0, 5}, {inf, 0, 5}, {3e38F, 0, 5}};
  std::vector<glm::uvec3> t(64, glm::uvec3(0, 1, 2));
  t[1] = {0, 2, 1}, t[2] = {0, 1, 3}, t[3] = {0, 4, 2}, t[4] = {5, 1, 2}, t[5] = {0, 1, 1};
  std::vector<std::int8_t> sign(t.size());
  kernels::simd::clear_signs({&p[0].x, p.size(), 3, -1}, t, sign);
  if (sign[0] == kernels::simd::unclear_sign) return;  // one lane
  EXPECT_EQ(sign[0], 1);
  EXPECT_EQ(sign[1], -1);
  for (const std::size_t f : {2U, 3U, 5U}) EXPECT_EQ(sign[f], kernels::simd::unclear_sign) << f;
  EXPECT_NE(sign[4], 1);  // clockwise, whatever overflows
}

}  // namespace
}  // namespace frustum
