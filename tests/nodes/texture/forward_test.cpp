// texture.forward and the map it shares with texture.inverse, against maps in rationals.
#include "nodes/texture/forward.h"

#include "nodes/texture.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/quad.h"
#include "tests/hard/exact.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace frustum {
namespace {

using hard::Rational;
using kernels::QuadMap, kernels::QuadMapKind;
using Corners = std::array<glm::dvec2, 4>;
constexpr std::array kinds{QuadMapKind::projective, QuadMapKind::bilinear};
using Exact2 = std::array<Rational, 2>;

const Corners trapezium{glm::dvec2{10, 90}, {90, 90}, {60, 20}, {40, 20}},
    leaning{glm::dvec2{5, 70}, {80, 95}, {95, 15}, {20, 5}};

Exact2 exact(const glm::dvec2& p) { return {p.x, p.y}; }
Rational cross(const Exact2& a, const Exact2& b, const Exact2& c) {
  return Rational((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

// The homography by the textbook's system, solved in rationals: x = (a u + b v + c) / (g u + h v + 1).
Exact2 exact_pixel(const Corners& p, const Rational& u, const Rational& v, QuadMapKind kind) {
  if (kind == QuadMapKind::bilinear) {
    Exact2 at;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto k = static_cast<glm::length_t>(i);
      at[i] = (1 - u) * (1 - v) * Rational(p[0][k]) + u * (1 - v) * Rational(p[1][k]) +
              u * v * Rational(p[2][k]) + (1 - u) * v * Rational(p[3][k]);
    }
    return at;
  }
  const auto x = [&](std::size_t i) { return Rational(p[i].x); };
  const auto y = [&](std::size_t i) { return Rational(p[i].y); };
  const Rational dx1 = x(1) - x(2), dx2 = x(3) - x(2), sx = x(0) - x(1) + x(2) - x(3), dy1 = y(1) - y(2),
                 dy2 = y(3) - y(2), sy = y(0) - y(1) + y(2) - y(3), det = dx1 * dy2 - dx2 * dy1;
  const Rational g = (sx * dy2 - dx2 * sy) / det, h = (dx1 * sy - sx * dy1) / det;
  const Rational w = g * u + h * v + 1;
  return {Rational(((x(1) - x(0) + g * x(1)) * u + (x(3) - x(0) + h * x(3)) * v + x(0)) / w),
          Rational(((y(1) - y(0) + g * y(1)) * u + (y(3) - y(0) + h * y(3)) * v + y(0)) / w)};
}

TEST(QuadMap, TakesCornersToCornersAndBackBitForBit) {
  for (const Corners& corners : {trapezium, leaning})
    for (const auto kind : kinds) {
      const auto map = QuadMap::of(corners, kind);
      ASSERT_TRUE(map);
      const std::array<glm::dvec2, 4> uv{glm::dvec2{0, 0}, {1, 0}, {1, 1}, {0, 1}};
      for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(map->pixel_of(uv[i]), corners[i]);
        EXPECT_LE(kernels::largest_component(map->uv_of(corners[i]) - uv[i]), 0x1p-50);
      }
    }
}

TEST(QuadMap, IsTheTextbooksHomographySolvedInRationals) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> in(0, 1), offset(-30, 30);
  int tried = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Corners corners = trapezium;
    for (auto& c : corners) c += glm::dvec2(offset(random), offset(random));
    for (const auto kind : kinds) {
      const auto map = QuadMap::of(corners, kind);
      if (!map) continue;
      ++tried;
      const glm::dvec2 uv(in(random), in(random)), px = map->pixel_of(uv);
      const Exact2 want = exact_pixel(corners, uv.x, uv.y, kind);
      EXPECT_LE(std::fabs(hard::distance(px.x, want[0])) + std::fabs(hard::distance(px.y, want[1])), 1e-13);
      // Back again: what comes out goes to the pixel, exactly worked out, to the last places of the pixel's
      // numbers.
      const glm::dvec2 back = map->uv_of(px);
      const Exact2 again = exact_pixel(corners, back.x, back.y, kind);
      EXPECT_LE(std::fabs(hard::distance(px.x, again[0])) + std::fabs(hard::distance(px.y, again[1])), 1e-11);
    }
  }
  EXPECT_GT(tried, 300);
}

TEST(QuadMap, SlopesAreThoseOfTheInverse) {
  constexpr double step = 1e-5;
  for (const Corners& corners : {trapezium, leaning})
    for (const auto kind : kinds) {
      const auto map = QuadMap::of(corners, kind);
      for (const glm::dvec2 uv : {glm::dvec2(0.2, 0.3), glm::dvec2(0.9, 0.8), glm::dvec2(0.5, 0.02)}) {
        const glm::dvec2 px = map->pixel_of(uv);
        const auto s = map->slopes(px, uv);
        const auto by = [&](const glm::dvec2& d) {
          return (map->uv_of(px + d) - map->uv_of(px - d)) / (2 * step);
        };
        const glm::dvec2 x = by({step, 0}), y = by({0, step});
        // Central differences: step^2 times the third derivative, and rounding of uv over the step.
        EXPECT_LE(std::fabs(s.du_dx - x.x) + std::fabs(s.dv_dx - x.y) + std::fabs(s.du_dy - y.x) +
                      std::fabs(s.dv_dy - y.y),
                  1e-9);
      }
    }
}

TEST(QuadMap, OwnsThePointsThatRationalsSay) {
  // Corners on quarter pixels and points on a grid of them: many lie on sides and on corners.
  for (const Corners& corners : {trapezium, leaning, Corners{glm::dvec2{2, 2}, {2, 10}, {10, 10}, {10, 2}}}) {
    const auto map = QuadMap::of(corners, QuadMapKind::projective);
    const bool mirrored = cross(exact(corners[0]), exact(corners[1]), exact(corners[2])) < 0;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x) {
        const glm::dvec2 px(x / 2.0, y / 2.0);
        bool inside = true;
        for (std::size_t i = 0; i < 4; ++i) {
          const glm::dvec2 &a = corners[mirrored ? (i + 1) % 4 : i], &b = corners[mirrored ? i : (i + 1) % 4];
          const Rational side = cross(exact(a), exact(b), exact(px));
          inside = inside && (side > 0 || (side == 0 && (b.y < a.y || (b.y == a.y && b.x > a.x))));
        }
        ASSERT_EQ(map->contains(px), inside) << px.x << " " << px.y;
      }
  }
}

TEST(QuadMap, RefusesWhatIsNotConvex) {
  EXPECT_FALSE(QuadMap::of({glm::dvec2{0, 0}, {1, 0}, {2, 0}, {0, 1}}, QuadMapKind::projective))
      << "three on a line";
  EXPECT_FALSE(QuadMap::of({glm::dvec2{0, 0}, {1, 1}, {1, 0}, {0, 1}}, QuadMapKind::projective))
      << "sides cross";
  EXPECT_FALSE(QuadMap::of({glm::dvec2{0, 0}, {4, 0}, {1, 1}, {0, 4}}, QuadMapKind::bilinear)) << "a dent";
  EXPECT_FALSE(QuadMap::of({glm::dvec2{3, 3}, {3, 3}, {3, 3}, {3, 3}}, QuadMapKind::bilinear));
  EXPECT_FALSE(QuadMap::of({glm::dvec2{0, NAN}, {4, 0}, {4, 4}, {0, 4}}, QuadMapKind::bilinear));
}

// ----- the node

// Every texel its own colour.
Ref<Image> card(int width, int height) {
  Raster r(Frame{.window = {0, 0, width, height},
                 .planes = {{"R"}, {"G"}, {"B"}},
                 .color_space = std::string(linear_rec709)});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      r.view().row<float>(0, 0, y)[x] = static_cast<float>(x);
      r.view().row<float>(1, 0, y)[x] = static_cast<float>(y);
    }
  return std::make_shared<Image>(Image{r});
}
Ref<Points> points(const Corners& corners) {
  auto p = std::make_shared<Points>();
  for (const glm::dvec2& c : corners) p->at.emplace_back(c, 0.0);
  return p;
}
std::map<std::string, double> counts_of(const Table& t) {
  std::map<std::string, double> all;
  for (std::size_t i = 0; i < t.rows(); ++i) all[t.columns[0].texts[i]] = t.columns[1].numbers[i];
  return all;
}

TEST(TextureForward, AMapOfOneTexelAPixelHasNeitherHolesNorOverwrites) {
  const Corners square{glm::dvec2{4, 20}, {20, 20}, {20, 4}, {4, 4}};
  const auto out = test::run_geometry(nodes::texture_forward(), R"({"resolution": [24, 24]})",
                                      {{"image", {card(16, 16)}}, {"corners", {points(square)}}});
  const auto count = counts_of(*out.at(2).as<Table>());
  EXPECT_EQ(count.at("pixels of the quadrilateral"), 256);
  EXPECT_EQ(count.at("holes among them"), 0);
  EXPECT_EQ(count.at("points that overwrote another"), 0);
  const Raster& image = out.at(0).as<Image>()->raster;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      EXPECT_EQ(image.at<float>(0, 0, 4 + x, 4 + y), static_cast<float>(x));
      EXPECT_EQ(image.at<float>(1, 0, 4 + x, 4 + y), static_cast<float>(y)) << "row 0 on top";
    }
}

// Twice as large each way: of four pixels one is reached. Half as large: of four texels three are lost.
TEST(TextureForward, LeavesHolesWhereItMagnifiesAndOverwritesWhereItDoesNot) {
  const auto run = [](double side, const char* params) {
    const Corners square{glm::dvec2{0, side}, {side, side}, {side, 0}, {0, 0}};
    return counts_of(*test::run_geometry(nodes::texture_forward(), params,
                                         {{"image", {card(16, 16)}}, {"corners", {points(square)}}})
                          .at(2)
                          .as<Table>());
  };
  const auto twice = run(32, R"({"resolution": [32, 32]})"),
             dense = run(32, R"({"resolution": [32, 32], "density": 2})"),
             half = run(8, R"({"resolution": [32, 32]})"), beside = run(64, R"({"resolution": [32, 32]})");
  EXPECT_EQ(twice.at("holes among them"), 1024 - 256);
  EXPECT_EQ(twice.at("points that overwrote another"), 0);
  EXPECT_EQ(dense.at("holes among them"), 0);
  EXPECT_EQ(half.at("holes among them"), 0);
  EXPECT_EQ(half.at("points that overwrote another"), 256 - 64);
  EXPECT_EQ(beside.at("points beside the picture"), 256 - 64);
}

// What the course sets against each other: the same pixels, some of them holes one way, none the other.
TEST(TextureForward, HolesAreGoneWhenTheMapIsInverted) {
  for (const Corners& corners : {trapezium, leaning})
    for (const char* map : {"projective", "bilinear"}) {
      const std::string params = std::string(R"({"resolution": [100, 100], "map": ")") + map + "\"}";
      const auto out = test::run_geometry(nodes::texture_forward(), params,
                                          {{"image", {card(32, 32)}}, {"corners", {points(corners)}}});
      const auto count = counts_of(*out.at(2).as<Table>());
      EXPECT_GT(count.at("holes among them"), 100);
      const test::PixelRun inverse(nodes::texture_inverse(), params, {{"corners", {points(corners)}}});
      EXPECT_EQ(test::break_of_tile_law(inverse), "");
      const Raster seen = inverse.whole(), &hits = out.at(1).as<Image>()->raster;
      double pixels = 0, reached = 0;
      for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 100; ++x) {
          const bool inside = seen.at<std::uint32_t>(0, 0, x, y) != no_face;
          pixels += inside ? 1 : 0;
          reached += inside && hits.at<float>(0, 0, x, y) > 0 ? 1 : 0;
        }
      EXPECT_EQ(pixels, count.at("pixels of the quadrilateral"));
      EXPECT_EQ(pixels - reached, count.at("holes among them"));
    }
}

TEST(TextureForward, RefusesCornersThatAreNone) {
  const auto code_of = [](std::vector<glm::dvec3> at, const glm::dmat4* m = nullptr) -> std::string {
    auto p = std::make_shared<Points>();
    p->at = std::move(at);
    test::NodeInputs in{{"image", {card(2, 2)}}, {"corners", {Ref<Points>(p)}}};
    if (m != nullptr) in["matrix"] = {Ref<Matrix>(std::make_shared<Matrix>(Matrix{*m}))};
    try {
      test::run_geometry(nodes::texture_forward(), "{}", in);
    } catch (const NodeError& e) {
      return e.code;
    }
    return "";
  };
  const glm::dmat4 eye(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0);  // w = -z
  EXPECT_EQ(code_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}), "wrong_count");
  EXPECT_EQ(code_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {INFINITY, 1, 0}}), "not_finite");
  EXPECT_EQ(code_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), "not_convex");
  EXPECT_EQ(code_of({{0, 0, -1}, {1, 0, -1}, {1, 1, 1}, {0, 1, 1}}, &eye), "behind_the_eye");
  EXPECT_EQ(code_of({{0, 0, -1}, {1, 0, -1}, {1, 1, -2}, {0, 1, -2}}, &eye), "");
}

}  // namespace
}  // namespace frustum
