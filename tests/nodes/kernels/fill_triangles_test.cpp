#include "nodes/kernels/fill_triangles.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/nodes/kernels/screen_scene.h"
#include "tests/support/simd_targets.h"

namespace frustum {
namespace {

using kernels::DepthOrder;
using kernels::no_face;
using kernels::PixelRect;
using test::fill;
using test::Filled;
using test::Pattern;
using test::ScreenScene;
using test::Twin;

// --- Scenes
// -------------------------------------------------------------------------------------------------

// A planar mesh that covers far more than [0, columns * cell.x] x [0, rows * cell.y]: jittered cells with
// random diagonals and windings, some corners on sample points, framed by huge triangles.
template <class R>
ScreenScene<R> sheet(test::Random& random, const Pattern& pattern, int columns, int rows, glm::dvec2 cell,
                     double jitter) {
  ScreenScene<R> s;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      double x = (i + random.uniform(-jitter, jitter)) * cell.x,
             y = (j + random.uniform(-jitter, jitter)) * cell.y;
      if (random.below(3) == 0 && jitter > 0 && std::min(cell.x, cell.y) > 4) {
        const std::size_t k = pattern.view().index(0, static_cast<int>(x), static_cast<int>(y));
        x = std::floor(x) + (pattern.x[k] >> 4) / 256.0, y = std::floor(y) + (pattern.y[k] >> 4) / 256.0;
      }
      if (i == 0) x = -2e6;
      if (i == columns) x = 2e6;
      if (j == 0) y = -2e6;
      if (j == rows) y = 2e6;
      s.vertex(x, y, 0.5);
    }
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows); ++j)
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(columns); ++i) {
      const auto w = static_cast<std::uint32_t>(columns + 1), a = j * w + i, b = a + 1, c = a + w, d = c + 1;
      const bool flip = random.below(2) == 0;
      std::array<glm::uvec3, 2> faces = random.below(2) == 0
                                            ? std::array{glm::uvec3(a, b, c), glm::uvec3(b, d, c)}
                                            : std::array{glm::uvec3(a, b, d), glm::uvec3(a, d, c)};
      for (glm::uvec3& f : faces) s.face.push_back(flip ? glm::uvec3(f.z, f.y, f.x) : f);
    }
  return s;
}

// Triangles of all sizes, many with trouble: slivers, corners on samples, huge, out of range, coplanar,
// shared.
template <class R>
ScreenScene<R> trouble(test::Random& random, int triangles, double extent) {
  ScreenScene<R> s;
  const double bad[] = {NAN, INFINITY, -INFINITY, 2097153, -1e30};
  while (s.face.size() < static_cast<std::size_t>(triangles)) {
    const double x = random.uniform(-10, extent + 10), y = random.uniform(-10, extent + 10);
    const double size = std::exp2(random.uniform(-3, 6));
    const auto corner = [&](double reach) {
      return std::array{x + random.uniform(-reach, reach), y + random.uniform(-reach, reach),
                        random.uniform(-1, 1)};
    };
    switch (random.below(10)) {
      case 0: s.triangle(corner(2e6), corner(2e6), corner(2e6)); break;
      case 1: s.triangle(corner(3000), corner(3000), corner(3000)); break;
      case 2: {  // a sliver a fraction of a pixel wide, at any angle
        const auto a = corner(extent), b = corner(extent);
        s.triangle(
            a, b, {b[0] + random.uniform(-0.02, 0.02), b[1] + random.uniform(-0.02, 0.02), random.uniform()});
        break;
      }
      case 3: {  // corners on pixel centres and grid lines
        auto a = corner(20), b = corner(20), c = corner(20);
        for (auto* p : {&a, &b, &c}) (*p)[0] = std::floor((*p)[0]) + 0.5, (*p)[1] = std::floor((*p)[1]) + 0.5;
        s.triangle(a, b, c);
        break;
      }
      case 4: s.triangle({bad[random.below(5)], 1, 0}, corner(9), corner(9)); break;
      case 5: {  // twice the same plane, so that depths tie
        auto a = corner(size), b = corner(size), c = corner(size);
        a[2] = b[2] = c[2] = 0.25;
        s.triangle(a, b, c);
        s.triangle(b, c, a);
        break;
      }
      case 6: s.triangle(corner(size), corner(size), corner(size)), s.position.back().z = R(1e-42); break;
      default: s.triangle(corner(size), corner(size), corner(size));
    }
  }
  return s;
}

std::vector<Pattern> patterns(test::Random& random) {
  return {Pattern{}, test::random_pattern(random, 1, 1), test::random_pattern(random, 4, 1),
          test::random_pattern(random, 2, 2), test::random_pattern(random, 3, 64)};
}

// --- Coverage
// -----------------------------------------------------------------------------------------------

template <class R>
void expect_covered_once(const ScreenScene<R>& mesh, const Pattern& pattern, PixelRect window, Twin twin) {
  std::vector<int> hits(Filled<R>(window, pattern.samples).id.size());
  for (const glm::uvec3& f : mesh.face) {
    ScreenScene<R> one = mesh;
    one.face = {f};
    const auto out = fill(one, pattern, window, twin);
    for (std::size_t i = 0; i < hits.size(); ++i) hits[i] += out.id[i] == 0;
  }
  EXPECT_EQ(std::count(hits.begin(), hits.end(), 1), static_cast<std::ptrdiff_t>(hits.size()));
}

template <class R>
void expect_meshes_covered_once(Twin twin) {
  test::Random random(11);
  const PixelRect window{0, 0, 70, 66};
  for (const Pattern& pattern : patterns(random)) {
    expect_covered_once(sheet<R>(random, pattern, 6, 6, {12, 11}, 0.3), pattern, window, twin);
    expect_covered_once(sheet<R>(random, pattern, 16, 14, {4.5, 5}, 0.3), pattern, window, twin);
    // Slivers 3 grid steps wide and 70 px long, in both directions: their corners lie on the grid, so none
    // folds over.
    expect_covered_once(sheet<R>(random, pattern, 60, 2, {3 / 256.0, 70}, 0), pattern, window, twin);
    expect_covered_once(sheet<R>(random, pattern, 2, 60, {70, 3 / 256.0}, 0), pattern, window, twin);
  }
}

TEST(FillTriangles, CoversEverySampleOfAMeshOnce) { expect_meshes_covered_once<double>(Twin::scalar); }

TEST(FillTriangles, EdgesThroughPixelCentresGoToOneSide) {
  for (const auto& [a, b] : {std::pair{glm::dvec2(0.5, 0.5), glm::dvec2(32.5, 32.5)},
                             {{8.5, 0}, {8.5, 33}},
                             {{0, 8.5}, {33, 8.5}},
                             {{0.5, 32.5}, {32.5, 16.5}},
                             {{0.5, 32.5}, {32.5, 0.5}},
                             {{16.5, 0.5}, {0.5, 32.5}}}) {
    const glm::dvec2 along = (b - a) * 1000.0, side(-along.y, along.x);
    ScreenScene<float> s;
    const auto p = [&](glm::dvec2 v) {
      return std::array{std::nearbyint(v.x * 256) / 256, std::nearbyint(v.y * 256) / 256, 0.5};
    };
    s.triangle(p(a - along), p(b + along), p(a + side));
    s.triangle(p(b + along), p(a - along), p(a - side));
    expect_covered_once(s, Pattern{}, {0, 0, 33, 33}, Twin::scalar);
  }
}

template <class R>
void expect_exact(const ScreenScene<R>& scene, const Pattern& pattern, PixelRect window, DepthOrder order,
                  Twin twin) {
  const auto out = fill(scene, pattern, window, twin, {}, order);
  const int sign = order == DepthOrder::standard ? 1 : -1;
  std::vector<test::ExactTriangle> exact;
  for (std::size_t f = 0; f < scene.face.size(); ++f) exact.emplace_back(scene, f);
  for (int s = 0; s < pattern.samples; ++s)
    for (int y = window.y0; y < window.y1; ++y)
      for (int x = window.x0; x < window.x1; ++x) {
        const std::size_t k = pattern.view().index(s, x, y), at = out.at(s, x, y);
        const std::int64_t sx = std::int64_t{x} * 4096 + pattern.x[k],
                           sy = std::int64_t{y} * 4096 + pattern.y[k];
        const std::uint32_t seen = out.id[at];
        long double nearest = std::numeric_limits<long double>::infinity();
        for (const test::ExactTriangle& t : exact)
          if (t.covers(sx, sy)) nearest = std::min(nearest, sign * t.depth(sx, sy));
        if (std::isinf(nearest)) {
          ASSERT_EQ(seen, no_face) << x << ", " << y;
          ASSERT_EQ(out.z[at], order == DepthOrder::standard ? R(1) : R(0));
          continue;
        }
        ASSERT_NE(seen, no_face) << x << ", " << y << " sample " << s;
        ASSERT_TRUE(exact[seen].covers(sx, sy)) << "face " << seen << " at " << x << ", " << y;
        // Another face may be seen only where the depths are within the rounding of their planes: 8 roundings
        // of terms that reach the change of depth over the distance of the anchor.
        const auto& f = scene.face[seen];
        R reach = 0;
        for (int c = 0; c < 3; ++c)
          for (const R v : {scene.position[f[c]].x, scene.position[f[c]].y})
            reach = std::max(reach, std::abs(v) + R(window.x1));
        const long double slope = std::fabs(exact[seen].depth(sx + 4096, sy) - exact[seen].depth(sx, sy)) +
                                  std::fabs(exact[seen].depth(sx, sy + 4096) - exact[seen].depth(sx, sy));
        const long double bound = 8 * std::numeric_limits<R>::epsilon() * (1 + 2 * slope * reach);
        ASSERT_NEAR(static_cast<double>(out.z[at]), static_cast<double>(exact[seen].depth(sx, sy)),
                    static_cast<double>(bound))
            << "face " << seen << " at " << x << ", " << y;
        ASSERT_LE(sign * exact[seen].depth(sx, sy), nearest + 2 * bound)
            << "face " << seen << " at " << x << ", " << y;
      }
}

template <class R>
void expect_exact_everywhere(Twin twin) {
  test::Random random(12);
  for (const Pattern& pattern : patterns(random))
    for (const int bits : {8, 6, 4}) {
      auto scene = trouble<R>(random, 60, 70);
      scene.corner_bits = bits;
      expect_exact(scene, pattern, {0, 0, 70, 67}, DepthOrder::standard, twin);
    }
  const Pattern centre;
  for (const PixelRect window :
       {PixelRect{0, 0, 1, 1}, PixelRect{-40, -90, 33, -20}, PixelRect{60, 60, 65, 200}}) {
    expect_exact(trouble<R>(random, 60, 60), centre, window, DepthOrder::standard, twin);
    expect_exact(trouble<R>(random, 60, 60), centre, window, DepthOrder::reversed, twin);
  }
  expect_exact(trouble<R>(random, 300, 4096), centre, {0, 7, 4096, 8}, DepthOrder::standard, twin);
}

TEST(FillTriangles, AgreesWithExactArithmetic) {
  expect_exact_everywhere<double>(Twin::scalar);
  expect_exact_everywhere<float>(Twin::scalar);
}

TEST(FillTriangles, ASliverAcross16384PixelsIsExact) {
  ScreenScene<double> s;
  s.triangle({0, 0, 0}, {16384, 1 / 256.0, 0.5}, {16384, 2 / 256.0, 1});
  s.triangle({0, 1, 0}, {16384, 16384 + 1 / 256.0, 0.5}, {16384, 16384 + 2 / 256.0, 1});
  for (const Pattern& pattern : {Pattern{}, Pattern{1, 1, {7}, {11}}, Pattern{1, 1, {0}, {0}}}) {
    expect_exact(s, pattern, {0, 0, 16384, 2}, DepthOrder::standard, Twin::scalar);
    expect_exact(s, pattern, {9000, 9000, 9060, 9060}, DepthOrder::standard, Twin::scalar);
  }
}

// --- Depth and order
// ----------------------------------------------------------------------------------------

TEST(FillTriangles, TheOrderOfCornersAndFacesChangesNoBit) {
  test::Random random(13);
  auto scene = trouble<float>(random, 80, 64);
  for (std::uint32_t i = 0; i < scene.face.size(); ++i) scene.origin.push_back(i);
  const Pattern pattern = test::random_pattern(random, 2, 1);
  const PixelRect window{0, 0, 64, 64};
  const auto want = fill(scene, pattern, window, Twin::scalar);
  for (int round = 0; round < 5; ++round) {
    auto shuffled = scene;
    for (std::size_t i = shuffled.face.size(); i-- > 1;) {
      const std::size_t j = random.below(i + 1);
      std::swap(shuffled.face[i], shuffled.face[j]);
      std::swap(shuffled.origin[i], shuffled.origin[j]);
      glm::uvec3& f = shuffled.face[i];
      if (random.below(2) == 0) std::swap(f.x, f.z);
      for (std::size_t turn = random.below(3); turn > 0; --turn) f = {f.y, f.z, f.x};
    }
    for (const Twin twin : {Twin::scalar, Twin::vector}) {
      const auto got = fill(shuffled, pattern, window, twin);
      EXPECT_EQ(std::memcmp(got.z.data(), want.z.data(), want.z.size() * sizeof(float)), 0);
      for (std::size_t i = 0; i < want.id.size(); ++i)
        ASSERT_EQ(got.id[i] == no_face ? no_face : shuffled.origin[got.id[i]], want.id[i]);
    }
  }
}

TEST(FillTriangles, EqualDepthsGoToTheLowestOrigin) {
  ScreenScene<float> s;
  for (int i = 0; i < 4; ++i) s.triangle({0, 0, 0.5}, {40, 0, 0.5}, {0, 40, 0.5});
  s.origin = {9, 4, 4, 8};
  for (const Twin twin : {Twin::scalar, Twin::vector})
    for (const DepthOrder order : {DepthOrder::standard, DepthOrder::reversed}) {
      const auto out = fill(s, Pattern{}, {0, 0, 32, 32}, twin, {}, order);
      EXPECT_EQ(out.id[out.at(0, 3, 3)], 1U);
    }
}

TEST(FillTriangles, DepthStaysWithinTheCorners) {
  test::Random random(14);
  for (int round = 0; round < 200; ++round) {  // nearly edge-on: the plane climbs 10^7 px deep in one pixel
    const double x = random.uniform(0, 30), y = random.uniform(0, 30), dx = random.uniform(-30, 30),
                 dy = random.uniform(-30, 30);
    ScreenScene<float> s;
    s.triangle({x, y, 0.1}, {x + dx, y + dy, 0.9}, {x + dx / 2 + 0.01, y + dy / 2 + 0.01, 0.5});
    const Pattern pattern = test::random_pattern(random, 8, 1);
    const auto out = fill(s, pattern, {0, 0, 64, 64}, Twin::scalar);
    for (std::size_t i = 0; i < out.id.size(); ++i)
      ASSERT_TRUE(out.id[i] == no_face || (out.z[i] >= 0.1f && out.z[i] <= 0.9f)) << out.z[i];
  }
}

TEST(FillTriangles, WhatLiesAtTheFarPlaneIsSeen) {
  for (const auto& [order, far] : {std::pair{DepthOrder::standard, 1.0f}, {DepthOrder::reversed, 0.0f}}) {
    ScreenScene<float> s;
    s.triangle({0, 0, far}, {40, 0, far}, {0, 40, far});
    for (const Twin twin : {Twin::scalar, Twin::vector}) {
      const auto out = fill(s, Pattern{}, {0, 0, 64, 16}, twin, {}, order);
      EXPECT_EQ(out.id[out.at(0, 3, 3)], 0U);
      EXPECT_EQ(out.id[out.at(0, 60, 15)], no_face);
      EXPECT_EQ(out.z[out.at(0, 60, 15)], far);
    }
  }
}

// --- Tiles and targets
// --------------------------------------------------------------------------------------

std::vector<std::vector<PixelRect>> tilings(test::Random& random, PixelRect window) {
  std::vector<std::vector<PixelRect>> all;
  for (const int edge : {16, 32, 64, 128}) all.push_back(test::tiles(window, edge, edge));
  all.push_back(test::tiles(window, 1, 1));
  all.push_back(test::tiles(window, 7, 5));
  for (int i = 0; i < 4; ++i)
    all.push_back(test::tiles(window, 1 + static_cast<int>(random.below(130)),
                              1 + static_cast<int>(random.below(130))));
  return all;
}

template <class R>
void expect_same_in_any_tiles(Twin twin) {
  test::Random random(15);
  const PixelRect window{-5, 3, 190, 140};
  for (const Pattern& pattern : patterns(random)) {
    const auto scene = trouble<R>(random, 300, 190);
    const auto want = fill(scene, pattern, window, Twin::scalar);
    EXPECT_GT(std::count_if(want.id.begin(), want.id.end(), [](auto id) { return id != no_face; }), 1000);
    EXPECT_TRUE(fill(scene, pattern, window, twin).same_bytes(want));
    for (const auto& rects : tilings(random, window))
      EXPECT_TRUE(fill(scene, pattern, window, twin, rects).same_bytes(want))
          << pattern.samples << " samples, period " << pattern.period << ", tiles of "
          << rects[0].x1 - rects[0].x0;
  }
}

TEST(FillTriangles, AnyTilesGiveTheSameBytes) {
  expect_same_in_any_tiles<float>(Twin::scalar);
  expect_same_in_any_tiles<double>(Twin::scalar);
}

class FillTrianglesSimd : public test::EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, FillTrianglesSimd, test::every_target(), test::target_name);

TEST_P(FillTrianglesSimd, HasTheBytesOfItsTwinInAnyTiles) { expect_same_in_any_tiles<float>(Twin::vector); }
TEST_P(FillTrianglesSimd, CoversEverySampleOfAMeshOnce) { expect_meshes_covered_once<float>(Twin::vector); }

TEST_P(FillTrianglesSimd, HasTheBytesOfItsTwinForDenseMeshes) {
  test::Random random(16);
  const PixelRect window{0, 0, 200, 150};
  for (const Pattern& pattern : patterns(random))
    for (const double cell : {0.4, 1.1, 3.0, 9.0}) {
      const auto size = static_cast<int>(160 / cell);
      auto scene = sheet<float>(random, pattern, size, size, {cell, cell}, 0.4);
      for (auto& p : scene.position) p.z = static_cast<float>(random.uniform(-1, 1));
      for (const DepthOrder order : {DepthOrder::standard, DepthOrder::reversed}) {
        const auto want = fill(scene, pattern, window, Twin::scalar, {}, order);
        EXPECT_TRUE(fill(scene, pattern, window, Twin::vector, {}, order).same_bytes(want))
            << cell << " px cells";
      }
    }
}

// --- Where anything is drawn

TEST(DrawnPart, HoldsEverySampleThatIsCovered) {
  test::Random random(31);
  const PixelRect window{-37, 11, 203, 140};
  const Pattern pattern = test::random_pattern(random, 2, 4);
  std::size_t outside = 0, covered = 0, empty = 0;
  for (int n = 0; n < 60; ++n) {
    ScreenScene<float> scene;
    for (std::uint64_t k = random.below(6) + 1; k-- > 0;) {
      const double size = std::exp2(random.uniform(-1, 7)), x = random.uniform(-37, 203),
                   y = random.uniform(11, 140);
      std::array<std::array<double, 3>, 3> corner{};
      for (auto& c : corner) c = {x + random.uniform(-size, size), y + random.uniform(-size, size), 0.5};
      scene.triangle(corner[0], corner[1], corner[2]);
    }
    const auto seen = fill(scene, pattern, window, Twin::scalar);
    const kernels::TriangleBins bins = kernels::bin_triangles(scene.view(), pattern.view(), window);
    for (int r = 0; r < 20; ++r) {
      const int x0 = static_cast<int>(random.uniform(-37, 202)),
                y0 = static_cast<int>(random.uniform(11, 139));
      const PixelRect rect{x0, y0, std::min(203, x0 + 1 + static_cast<int>(random.below(150))),
                           std::min(140, y0 + 1 + static_cast<int>(random.below(100)))};
      const PixelRect part = kernels::drawn_part(bins, rect);
      empty += part.empty();
      for (int y = rect.y0; y < rect.y1; ++y)
        for (int x = rect.x0; x < rect.x1; ++x)
          for (int k = 0; k < 2; ++k) {
            if (seen.id[seen.at(k, x, y)] == no_face) continue;
            ++covered;
            outside += x < part.x0 || x >= part.x1 || y < part.y0 || y >= part.y1;
          }
    }
  }
  EXPECT_EQ(outside, 0U);
  EXPECT_GT(covered, 100'000U);
  EXPECT_GT(empty, 100U) << "and says where there is nothing";
}

// Two boxes in four bins, seen through rectangles that cut them.
TEST(DrawnPart, IsTheSmallestRectangleAroundTheBoxes) {
  ScreenScene<float> scene;
  scene.triangle({50, 60, 0.5}, {90, 60, 0.5}, {50, 70, 0.5});
  scene.triangle({130, 100, 0.5}, {131, 100, 0.5}, {130, 101, 0.5});
  const Pattern pattern;
  const auto bins = kernels::bin_triangles(scene.view(), pattern.view(), PixelRect{0, 0, 256, 192});
  const auto part = [&](PixelRect rect) { return kernels::drawn_part(bins, rect); };
  EXPECT_EQ(part({0, 0, 256, 192}), (PixelRect{50, 60, 131, 101}));
  EXPECT_EQ(part({0, 0, 100, 192}), (PixelRect{50, 60, 90, 70}));
  EXPECT_EQ(part({60, 64, 70, 66}), (PixelRect{60, 64, 70, 66}));
  EXPECT_TRUE(part({0, 0, 50, 192}).empty());
  EXPECT_TRUE(part({90, 0, 130, 192}).empty());
  EXPECT_TRUE(part({132, 0, 256, 192}).empty());
}

}  // namespace
}  // namespace frustum
