#include "nodes/kernels/fragment_layers.h"

#include "nodes/kernels/fragment_counts.h"
#include "nodes/kernels/simd/fragment_layers.h"
#include "tests/nodes/kernels/screen_scene.h"
#include "tests/support/simd_targets.h"

#include <gtest/gtest.h>

#include <limits>

namespace frustum {
namespace {

using kernels::DepthOrder;
using kernels::no_face;
using kernels::PixelRect;
using test::Filled;
using test::Pattern;
using test::Random;
using test::ScreenScene;
using test::Twin;

constexpr PixelRect window{0, 0, 71, 67};

// Triangles over one another, of all sizes, many of them in the same plane.
template <class R>
ScreenScene<R> heap(Random& random, int triangles) {
  ScreenScene<R> s;
  for (int i = 0; i < triangles; ++i) {
    const double size = std::exp2(random.uniform(0, 7)), x = random.uniform(-5, 75),
                 y = random.uniform(-5, 75);
    const bool flat = random.below(3) == 0;
    const auto corner = [&] {
      return std::array{x + random.uniform(-size, size), y + random.uniform(-size, size),
                        flat ? 0.25 * static_cast<double>(random.below(3)) : random.uniform(0, 1)};
    };
    auto a = corner(), b = corner(), c = corner();
    if (flat) b[2] = c[2] = a[2];
    s.triangle(a, b, c);
    if (random.below(6) == 0) s.triangle(c, a, b);
  }
  for (std::size_t i = 0; i < s.face.size(); ++i)
    s.origin.push_back(static_cast<std::uint32_t>(random.below(40)));
  return s;
}

struct Fragment {
  double z;  // ascending is nearest first
  std::uint32_t origin, face;
  auto key() const { return std::tuple(z, origin, face); }
};

// Each face drawn by itself as a z-buffer has it, and what covers a sample put in order.
template <class R>
std::vector<std::vector<Fragment>> lists_of(const ScreenScene<R>& scene, const Pattern& pattern,
                                            DepthOrder order, const std::vector<std::uint8_t>& hides) {
  const double sign = order == DepthOrder::standard ? 1 : -1;
  std::vector<std::vector<Fragment>> lists(Filled<R>(window, pattern.samples).id.size());
  for (std::size_t f = 0; f < scene.face.size(); ++f) {
    ScreenScene<R> one = scene;
    one.face = {scene.face[f]}, one.origin = {0};
    const Filled<R> seen = test::fill(one, pattern, window, Twin::scalar, {}, order);
    for (std::size_t i = 0; i < lists.size(); ++i)
      if (seen.id[i] == 0)
        lists[i].push_back(
            {sign * static_cast<double>(seen.z[i]), scene.origin[f], static_cast<std::uint32_t>(f)});
  }
  for (auto& list : lists) {
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.key() < b.key(); });
    for (std::size_t i = 0; i < list.size() && !hides.empty(); ++i)
      if (hides[list[i].face] != 0) list.resize(i + 1);
  }
  return lists;
}

template <class R>
Filled<R> fill_layers(const ScreenScene<R>& scene, const Pattern& pattern, int layers, Twin twin,
                      DepthOrder order, const std::vector<std::uint8_t>& hides,
                      const std::vector<PixelRect>& rects) {
  const auto bins = kernels::bin_triangles(scene.view(), pattern.view(), window);
  const kernels::FragmentScene<R> from{{scene.view(), pattern.view(), &bins, order}, hides};
  Filled<R> out(window, pattern.samples * layers);
  const auto pixels = static_cast<std::size_t>(out.width() * out.height() * pattern.samples);
  std::vector<std::uint32_t> count(pixels);
  std::vector<R> cut(pixels), depth(pixels);
  for (const PixelRect& rect : rects) {
    const kernels::FragmentLayers<R> to{out.plane(out.id, rect), out.plane(out.z, rect), layers};
    const kernels::FragmentScratch<R> scratch{count.data(), hides.empty() ? nullptr : cut.data(),
                                              depth.data()};
    if constexpr (std::is_same_v<R, float>)
      if (twin == Twin::vector) {
        kernels::simd::fill_fragments(from, rect, to, scratch);
        continue;
      }
    kernels::fill_fragments<R>(from, rect, to, scratch);
  }
  return out;
}

template <class R>
kernels::FragmentCounts count_all(const ScreenScene<R>& scene, const Pattern& pattern, Twin twin,
                                  DepthOrder order, const std::vector<std::uint8_t>& hides,
                                  std::uint32_t limit) {
  const auto bins = kernels::bin_triangles(scene.view(), pattern.view(), window);
  const kernels::FragmentScene<R> from{{scene.view(), pattern.view(), &bins, order}, hides};
  kernels::FragmentCounts sum;
  for (int row = 0; row < bins.rows; ++row)
    for (int column = 0; column < bins.columns; ++column) {
      kernels::FragmentCounts n;
      if constexpr (std::is_same_v<R, float>)
        n = twin == Twin::vector ? kernels::simd::count_fragments(from, column, row, limit)
                                 : kernels::count_fragments<R>(from, column, row, limit);
      else
        n = kernels::count_fragments<R>(from, column, row, limit);
      sum.most = std::max(sum.most, n.most), sum.fragments += n.fragments, sum.beyond += n.beyond;
    }
  return sum;
}

std::vector<std::vector<std::uint8_t>> kinds_of_hiding(Random& random, std::size_t faces) {
  std::vector<std::uint8_t> some(faces);
  for (auto& h : some) h = random.below(4) == 0 ? 1 : 0;
  return {{}, some, std::vector<std::uint8_t>(faces, 1)};
}

template <class R>
void expect_lists(Twin twin) {
  Random random(5);
  for (const Pattern& pattern :
       {Pattern{}, test::random_pattern(random, 3, 1), test::random_pattern(random, 2, 64)})
    for (const DepthOrder order : {DepthOrder::standard, DepthOrder::reversed}) {
      const ScreenScene<R> scene = heap<R>(random, 60);
      for (const auto& hides : kinds_of_hiding(random, scene.face.size())) {
        const auto lists = lists_of(scene, pattern, order, hides);
        std::size_t most = 0, total = 0, beyond = 0;
        constexpr std::size_t few = 3;
        for (const auto& list : lists) {
          most = std::max(most, list.size()), total += list.size();
          beyond += list.size() > few ? list.size() - few : 0;
        }
        const auto counts = count_all<R>(scene, pattern, twin, order, hides, few);
        EXPECT_EQ(counts.most, most);
        EXPECT_EQ(counts.fragments, total);
        EXPECT_EQ(counts.beyond, beyond);
        for (const int layers : {1, static_cast<int>(few), static_cast<int>(most) + 1}) {
          const auto got = fill_layers<R>(scene, pattern, layers, twin, order, hides, {window});
          const std::size_t all = lists.size();
          for (std::size_t i = 0; i < all; ++i)
            for (int layer = 0; layer < layers; ++layer) {
              const auto l = static_cast<std::size_t>(layer);
              const bool there = l < lists[i].size();
              ASSERT_EQ(got.id[l * all + i], there ? lists[i][l].face : no_face) << i << " layer " << layer;
              const double sign = order == DepthOrder::standard ? 1 : -1,
                           far = order == DepthOrder::standard ? 1 : 0;
              ASSERT_EQ(got.z[l * all + i], static_cast<R>(there ? sign * lists[i][l].z : far)) << i;
            }
        }
      }
    }
}

template <class R>
void expect_same_in_any_tiles(Twin twin) {
  Random random(9);
  for (const Pattern& pattern : {test::random_pattern(random, 2, 1), test::random_pattern(random, 2, 2)}) {
    const ScreenScene<R> scene = heap<R>(random, 40);
    for (const auto& hides : kinds_of_hiding(random, scene.face.size())) {
      const auto whole =
          fill_layers<R>(scene, pattern, 7, Twin::scalar, DepthOrder::standard, hides, {window});
      for (const int edge : {1, 5, 16, 41, 64})
        EXPECT_TRUE(fill_layers<R>(scene, pattern, 7, twin, DepthOrder::standard, hides,
                                   test::tiles(window, edge, edge))
                        .same_bytes(whole))
            << edge;
    }
  }
}

TEST(FragmentLayers, AreTheListsOfFacesDrawnOneByOne) { expect_lists<double>(Twin::scalar); }
TEST(FragmentLayers, AnyTilesGiveTheSameBytes) { expect_same_in_any_tiles<double>(Twin::scalar); }

TEST(FragmentLayers, TheFirstIsTheZBuffer) {
  Random random(3);
  const Pattern pattern = test::random_pattern(random, 4, 1);
  const ScreenScene<float> scene = heap<float>(random, 80);
  const auto nearest = test::fill(scene, pattern, window, Twin::vector);
  for (const auto& hides : kinds_of_hiding(random, scene.face.size())) {
    const auto got =
        fill_layers<float>(scene, pattern, 1, Twin::vector, DepthOrder::standard, hides, {window});
    EXPECT_TRUE(got.same_bytes(nearest));
  }
}

// A row of pixels against the edge function at each of them, with edges of all slopes and far corners.
TEST(FragmentLayers, SpansOfARowAreExact) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    const double reach = std::exp2(random.uniform(0, 28));
    const auto point = [&] {
      return kernels::GridPoint{static_cast<std::int32_t>(random.uniform(-reach, reach)),
                                static_cast<std::int32_t>(random.uniform(-reach, reach))};
    };
    const kernels::Edge e(point(), point());
    const int y = static_cast<int>(random.below(100)), x0 = static_cast<int>(random.below(100));
    const int ox = static_cast<int>(random.below(4096)), oy = static_cast<int>(random.below(4096));
    const kernels::PixelRect box{x0, y, x0 + 60, y + 3};
    kernels::RowSpans spans({e, e, e}, ox, oy, box);
    for (int row = y; row < y + 3; ++row) {
      const kernels::PixelSpan span = spans.next();
      for (int x = x0; x < x0 + 60; ++x)
        ASSERT_EQ(x >= span.x0 && x < span.x1,
                  kernels::Edge::covers(e.at_pixel(x, row), e.at_offset(ox, oy)));
    }
  }
}

class FragmentLayersSimd : public test::EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, FragmentLayersSimd, test::every_target(), test::target_name);

TEST_P(FragmentLayersSimd, AreTheListsOfFacesDrawnOneByOne) { expect_lists<float>(Twin::vector); }
TEST_P(FragmentLayersSimd, HaveTheBytesOfTheirTwinInAnyTiles) {
  expect_same_in_any_tiles<float>(Twin::vector);
}

}  // namespace
}  // namespace frustum
