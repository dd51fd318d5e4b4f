#include "nodes/check.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/value.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

double cell(const Table& t, std::string_view column, std::size_t row) {
  for (const auto& c : t.columns)
    if (c.name == column) return c.numbers.at(row);
  ADD_FAILURE() << "no column " << column;
  return 0;
}

Ref<Table> measured(const Raster& r) {
  return test::run_geometry(nodes::check_statistics(), "{}",
                            {{"image", {std::make_shared<const Image>(Image{r})}}})
      .at(0)
      .as<Table>();
}

TEST(CheckStatistics, CountsEverySampleOfEveryPlane) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = 2, pattern->x = {0, 1}, pattern->y = {0, 1};
  Raster r(Frame{.window = {5, 5, 15, 10},
                 .pattern = pattern,
                 .planes = {{"R"}, {"Z", PlaneKind::f64}, {"id", PlaneKind::u32}}});
  for (int s = 0; s < 2; ++s)
    for (int y = 5; y < 10; ++y)
      for (int x = 0; x < 10; ++x) {
        const int i = (s * 5 + y - 5) * 10 + x;  // 0 ... 99
        r.view().row<float>(0, s, y)[x] = static_cast<float>(i);
        r.view().row<double>(1, s, y)[x] = 1e9 + (i % 2);
        r.view().row<std::uint32_t>(2, s, y)[x] = 7;
      }
  const auto t = measured(r);
  EXPECT_EQ(t->columns[0].texts, (std::vector<std::string>{"R", "Z", "id"}));
  EXPECT_EQ(cell(*t, "min", 0), 0);
  EXPECT_EQ(cell(*t, "max", 0), 99);
  EXPECT_DOUBLE_EQ(cell(*t, "mean", 0), 49.5);
  EXPECT_DOUBLE_EQ(cell(*t, "deviation", 0), std::sqrt(9999.0 / 12));  // of 0 ... n - 1: (n^2 - 1) / 12
  EXPECT_EQ(cell(*t, "p50", 0), 49);
  EXPECT_DOUBLE_EQ(cell(*t, "deviation", 1), 0.5) << "a large mean leaves its digits alone";
  EXPECT_EQ(cell(*t, "max", 2), 7);
  EXPECT_EQ(cell(*t, "deviation", 2), 0);
  EXPECT_EQ(cell(*t, "finite", 2), 100);
}

TEST(CheckStatistics, WhatIsNotFiniteIsCountedAndLeftOut) {
  Raster r(Frame{.window = {0, 0, 4, 1}, .planes = {{"R"}}});
  constexpr float inf = std::numeric_limits<float>::infinity();
  const float values[4] = {std::nanf(""), inf, -inf, 2};
  std::copy_n(values, 4, r.view().row<float>(0, 0, 0));
  const auto t = measured(r);
  EXPECT_EQ(cell(*t, "nan", 0), 1);
  EXPECT_EQ(cell(*t, "inf", 0), 1);
  EXPECT_EQ(cell(*t, "-inf", 0), 1);
  EXPECT_EQ(cell(*t, "mean", 0), 2);
  EXPECT_EQ(measured(Raster(Frame{}))->rows(), 0u) << "no planes, no rows";
}

}  // namespace
}  // namespace frustum
