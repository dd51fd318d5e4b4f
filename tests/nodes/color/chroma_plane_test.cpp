#include "nodes/color/chroma_plane.h"

#include "nodes/color.h"
#include "tests/support/color_picture.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

template <class R>
using Rgb = std::array<R, 3>;

TEST(ChromaPlane, CornersOfTheTriangleStay) {
  for (std::size_t k = 0; k < 3; ++k)
    for (const float light : {1.F, 0.25F, 1e-45F, 3e38F}) {
      Rgb<float> rgb{}, corner{};
      rgb[k] = light, corner[k] = 1;
      const auto c = color::on_chroma_plane(rgb);
      EXPECT_EQ(c.part, corner) << light;
      EXPECT_TRUE(c.defined);
    }
  const auto white = color::on_chroma_plane<double>({1, 1, 1}).part;
  EXPECT_EQ(white, (Rgb<double>{1. / 3, 1. / 3, 1. / 3}));
}

// Hard case: black, and light that cancels.
TEST(ChromaPlane, BlackHasNoPlace) {
  for (const Rgb<float>& rgb : {Rgb<float>{0, 0, 0}, {-0.F, 0, -0.F}, {1, -0.5F, -0.5F}}) {
    const auto c = color::on_chroma_plane(rgb);
    EXPECT_FALSE(c.defined);
    EXPECT_EQ(c.part, (Rgb<float>{1.F / 3, 1.F / 3, 1.F / 3}));
  }
  for (const Rgb<float>& rgb : {Rgb<float>{std::nanf(""), 0, 1}, {HUGE_VALF, 0, 1}}) {
    const auto c = color::on_chroma_plane(rgb);
    EXPECT_FALSE(c.defined);
    for (const float v : c.part) EXPECT_TRUE(std::isnan(v));
  }
}

template <class R>
void expect_on_plane(double u) {
  test::Random random(5);
  for (int i = 0; i < 100000; ++i) {
    const double size = std::exp2(random.uniform(-100, 100));
    Rgb<R> rgb;
    for (R& v : rgb) v = static_cast<R>(random.uniform() * size);
    const auto p = color::on_chroma_plane(rgb).part;
    const long double sum = static_cast<long double>(rgb[0]) + rgb[1] + rgb[2];
    ASSERT_NEAR(static_cast<double>(p[0]) + p[1] + p[2], 1, 8 * u);
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LE(test::ulps(p[k], rgb[k] / sum), 3);
      ASSERT_TRUE(p[k] >= 0 && p[k] <= 1);
    }
    // A point of the plane stays: the projection of a projection is itself.
    for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(color::on_chroma_plane(p).part[k], p[k], 8 * u);
  }
}
TEST(ChromaPlane, ProjectsTheCubeIntoTheTriangle) {
  expect_on_plane<float>(0x1p-24);
  expect_on_plane<double>(0x1p-53);
}

TEST(ChromaPlane, NothingStaysNothing) {
  const auto in =
      test::color_row<float>({{0, 0, 0, 0}, {0, 0, 0, 1}, {0.25F, 0.125F, 0.125F, 0.5F}, {0.5F, 0, 0.5F, 0}},
                             Alpha::premultiplied, "");
  const auto run = test::color_run(nodes::color_chroma_plane(), "{}", in);
  const Raster out = run.whole(0), defined = run.whole(1);
  EXPECT_EQ(out.frame().color_space, "lin_rec709");
  EXPECT_EQ(test::color_at(out, 0), (std::array<double, 3>{0, 0, 0}));
  EXPECT_EQ(test::color_at(out, 1)[0], 1.F / 3);
  EXPECT_EQ(test::color_at(out, 2), (std::array<double, 3>{0.25, 0.125, 0.125}));
  EXPECT_EQ(test::color_at(out, 3), (std::array<double, 3>{0.5, 0, 0.5}));
  for (int x = 0; x < 4; ++x) EXPECT_EQ(defined.value(0, 0, x, 0), x < 2 ? 0 : 1);
}

TEST(ChromaPlane, KeepsTheLawOfTiles) {
  EXPECT_EQ(test::break_of_tile_law(
                test::color_run(nodes::color_chroma_plane(), "{}", test::random_colors<float>())),
            "");
}

}  // namespace
}  // namespace frustum
