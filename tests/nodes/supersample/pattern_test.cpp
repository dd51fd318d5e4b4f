#include "nodes/supersample/pattern.h"

#include "nodes/supersample.h"
#include "runtime/buffers/pattern.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <glm/vec2.hpp>
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

// The numbers of the Vulkan specification, standardSampleLocations.
TEST(SupersamplePattern, HasThePlacesThatTheInterfacesAgreeOn) {
  const std::vector<std::vector<glm::dvec2>> specified{
      {{0.5, 0.5}},
      {{0.75, 0.75}, {0.25, 0.25}},
      {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}},
      {{0.5625, 0.3125},
       {0.4375, 0.6875},
       {0.8125, 0.5625},
       {0.3125, 0.1875},
       {0.1875, 0.8125},
       {0.0625, 0.4375},
       {0.6875, 0.9375},
       {0.9375, 0.0625}},
      {{0.5625, 0.5625},
       {0.4375, 0.3125},
       {0.3125, 0.625},
       {0.75, 0.4375},
       {0.1875, 0.375},
       {0.625, 0.8125},
       {0.8125, 0.6875},
       {0.6875, 0.1875},
       {0.375, 0.875},
       {0.5, 0.0625},
       {0.25, 0.125},
       {0.125, 0.75},
       {0.0, 0.5},
       {0.9375, 0.25},
       {0.875, 0.9375},
       {0.0625, 0.0}}};
  for (const auto& places : specified) {
    const auto p = pattern({{"samples", places.size()}, {"kind", "standard"}});
    EXPECT_EQ(p.period, 1);
    ASSERT_EQ(p.x.size(), places.size());
    std::set<std::uint16_t> columns(p.x.begin(), p.x.end()), rows(p.y.begin(), p.y.end());
    EXPECT_EQ(columns.size(), places.size()) << "no two in one column";
    EXPECT_EQ(rows.size(), places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
      EXPECT_EQ(glm::dvec2(p.x[i], p.y[i]), places[i] * 4096.0) << places.size() << ", " << i;
  }
  EXPECT_EQ(test::run_error(nodes::supersample_pattern(), {{"samples", 5}, {"kind", "standard"}}).first,
            "no_standard_samples");
}

TEST(SupersamplePattern, RefusesCountsOutOfRange) {
  EXPECT_THROW(pattern({{"samples", 0}}), std::runtime_error);
  EXPECT_THROW(pattern({{"samples", 2000}}), std::runtime_error);
  EXPECT_THROW(pattern({{"kind", "sobel"}}), std::runtime_error);
}

}  // namespace
}  // namespace frustum
