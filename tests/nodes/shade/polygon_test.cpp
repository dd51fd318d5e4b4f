// shade.polygon: what the colours inside a polygon depend on. The lesson of the course: colours change with the order and the
// orientation of the corners of n-gons (errata E38).
#include "nodes/shade/polygon.h"
#include "nodes/shade.h"
#include "runtime/buffers/image.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace frustum {
namespace {

using glm::dvec2, glm::dvec3;
using kernels::ColoredPolygon;

Raster drawn(const std::string& method, double turn, int first, const std::string& more = "") {
  return test::run_geometry(nodes::shade_polygon(),
                            R"({"method": ")" + method + R"(", "turn": )" + std::to_string(turn) +
                                R"(, "first": )" + std::to_string(first) + more + "}",
                            {})
      .at(0)
      .as<Image>()
      ->raster;
}

// The largest change of a colour when the picture is turned back by a quarter: pixel (x, y) of the turned one is (y, 63 - x).
float change_by_quarter_turn(const std::string& method) {
  const Raster a = drawn(method, 0, 0), b = drawn(method, 90, 0);
  float most = 0;
  for (int y = 13; y < 51; ++y)
    for (int x = 13; x < 51; ++x)
      most = std::max(most, std::fabs(a.at<float>(0, 0, x, y) - b.at<float>(0, 0, 63 - y, x)));
  return most;
}

float change_by_first_corner(const std::string& method) {
  const Raster a = drawn(method, 0, 0), b = drawn(method, 0, 1);
  float most = 0;
  for (int y = 13; y < 51; ++y)
    for (int x = 13; x < 51; ++x)
      most = std::max(most, std::fabs(a.at<float>(0, 0, x, y) - b.at<float>(0, 0, x, y)));
  return most;
}

const char* const kite = R"(, "corners": [[32, 4], [44, 30], [32, 60], [20, 30]])";

TEST(ShadePolygon, OnlyTheMeanValueDependsOnNeitherTheTurnNorTheOrder) {
  // An upright square is the one quad whose bilinear colours a quarter turn keeps; by 30 degrees they change.
  EXPECT_LT(change_by_quarter_turn("scan_line"), 1e-6F);
  EXPECT_LT(change_by_quarter_turn("fan"), 1e-6F);
  EXPECT_LT(change_by_quarter_turn("mean_value"), 1e-6F);
  EXPECT_LT(change_by_first_corner("scan_line"), 1e-6F);
  EXPECT_GT(change_by_first_corner("fan"), 0.3F) << "the other diagonal";
  EXPECT_LT(change_by_first_corner("mean_value"), 1e-6F);
}

TEST(ShadePolygon, AKiteTurnedByAQuarterHasOtherScanLineColoursAndNoOthers) {
  const std::vector<dvec2> corner{{32, 4}, {44, 30}, {32, 60}, {20, 30}};
  const std::vector<dvec3> color{dvec3(1), dvec3(0), dvec3(0), dvec3(0)};
  const polygon_shading::Polygon level{corner, color},
      turned = polygon_shading::turned(level, std::numbers::pi / 2, 0);
  const dvec2 middle(32, 31);
  double scanned = 0, fanned = 0, smooth = 0;
  for (double y = 6; y < 58; y += 1.37)
    for (double x = 21; x < 43; x += 1.13) {
      const dvec2 p(x, y), q = middle + dvec2(-(y - middle.y), x - middle.x);
      const auto a = kernels::scan_line_color(level.view(), p),
                 b = kernels::scan_line_color(turned.view(), q);
      if (!a || !b) continue;
      scanned = std::max(scanned, std::fabs(a->x - b->x));
      const auto f = kernels::fan_color(level.view(), p), g = kernels::fan_color(turned.view(), q);
      if (f && g) fanned = std::max(fanned, std::fabs(f->x - g->x));
      smooth = std::max(smooth, std::fabs(kernels::mean_value_color(level.view(), p).x -
                                          kernels::mean_value_color(turned.view(), q).x));
    }
  EXPECT_GT(scanned, 0.1);
  EXPECT_LT(fanned, 1e-12);
  EXPECT_LT(smooth, 1e-12);
}

TEST(ShadePolygon, ATriangleIsTheSameByEveryMethodHoweverItLies) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> at(0, 64), share(0.05, 1);
  const std::vector<dvec3> color{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 200; ++i) {
    const std::vector<dvec2> corner{
        {at(random), at(random)}, {at(random), at(random)}, {at(random), at(random)}};
    const double area = kernels::difference_of_products(corner[1].x - corner[0].x, corner[2].y - corner[0].y,
                                                        corner[2].x - corner[0].x, corner[1].y - corner[0].y);
    if (std::fabs(area) < 50) continue;
    double a = share(random), b = share(random), c = share(random);
    const double sum = a + b + c;
    a /= sum, b /= sum, c /= sum;
    const dvec2 p = corner[0] * a + corner[1] * b + corner[2] * c;
    const ColoredPolygon polygon{corner, color};
    for (const auto& got : {kernels::scan_line_color(polygon, p).value(),
                            kernels::fan_color(polygon, p).value(), kernels::mean_value_color(polygon, p)}) {
      EXPECT_NEAR(got.x, a, 1e-11);
      EXPECT_NEAR(got.y, b, 1e-11);
      EXPECT_NEAR(got.z, c, 1e-11);
    }
  }
}

TEST(ShadePolygon, SidesAndCornersKeepTheirColours) {
  const std::vector<dvec2> corner{{10, 10}, {50, 14}, {54, 50}, {30, 60}, {8, 40}};
  const std::vector<dvec3> color{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}};
  const ColoredPolygon polygon{corner, color};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(kernels::mean_value_color(polygon, corner[i]), color[i]);
    const dvec2 middle = (corner[i] + corner[(i + 1) % 5]) * 0.5;
    const dvec3 want = (color[i] + color[(i + 1) % 5]) * 0.5,
                got = kernels::mean_value_color(polygon, middle);
    EXPECT_LT(kernels::norm(got - want), 1e-12);
  }
}

TEST(ShadePolygon, AllMethodsFillTheSameSamples) {
  for (const double turn : {0.0, 17.0, 45.0, 90.0}) {
    const Raster a = drawn("scan_line", turn, 0, kite), b = drawn("fan", turn, 1, kite),
                 c = drawn("mean_value", turn, 2, kite);
    int inside = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const float alpha = a.at<float>(3, 0, x, y);
        EXPECT_EQ(alpha, b.at<float>(3, 0, x, y));
        EXPECT_EQ(alpha, c.at<float>(3, 0, x, y));
        inside += alpha > 0;
      }
    EXPECT_NEAR(inside, 24 * 56 / 2, 30) << "the kite's area";
  }
}

TEST(ShadePolygon, WhatIsNoPolygonIsRefused) {
  const auto code = [](const std::string& params) {
    try {
      test::run_geometry(nodes::shade_polygon(), params, {});
    } catch (const NodeError& e) {
      return e.code + " " + e.part;
    }
    return std::string("none");
  };
  EXPECT_EQ(code(R"({"corners": [[1, 1], [2, 2]]})"), "no_plane /params/corners");
  EXPECT_EQ(code(R"({"colors": [[1, 1, 1]]})"), "rows_differ /params/colors");
}

}  // namespace
}  // namespace frustum
