#include "nodes/visibility/scanline.h"

#include <gtest/gtest.h>

#include "tests/nodes/visibility/scenes.h"

namespace frustum {
namespace {

TEST(VisibilityScanline, ShowsTheDepthBuffersPicture) {
  for (const int tile : {0, 5}) {
    const auto show = [&](const Buffer& mesh, const Buffer& pattern, Precision precision) {
      return test::shown(nodes::visibility_scanline(), {{mesh}, {pattern}}, precision, tile);
    };
    test::expect_depth_buffer<float>(Precision::single, 6, show);
    test::expect_depth_buffer<double>(Precision::real_double, 6, show);
  }
}

// Corners on the line of samples and horizontal edges, the middle of pixels: hard cases SCN-02 and SCN-03.
TEST(VisibilityScanline, TakesCornersOnTheLineAndHorizontalEdges) {
  test::ScreenMeshMaker<float> m;
  for (int k = 0; k < 6; ++k) {
    const double x = 0.5 + 15 * k, y = 0.5 + 7 * k;
    const auto a = m.vertex(x, y, 0.1 * k), b = m.vertex(x + 20, y, 0.5), c = m.vertex(x + 10, y + 13, 0.2),
               d = m.vertex(x + 10, y - 9, 0.3);
    m.face.emplace_back(a, b, c), m.face.emplace_back(a, d, b);
  }
  const Buffer mesh = test::buffer_of(m.make(test::scene_size));
  const Raster want = test::shown(nodes::rasterize_triangles(), {{mesh}, {}}, Precision::single);
  const Raster got = test::shown(nodes::visibility_scanline(), {{mesh}, {}}, Precision::single);
  EXPECT_EQ(test::differences(want, got), 0);
}

TEST(VisibilityScanline, ComparesOnlyWhereSpansOverlap) {
  test::ScreenMeshMaker<float> m;
  for (int k = 0; k < 3; ++k) {
    const auto a = m.vertex(30 * k, 0, 0.5), b = m.vertex(30 * k + 20, 0, 0.25),
               c = m.vertex(30 * k, 60, 0.5);
    m.face.emplace_back(a, b, c);
  }
  const kernels::ScreenMesh<float> mesh{m.position, m.face, {}};
  const kernels::PixelRect window{0, 0, 96, 64};
  const scanline::Scanner<float> scanner(mesh, kernels::centre_sample(), window,
                                         kernels::DepthOrder::standard, {});
  std::vector<std::uint32_t> id(96 * 64);
  std::vector<float> z(96 * 64);
  scanline::Counts counts;
  scanner.fill(window, {id.data(), 96, 0}, {z.data(), 96, 0}, {&counts, {}});
  EXPECT_EQ(counts.lines, 64U);
  EXPECT_EQ(counts.spans, counts.segments);
  EXPECT_EQ(counts.comparisons, 0U);
  EXPECT_EQ(counts.most_active, 1U);
}

// A small face behind a large one makes no segments of its own; one that sticks out does where it does.
TEST(VisibilityScanline, LeavesOutWhatBeginsBehindASpanThatOutlastsIt) {
  for (const bool first : {false, true}) {  // in whichever order they come
    test::ScreenMeshMaker<float> m;
    const auto put = [&](double x0, double x1, double z) {
      const auto a = m.vertex(x0, 0, z), b = m.vertex(x1, 0, z), c = m.vertex(x0, 640, z);
      m.face.emplace_back(a, b, c);
    };
    if (first) put(20, 60, 0.5);
    put(10, 80, 0.25);  // at the middle of line 10 up to 78.9
    if (!first) put(20, 60, 0.5);
    put(70, 90, 0.75);  // and 89.7
    const kernels::PixelRect window{0, 0, 96, 64};
    const scanline::Scanner<float> scanner({m.position, m.face, {}}, kernels::centre_sample(), window,
                                           kernels::DepthOrder::standard, {});
    std::vector<std::uint32_t> id(96 * 64);
    std::vector<float> z(96 * 64);
    scanline::Counts counts;
    std::vector<scanline::Segment> line;
    scanner.fill(window, {id.data(), 96, 0}, {z.data(), 96, 0}, {&counts, [&](const scanline::Segment& s) {
                                                                   if (s.row == 10) line.push_back(s);
                                                                 }});
    ASSERT_EQ(line.size(), 3U);
    const int begin[3] = {10, 70, 79};
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(line[i].begin, begin[i]);
    EXPECT_EQ(line.back().end, 90);
    for (int x = 0; x < 96; ++x)
      EXPECT_EQ(z[10 * 96 + static_cast<std::size_t>(x)], x < 10 || x >= 90 ? 1
                                                          : x < 79          ? 0.25F
                                                                            : 0.75F)
          << x;
  }
}

}  // namespace
}  // namespace frustum
