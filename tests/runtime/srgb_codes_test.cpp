// The table of a display's codes against the formula that it stands for.
#include "runtime/app/sweep/srgb_codes.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace frustum {
namespace {

TEST(SrgbCodes, AreThoseOfTheFormulaOnBothSidesOfEveryStep) {
  const SrgbCodes code;
  for (int k = 1; k < 256; ++k) {
    double low = 0, high = 1;  // the code is below k at `low`, not at `high`
    while (std::nextafter(low, 1.0) < high) {
      const double middle = low + (high - low) / 2;
      (srgb_code_by_formula(middle) < k ? low : high) = middle;
    }
    EXPECT_EQ(code(low), k - 1);
    EXPECT_EQ(code(high), k);
  }
}

TEST(SrgbCodes, AreThoseOfTheFormulaEverywhere) {
  const SrgbCodes code;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double v : {-infinity, -1.0, -0.0, 0.0, 0x1p-1074, 1.0, 1 + 0x1p-52, 7.0, infinity})
    EXPECT_EQ(code(v), srgb_code_by_formula(v)) << v;
  EXPECT_EQ(code(std::numeric_limits<double>::quiet_NaN()), 0);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> light(0, 1);
  for (int i = 0; i < 100000; ++i) {
    const double v = i % 2 == 0 ? light(random) : std::pow(light(random), 8);
    ASSERT_EQ(code(v), srgb_code_by_formula(v)) << v;
  }
  for (int i = 0; i <= 4096; ++i) ASSERT_EQ(code(i / 4096.0), srgb_code_by_formula(i / 4096.0)) << i;
}

}  // namespace
}  // namespace frustum
