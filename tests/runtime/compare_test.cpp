#include "runtime/app/compare.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

using testing::HasSubstr;
constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();

// One row of one plane.
Raster row(std::initializer_list<float> values, const char* plane = "R") {
  Raster r(Frame{{0, 0, static_cast<int>(values.size()), 1}, nullptr, {{plane, PlaneKind::f32}}});
  std::copy(values.begin(), values.end(), r.view().row<float>(0, 0, 0));
  return r;
}

TEST(Compare, MeasuresByHand) {
  const Difference d = compare(row({0, 1, 2, 3}), row({0, 1, 2.5f, 1}));
  EXPECT_EQ(d.values, 4u);
  EXPECT_EQ(d.differing, 2u);
  EXPECT_EQ(d.max, 2.0);
  EXPECT_EQ(d.rmse, std::sqrt((0.25 + 4) / 4));
  EXPECT_NEAR(d.psnr, 10 * std::log10(4 / 4.25), 1e-12);
  ASSERT_TRUE(d.worst);
  EXPECT_EQ(d.worst->x, 3);
  EXPECT_EQ(d.worst->a, 3);
  EXPECT_FALSE(d.identical());
}

TEST(Compare, EqualPicturesAreIdenticalAndHaveInfinitePsnr) {
  const Difference d = compare(row({0, inf, -1}), row({0, inf, -1}));
  EXPECT_TRUE(d.identical());
  EXPECT_EQ(d.rmse, 0);
  EXPECT_EQ(d.psnr, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(holds(d, {"psnr", 100}));
}

TEST(Compare, ZerosOfBothSignsAreEqualButNotIdentical) {
  const Difference d = compare(row({0.0f}), row({-0.0f}));
  EXPECT_EQ(d.max, 0);
  EXPECT_EQ(d.differing, 1u);
  EXPECT_FALSE(holds(d, {"identical"}));
  EXPECT_TRUE(holds(d, {"max", 0}));
}

TEST(Compare, NanNeverPassesEvenAgainstTheSameNan) {
  for (const auto& [a, b] :
       {std::pair{row({nan, 1}), row({nan, 1})}, std::pair{row({0, 1}), row({0, nan})}}) {
    const Difference d = compare(a, b);
    EXPECT_GT(d.nan, 0u);
    for (const std::string& metric : metric_names())
      EXPECT_FALSE(holds(d, {metric, metric == "psnr" ? 0 : std::numeric_limits<double>::infinity()}))
          << metric;
    EXPECT_EQ(count_beyond(a, b, 1e30), 1u);
  }
}

TEST(Compare, InfinityAgainstANumberIsInfinitelyFar) {
  EXPECT_EQ(compare(row({inf}), row({1})).max, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(holds(compare(row({inf}), row({1})), {"rmse", 1e300}));
}

TEST(Compare, SizeSamplesAndPlanesComeFirst) {
  EXPECT_THAT(compare(row({1}), row({1, 2})).mismatch, HasSubstr("windows"));
  EXPECT_THAT(compare(row({1}, "R"), row({1}, "G")).mismatch, HasSubstr("only the first has the planes R"));
  Frame two{
      {0, 0, 1, 1}, std::make_shared<const SamplePattern>(SamplePattern{2, 1, {0, 1}, {0, 1}}), {{"R"}}};
  EXPECT_THAT(compare(row({1}), Raster(two)).mismatch, HasSubstr("samples"));
  EXPECT_FALSE(holds(compare(row({1}), row({1, 2})), {"max", 1e9}));
}

TEST(Compare, PlanesAreMatchedByNameAndMayHaveOtherKinds) {
  Raster a(Frame{{0, 0, 1, 1}, nullptr, {{"R", PlaneKind::f32}, {"id", PlaneKind::u32}}});
  Raster b(Frame{{0, 0, 1, 1}, nullptr, {{"id", PlaneKind::f64}, {"R", PlaneKind::f32}}});
  a.view().row<float>(0, 0, 0)[0] = 0.5f, a.view().row<std::uint32_t>(1, 0, 0)[0] = 4'000'000'000u;
  b.view().row<float>(1, 0, 0)[0] = 0.5f, b.view().row<double>(0, 0, 0)[0] = 4'000'000'000.0;
  EXPECT_TRUE(compare(a, b).identical());
}

TEST(Compare, NoPixelsAreIdentical) { EXPECT_TRUE(compare(row({}), row({})).identical()); }

TEST(Compare, CountsWhatIsBeyondATolerance) {
  EXPECT_EQ(count_beyond(row({0, 0, 0}), row({0.1f, 0.2f, 0.3f}), 0.2f), 1u);
}

}  // namespace
}  // namespace frustum
