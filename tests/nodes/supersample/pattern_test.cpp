#include "nodes/supersample/pattern.h"

#include "nodes/supersample.h"
#include "runtime/buffers/pattern.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <nlohmann/json.hpp>

#include <set>

namespace frustum {
namespace {

SamplePattern pattern(const Json& params, std::uint64_t seed = 0) {
  Context ctx;
  ctx.seed = seed;
  return *test::run_node(nodes::supersample_pattern(), params, {}, &ctx).at(0).as<SamplePattern>();
}

TEST(SupersamplePattern, PutsOneGridSampleInTheMiddle) {
  const auto p = pattern({{"samples", 1}, {"kind", "grid"}});
  EXPECT_EQ(p.period, 1);
  EXPECT_EQ(p.x, (std::vector<std::uint16_t>{2048}));
  EXPECT_EQ(p.y, (std::vector<std::uint16_t>{2048}));
}

TEST(SupersamplePattern, LaysSamplesOutByIndex) {
  const auto p = pattern({{"samples", 4}, {"kind", "sobol"}}, 3);
  ASSERT_EQ(p.x.size(), 4U * 64 * 64);
  std::vector<std::uint16_t> x(4), y(4);
  for (const auto& [px, py] : {std::pair{0, 0}, {5, 63}, {64 + 7, -1}}) {
    kernels::fill_sample_offsets(kernels::PatternKind::sobol, 3, px & 63, py & 63, x, y);
    for (int s = 0; s < 4; ++s) {
      EXPECT_EQ(p.x[p.index(s, px, py)], x[static_cast<std::size_t>(s)]);
      EXPECT_EQ(p.y[p.index(s, px, py)], y[static_cast<std::size_t>(s)]);
    }
  }
}

TEST(SupersamplePattern, DependsOnTheSeedAndNothingElse) {
  for (const auto* kind : {"jittered", "sobol"}) {
    const Json params = {{"samples", 8}, {"kind", kind}};
    EXPECT_NE(pattern(params, 1).x, pattern(params, 2).x);
    const auto first = pattern(params, 1);
    for (const std::size_t threads : {1U, 7U}) {
      tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      EXPECT_EQ(pattern(params, 1).x, first.x);
    }
  }
  EXPECT_EQ(pattern({{"kind", "grid"}}, 1).x, pattern({{"kind", "grid"}}, 2).x);
}

TEST(SupersamplePattern, RefusesCountsOutOfRange) {
  EXPECT_THROW(pattern({{"samples", 0}}), std::runtime_error);
  EXPECT_THROW(pattern({{"samples", 2000}}), std::runtime_error);
  EXPECT_THROW(pattern({{"kind", "sobel"}}), std::runtime_error);
}

}  // namespace
}  // namespace frustum
