#include "nodes/kernels/stencil.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <vector>

#include "tests/support/ulps.h"

namespace frustum {
namespace {

using kernels::Stencils;

TEST(Stencils, ApplyByHand) {
  Stencils s;
  s.copy_row(2);
  s.pair(0, 0.25), s.pair(1, 0.75), s.end_row();
  s.end_row();  // empty
  const std::vector<glm::vec2> in = {{0, 4}, {4, 8}, {1, 1}};
  std::vector<glm::vec2> out(3, glm::vec2(9));
  kernels::apply_affine<glm::vec2>(s, in, out);
  EXPECT_EQ(out, (std::vector<glm::vec2>{{1, 1}, {3, 7}, {0, 0}}));
  kernels::apply_linear<glm::vec2>(s, in, out);
  EXPECT_EQ(out, (std::vector<glm::vec2>{{1, 1}, {3, 7}, {0, 0}}));
  std::vector<std::uint32_t> ids(3);
  kernels::apply_largest<std::uint32_t>(s, std::vector<std::uint32_t>{10, 11, 12}, ids);
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{12, 11, 0}));
}

// FND-06: far from the origin a plain weighted sum of equal points is not that point.
TEST(Stencils, ReturnEqualInputsBitForBit) {
  test::Random random(1);
  Stencils s;
  int plain_misses = 0;
  const glm::dvec3 p(1e7 + 0.1, -1e7 - 0.3, 1e7 / 3);
  for (int row = 0; row < 1000; ++row) {
    double sum = 0, plain = 0;
    for (std::uint32_t j = 0; j < 3; ++j) {
      const double w = j == 2 ? 1 - sum : random.uniform(0, 0.5);
      sum += w, plain += w * p.x;
      s.pair(j, w);
    }
    s.end_row();
    plain_misses += plain == p.x ? 0 : 1;
  }
  const std::vector<glm::dvec3> in(3, p);
  std::vector<glm::dvec3> out(1000);
  kernels::apply_affine<glm::dvec3>(s, in, out);
  for (const auto& q : out) EXPECT_EQ(q, p);
  EXPECT_GT(plain_misses, 50);
}

TEST(Stencils, GiveTheSameBytesForAnyNumberOfThreads) {
  test::Random random(2);
  Stencils s, parts[2];
  for (int row = 0; row < 20000; ++row) {
    auto& part = parts[row < 7000 ? 0 : 1];
    for (int j = 0; j < 4; ++j)
      part.pair(static_cast<std::uint32_t>(random.below(500)), random.uniform(-1, 1));
    part.end_row();
  }
  s.append(parts[0]), s.append(parts[1]);
  std::vector<glm::vec4> in(500), first, out(20000);
  for (auto& p : in) p = {random.uniform(), random.uniform(), random.uniform(), random.uniform()};
  for (const std::size_t threads : {1U, 2U, 7U}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    kernels::apply_affine<glm::vec4>(s, in, out);
    if (first.empty()) first = out;
    EXPECT_EQ(std::memcmp(first.data(), out.data(), out.size() * sizeof(glm::vec4)), 0);
  }
}

}  // namespace
}  // namespace frustum
