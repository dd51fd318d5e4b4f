// filter.convolve: kernels by hand, borders by hand, and the vector kernel.
#include "nodes/kernels/simd/convolve.h"
#include "nodes/filter.h"
#include "runtime/buffers/image.h"
#include "tests/support/tiles.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <bit>
#include <functional>

namespace frustum {
namespace {

Ref<Image> image(Rect window, const std::function<double(int x, int y)>& value) {
  Raster r(Frame{.window = window, .planes = {{"R"}, {"A"}}});
  for (int y = window.y0; y < window.y1; ++y)
    for (int x = window.x0; x < window.x1; ++x) {
      r.view().row<float>(0, 0, y)[x - window.x0] = static_cast<float>(value(x, y));
      r.view().row<float>(1, 0, y)[x - window.x0] = 1;
    }
  return std::make_shared<Image>(Image{r});
}

Raster convolved(const Ref<Image>& in, std::string_view params, Precision precision = Precision::single) {
  return test::PixelRun(nodes::filter_convolve(), params, {{"image", {in}}}, precision).whole();
}

TEST(FilterConvolve, KeepsTheLawOfTilesWithEveryBorder) {
  auto random = std::make_shared<test::Random>(1);
  const auto noise = image({-4, 6, 33, 25}, [&](int, int) { return random->uniform(-1, 1); });
  for (const char* border : {"clamp", "zero", "mirror", "repeat"})
    for (const char* radius : {"0", "1", "3.5", "40"}) {  // 40: wider than the picture
      const std::string params = std::string(R"({"border": ")") + border + R"(", "radius": )" + radius + "}";
      EXPECT_EQ(test::break_of_tile_law({nodes::filter_convolve(), params, {{"image", {noise}}}}), "")
          << params;
    }
}

TEST(FilterConvolve, ABoxOfRadiusOneIsItsCoverage) {
  const auto dot = image({0, 0, 9, 9}, [](int x, int y) { return x == 4 && y == 4 ? 16 : 0; });
  const Raster out = convolved(dot, R"({"kernel": "box", "radius": 1})");
  const double want[3] = {4, 2, 0};  // 1/2, 1/4, 0 along each axis
  for (int dy = 0; dy < 3; ++dy)
    for (int dx = 0; dx < 3; ++dx)
      for (const int sign : {-1, 1})
        EXPECT_EQ(out.value(0, 0, 4 + sign * dx, 4 - sign * dy), want[dx] * want[dy] / 4);
}

TEST(FilterConvolve, ADotBecomesTheKernelAndKeepsItsWeight) {
  const auto dot = image({0, 0, 41, 41}, [](int x, int y) { return x == 20 && y == 20 ? 1 : 0; });
  for (const char* kernel : {"box", "bartlett", "gaussian", "mitchell"}) {
    const Raster out = convolved(dot, std::string(R"({"kernel": ")") + kernel + R"(", "radius": 7.3})",
                                 Precision::real_double);
    double sum = 0;
    for (int y = 0; y < 41; ++y)
      for (int x = 0; x < 41; ++x) {
        sum += out.value(0, 0, x, y);
        EXPECT_EQ(out.value(0, 0, x, y), out.value(0, 0, 40 - x, y)) << kernel << " is even";
        EXPECT_NEAR(out.value(0, 0, x, y), out.value(0, 0, y, x), 1e-17)
            << kernel << " is the same in x and y";
      }
    EXPECT_NEAR(sum, 1, 1e-13) << kernel;
  }
}

TEST(FilterConvolve, BordersAreWhatTheySay) {
  const auto line = image({0, 0, 4, 1}, [](int x, int) { return 1 << x; });  // 1 2 4 8
  const auto first = [&](const char* border) {
    return convolved(line, std::string(R"({"kernel": "box", "radius": 2.5, "border": ")") + border + "\"}")
        .value(0, 0, 0, 0);
  };
  EXPECT_NEAR(first("clamp"), (1 + 1 + 1 + 2 + 4) / 5.0, 1e-6);
  EXPECT_NEAR(first("mirror"), (2 + 1 + 1 + 2 + 4) / 5.0, 1e-6);
  EXPECT_NEAR(first("repeat"), (4 + 8 + 1 + 2 + 4) / 5.0, 1e-6);
  EXPECT_NEAR(first("zero"), (0 + 0 + 1 + 2 + 4) / 5.0 / 5, 1e-6) << "and one of the five rows";
}

TEST(FilterConvolve, AConstantKeepsItsBits) {
  for (const double c : {0.1, 1.0 / 3, 5e-42}) {
    const auto flat = image({0, 0, 33, 5}, [&](int, int) { return c; });
    for (const char* border : {"clamp", "mirror", "repeat"}) {
      const Raster out = convolved(flat, std::string(R"({"radius": 4, "border": ")") + border + "\"}");
      for (int x = 0; x < 33; ++x) EXPECT_EQ(out.at<float>(0, 0, x, 2), static_cast<float>(c));
    }
  }
}

TEST(FilterConvolve, EveryTargetHasTheBitsOfTheScalarTwin) {
  constexpr std::size_t n = 139, rows = 9;
  test::Random random(6);
  std::vector<std::vector<float>> data(rows, std::vector<float>(n));
  for (auto& row : data)
    for (std::size_t x = 0; x < n; ++x)
      row[x] = x % 3 == 0 ? 0.3F : static_cast<float>(random.uniform(-1, 1));
  std::vector<const float*> in;
  std::vector<float> weight;
  for (const auto& row : data)
    in.push_back(row.data()), weight.push_back(static_cast<float>(random.uniform(0, 1)));
  std::vector<float> truth(n), simd(n);
  kernels::weigh_rows<float>(in, weight, n, truth.data());
  test::for_each_simd_target([&](const char* target) {
    kernels::simd::weigh_rows(in, weight, n, simd.data());
    for (std::size_t x = 0; x < n; ++x)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(simd[x]), std::bit_cast<std::uint32_t>(truth[x]))
          << target << " " << x;
  });
}

}  // namespace
}  // namespace frustum
