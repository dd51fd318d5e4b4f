#include "nodes/color/gamut.h"

#include "nodes/color.h"
#include "runtime/io/color.h"
#include "tests/support/color_picture.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

using test::color_at, test::color_row, test::color_run;
using Rgb = std::array<double, 3>;
using color::Gamut, color::Mapping;

constexpr std::array<double, 6> rec709{0.64, 0.33, 0.30, 0.60, 0.15, 0.06};  // ITU-R BT.709-6
constexpr Rgb weights{0.2126, 0.7152, 0.0722};

// The barycentric coordinates of (x, y) in the triangle of Rec.709's primaries, from areas.
std::array<long double, 3> barycentric(long double x, long double y) {
  const auto area = [](long double ax, long double ay, long double bx, long double by, long double cx,
                       long double cy) { return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax); };
  const auto& p = rec709;
  const long double whole = area(p[0], p[1], p[2], p[3], p[4], p[5]);
  return {area(x, y, p[2], p[3], p[4], p[5]) / whole, area(p[0], p[1], x, y, p[4], p[5]) / whole,
          area(p[0], p[1], p[2], p[3], x, y) / whole};
}

// Row 103's oracle: inside is where no barycentric coordinate is below 0, all over the diagram.
TEST(Gamut, HasTheSignsOfBarycentricCoordinates) {
  std::vector<std::array<double, 4>> xyz;
  std::vector<bool> want;
  int inside = 0;
  for (int i = 1; i < 200; ++i)
    for (int j = 1; j + i < 200; ++j) {
      const double x = (i + 0.137) / 200, y = (j + 0.291) / 200;
      const auto b = barycentric(x, y);
      const double light = 0.01 * (1 + i % 7);
      xyz.push_back({x / y * light, light, (1 - x - y) / y * light, 1});
      ASSERT_GT(std::abs(std::min({b[0], b[1], b[2]})), 1e-9L);
      want.push_back(b[0] > 0 && b[1] > 0 && b[2] > 0), inside += want.back();
    }
  const Raster out = color_run(nodes::color_gamut(), "{}", color_row<double>(xyz, Alpha::none, "xyz_d65"),
                               Precision::real_double)
                         .whole(1);
  EXPECT_GT(inside, 4000);
  EXPECT_LT(inside, 5000);  // the triangle has 0.11205 of the 0.5 of the diagram
  for (std::size_t i = 0; i < want.size(); ++i)
    ASSERT_EQ(out.value(0, 0, static_cast<int>(i), 0) == 1, want[i]) << i;
}

TEST(Gamut, DecidesItsBoundaryExactly) {
  const float tiny = std::numeric_limits<float>::denorm_min(), over = std::nextafter(1.F, 2.F),
              nan = std::nanf("");
  const auto in = [](std::array<float, 3> v, Gamut g) { return color::inside<float>(v, g); };
  EXPECT_TRUE(in({0, 1, 0}, Gamut::light));
  EXPECT_TRUE(in({-0.F, 1, 0}, Gamut::light));
  EXPECT_FALSE(in({-tiny, 1, 0}, Gamut::light));
  EXPECT_TRUE(in({tiny, 1, 0}, Gamut::light));
  EXPECT_TRUE(in({0, over, 0}, Gamut::light));
  EXPECT_FALSE(in({0, over, 0}, Gamut::display));
  EXPECT_TRUE(in({1, 1, 1}, Gamut::display));
  EXPECT_FALSE(in({nan, 0, 0}, Gamut::light));
}

// P3's red in sRGB (checklist, row 101).
TEST(Gamut, KnowsTheRedOfP3) {
  const auto red = color_row<double>({{1, 0, 0, 1}, {0.5, 0.5, 0.5, 1}}, Alpha::none, "lin_p3d65");
  const auto clipped = color_run(nodes::color_gamut(), R"({"method": "clip"})", red, Precision::real_double);
  EXPECT_EQ(clipped.whole(1).value(0, 0, 0, 0), 0);
  EXPECT_EQ(clipped.whole(1).value(0, 0, 1, 0), 1);
  EXPECT_NEAR(color_at(clipped.whole(), 0)[0], 1.22494, 5e-6);
  EXPECT_EQ(color_at(clipped.whole(), 0)[1], 0);
  EXPECT_EQ(clipped.whole().frame().color_space, "lin_rec709");
  const Rgb soft = color_at(color_run(nodes::color_gamut(), "{}", red, Precision::real_double).whole(), 0);
  EXPECT_NEAR(0.2126390 * soft[0] + 0.7151687 * soft[1] + 0.0721923 * soft[2], 0.2289746,
              1e-6);  // Y of P3's red
  EXPECT_NEAR(std::min(soft[1], soft[2]), 0, 1e-15);
}

// Hard case COL-13: what mapping gives is inside, twice is once, and what a method promises to keep it keeps.
TEST(Gamut, MapsInsideAndOnce) {
  test::Random random(11);
  for (int i = 0; i < 200000; ++i) {
    Rgb v{random.uniform(-1, 2), random.uniform(-1, 2), random.uniform(-1, 2)};
    for (const Gamut g : {Gamut::light, Gamut::display})
      for (const Mapping m : {Mapping::clip, Mapping::desaturate}) {
        const Rgb to = color::mapped<double>(v, g, m, weights);
        ASSERT_TRUE(color::inside(to, g)) << i;
        ASSERT_EQ(color::mapped<double>(to, g, m, weights), to) << i;
        ASSERT_TRUE(!color::inside(v, g) || to == v) << i;
        if (m == Mapping::clip) {
          // The projection on a convex set: no corner of the gamut lies on the colour's side of it (KKT).
          for (int corner = 0; corner < 8; ++corner) {
            double dot = 0;
            for (std::size_t k = 0; k < 3; ++k) dot += (v[k] - to[k]) * ((corner >> k & 1) - to[k]);
            ASSERT_LE(dot, 1e-15) << i;
          }
          continue;
        }
        const auto luminance = [](const Rgb& c) {
          return weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2];
        };
        const double y = std::clamp(luminance(v), 0.0, g == Gamut::light ? 1e9 : 1.0);
        ASSERT_NEAR(luminance(to), y, 4e-15) << i;
        // On the line to grey: differences of parts keep their ratios.
        const double cross = (to[0] - to[1]) * (v[1] - v[2]) - (to[1] - to[2]) * (v[0] - v[1]);
        ASSERT_NEAR(cross, 0, 2e-14) << i;
      }
  }
}

TEST(Gamut, NanStaysAndCoverageIsKept) {
  for (const Mapping m : {Mapping::clip, Mapping::desaturate})
    EXPECT_TRUE(std::isnan(color::mapped<double>({std::nan(""), -1, 2}, Gamut::display, m, weights)[0]));
  const auto in = color_row<float>({{0.75F, 0.25F, 0.25F, 0.5F}, {0, 0, 0, 0}}, Alpha::premultiplied, "");
  const Raster out = color_run(nodes::color_gamut(), R"({"bound": "display", "method": "clip"})", in).whole();
  EXPECT_EQ(color_at(out, 0), (Rgb{0.5, 0.25, 0.25})) << "1.5 of a colour is 1 of it, half covered";
  EXPECT_EQ(out.value(3, 0, 0, 0), 0.5);
  EXPECT_EQ(color_at(out, 1), (Rgb{0, 0, 0}));
}

TEST(Gamut, RefusesSpacesWithoutPrimaries) {
  const NodeType type = nodes::color_gamut();
  const auto code = [&](const char* space) -> std::string {
    try {
      type.check(test::params_of(type, std::string(R"({"of": ")") + space + "\"}").get());
      return "";
    } catch (const NodeError& e) {
      return e.code;
    }
  };
  for (const char* space : {"xyz_d65", "raw"}) EXPECT_EQ(code(space), "no_primaries");
  EXPECT_EQ(code("rec7O9"), "unknown_color_space");
  EXPECT_EQ(code("display_p3"), "");
}

TEST(Gamut, KeepsTheLawOfTiles) {
  for (const char* params : {"{}", R"({"of": "display_p3", "bound": "display", "method": "clip"})"})
    EXPECT_EQ(test::break_of_tile_law(color_run(nodes::color_gamut(), params, test::random_colors<float>())),
              "");
}

}  // namespace
}  // namespace frustum
