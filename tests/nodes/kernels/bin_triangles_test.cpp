#include "nodes/kernels/bin_triangles.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <limits>

#include "tests/nodes/kernels/screen_scene.h"

namespace frustum {
namespace {

using kernels::BinEntry;
using kernels::PixelRect;
using kernels::TriangleBins;
using test::ScreenScene;

ScreenScene<float> random_scene(std::uint64_t seed, int triangles, double size_px, double width,
                                double height) {
  test::Random random(seed);
  ScreenScene<float> s;
  for (int i = 0; i < triangles; ++i) {
    const double x = random.uniform(-50, width + 50), y = random.uniform(-50, height + 50);
    const auto corner = [&] {
      return std::array{x + random.uniform(-size_px, size_px), y + random.uniform(-size_px, size_px),
                        random.uniform()};
    };
    s.triangle(corner(), corner(), corner());
  }
  return s;
}

TEST(BinTriangles, BinsAreTheSameForAnyNumberOfThreads) {
  const auto scene = random_scene(1, 40000, 30, 1920, 1080);
  const test::Pattern pattern;
  const auto with_threads = [&](int n) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(n));
    tbb::task_arena arena(n);
    return arena.execute([&] {
      return kernels::bin_triangles(scene.view(), pattern.view(), PixelRect{0, 0, 1920, 1080});
    });
  };
  const TriangleBins one = with_threads(1);
  EXPECT_GT(one.entries.size(), 40000U);
  for (const int n : {2, 7}) {
    const TriangleBins many = with_threads(n);
    EXPECT_EQ(many.first, one.first) << n;
    EXPECT_EQ(many.entries, one.entries) << n;
  }
}

TEST(BinTriangles, EveryCoveredPixelFindsItsTriangleInItsBin) {
  const PixelRect window{-37, 11, 203, 140};
  for (const double size : {0.6, 5.0, 90.0, 1e5}) {
    const auto scene = random_scene(2, 300, size, 200, 150);
    test::Random random(3);
    const auto pattern = test::random_pattern(random, 2, 4);
    const TriangleBins bins = kernels::bin_triangles(scene.view(), pattern.view(), window);
    for (std::uint32_t f = 0; f < scene.face.size(); ++f) {
      const test::ExactTriangle exact(scene, f);
      for (int y = window.y0; y < window.y1; ++y)
        for (int x = window.x0; x < window.x1; ++x)
          for (int s = 0; s < pattern.samples; ++s) {
            const std::size_t k = pattern.view().index(s, x, y);
            if (!exact.covers(x * 4096 + pattern.x[k], y * 4096 + pattern.y[k])) continue;
            const int u = x - window.x0, v = y - window.y0;
            const auto bin = bins.bin(u / 64, v / 64);
            const auto found =
                std::find_if(bin.begin(), bin.end(), [f](const BinEntry& e) { return e.face == f; });
            ASSERT_NE(found, bin.end()) << "face " << f << " pixel " << x << ", " << y;
            ASSERT_TRUE(found->x0 <= u % 64 && u % 64 <= found->x1 && found->y0 <= v % 64 &&
                        v % 64 <= found->y1);
          }
    }
  }
}

TEST(BinTriangles, ALargeTriangleStaysOutOfTheBinsBeyondItsEdges) {
  ScreenScene<float> s;
  s.triangle({0, 0, 0}, {1024, 0, 0}, {0, 1024, 0});
  const test::Pattern pattern;
  const TriangleBins bins = kernels::bin_triangles(s.view(), pattern.view(), PixelRect{0, 0, 1024, 1024});
  EXPECT_EQ(bins.columns, 16);
  EXPECT_EQ(bins.entries.size(), 16U * 17 / 2);  // the diagonal and what is above it
}

TEST(BinTriangles, LeavesOutWhatMissesAllSamples) {
  ScreenScene<float> s;
  s.triangle({10.6, 10.1, 0}, {11.4, 10.1, 0}, {11, 10.9, 0});    // between two columns of pixel centres
  s.triangle({10.1, 10.6, 0}, {10.9, 10.6, 0}, {10.5, 11.4, 0});  // between two rows
  const test::Pattern centre, corner{1, 1, {4095}, {2048}};
  const PixelRect window{0, 0, 64, 64};
  EXPECT_EQ(kernels::bin_triangles(s.view(), centre.view(), window).entries.size(), 0U);
  EXPECT_EQ(kernels::bin_triangles(s.view(), corner.view(), window).entries.size(), 1U);
}

TEST(BinTriangles, CountsWhatCannotBeDrawn) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   inf = std::numeric_limits<double>::infinity();
  ScreenScene<double> s;
  for (const double bad : {nan, inf, -inf, 2097153.0, -3e9}) {
    s.triangle({bad, 1, 0}, {9, 1, 0}, {1, 9, 0});
    s.triangle({1, 1, 0}, {9, bad, 0}, {1, 9, 0});
  }
  for (const double bad : {nan, inf, -inf}) s.triangle({1, 1, 0}, {9, 1, 0}, {1, 9, bad});
  s.triangle({1, 1, 0}, {5, 5, 0}, {9, 9, 0});
  s.triangle({1, 1, 0}, {1.001, 1, 0}, {1, 1.001, 0});  // gone once its corners are snapped
  s.triangle({1, 1, 0}, {9, 1, 0}, {1, 9, 0});
  s.vertex(0, 0, 0, nan);
  s.face.emplace_back(0, 1, static_cast<std::uint32_t>(s.position.size() - 1));
  const test::Pattern pattern;
  const TriangleBins bins = kernels::bin_triangles(s.view(), pattern.view(), PixelRect{0, 0, 64, 64});
  EXPECT_EQ(bins.out_of_range, 14U);
  EXPECT_EQ(bins.without_area, 2U);
  ASSERT_EQ(bins.entries.size(), 1U);
  EXPECT_EQ(bins.entries[0].face, 15U);
}

TEST(BinTriangles, DrawsByOriginThenFace) {
  ScreenScene<float> s;
  for (int i = 0; i < 5; ++i) s.triangle({1, 1, 0}, {9, 1, 0}, {1, 9, 0});
  s.origin = {7, 3, 7, 1, 3};
  const test::Pattern pattern;
  const TriangleBins bins = kernels::bin_triangles(s.view(), pattern.view(), PixelRect{0, 0, 64, 64});
  std::vector<std::uint32_t> faces;
  for (const BinEntry& e : bins.entries) faces.push_back(e.face);
  EXPECT_EQ(faces, (std::vector<std::uint32_t>{3, 1, 4, 0, 2}));
}

TEST(BinTriangles, AWindowOf65536PixelsKeepsItsEnds) {
  ScreenScene<float> s;
  s.triangle({65530, 65530, 0}, {65540, 65530, 0}, {65530, 65540, 0});
  s.triangle({-1e6, -1e6, 0}, {2e6, -1e6, 0}, {-1e6, 2e6, 0});
  const test::Pattern pattern;
  const TriangleBins bins = kernels::bin_triangles(s.view(), pattern.view(), PixelRect{0, 0, 65536, 65536});
  const auto last = bins.bin(1023, 1023);
  ASSERT_EQ(last.size(), 2U);
  EXPECT_EQ(last[0], (BinEntry{0, 58, 58, 63, 63}));
  EXPECT_EQ(last[1], (BinEntry{1, 0, 0, 63, 63}));
  EXPECT_EQ(bins.bin(0, 0).size(), 1U);
}

}  // namespace
}  // namespace frustum
