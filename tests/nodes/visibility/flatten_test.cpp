#include "nodes/visibility/flatten.h"

#include "nodes/visibility.h"
#include "runtime/buffers/fragments.h"
#include "runtime/buffers/image.h"
#include "tests/support/tiles.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace frustum {
namespace {

Fragments lists_of(std::vector<std::uint64_t> first, int width, std::array<std::vector<float>, 4> rgba) {
  const auto lists = static_cast<int>(first.size()) - 1;
  Fragments f{.window = {0, 0, width, lists / width}, .first = std::move(first), .color_space = "lin_rec709"};
  constexpr std::array names{"R", "G", "B", "A"};
  for (std::size_t c = 0; c < 4; ++c)
    if (!rgba[c].empty() || f.count() == 0)
      f.channels.push_back(Column::make<float>(names[c], Domain::vertex, std::span<const float>(rgba[c])));
  return f;
}

test::PixelRun run_of(Fragments f) {
  return test::PixelRun(nodes::visibility_flatten(), "{}",
                        {{"fragments", {Ref<Fragments>(std::make_shared<const Fragments>(std::move(f)))}}});
}

TEST(VisibilityFlatten, PutsEachListOverOneAnother) {
  // Nothing; opaque; half red over half green over opaque blue.
  const Raster r =
      run_of(lists_of({0, 0, 1, 4}, 3,
                      {{{0.25F, 0.5F, 0, 0}, {0.75F, 0, 0.5F, 0}, {1, 0, 0, 1}, {1, 0.5F, 0.5F, 1}}}))
          .whole();
  const float want[3][4] = {{0, 0, 0, 0}, {0.25F, 0.75F, 1, 1}, {0.5F, 0.25F, 0.25F, 1}};
  for (int x = 0; x < 3; ++x)
    for (int c = 0; c < 4; ++c) EXPECT_EQ(r.at<float>(c, 0, x, 0), want[x][c]) << x << " " << c;
  EXPECT_EQ(r.frame().color_space, "lin_rec709");
  EXPECT_EQ(r.frame().alpha, Alpha::premultiplied);
}

TEST(VisibilityFlatten, WithoutAlphaTheFirstFragmentIsSeen) {
  const Raster r = run_of(lists_of({0, 2}, 1, {{{0.25F, 0.5F}, {0.75F, 0}, {1, 0}, {}}})).whole();
  const float want[4] = {0.25F, 0.75F, 1, 1};
  for (int c = 0; c < 4; ++c) EXPECT_EQ(r.at<float>(c, 0, 0, 0), want[c]);
}

// Both directions of a list of a thousand thin layers, against more digits than either has.
TEST(VisibilityFlatten, AThousandLayersAreExactToHalfAnUlp) {
  test::Random random(7);
  std::array<std::vector<float>, 4> rgba;
  for (int i = 0; i < 1000; ++i) {
    const auto a = static_cast<float>(random.uniform(0, 2e-3));
    for (std::size_t c = 0; c < 3; ++c) rgba[c].push_back(a * static_cast<float>(random.uniform()));
    rgba[3].push_back(a);
  }
  const Raster r = run_of(lists_of({0, 1000}, 1, rgba)).whole();
  for (std::size_t c = 0; c < 4; ++c) {
    long double want = 0;
    for (std::size_t i = 1000; i-- > 0;)
      want = rgba[c][i] + (1 - static_cast<long double>(rgba[3][i])) * want;
    EXPECT_LE(test::ulps(r.at<float>(static_cast<int>(c), 0, 0, 0), want), 0.501);
  }
}

TEST(VisibilityFlatten, KeepsTheLawOfTiles) {
  test::Random random(2);
  std::vector<std::uint64_t> first{0};
  for (int i = 0; i < 37 * 23; ++i) first.push_back(first.back() + random.below(4));
  std::array<std::vector<float>, 4> rgba;
  for (std::uint64_t i = 0; i < first.back(); ++i)
    for (auto& channel : rgba) channel.push_back(static_cast<float>(random.uniform()));
  EXPECT_EQ(test::break_of_tile_law(run_of(lists_of(first, 37, rgba))), "");
}

TEST(VisibilityFlatten, ColoursAreNeeded) {
  Fragments f{.window = {0, 0, 1, 1}, .first = {0, 0}};
  f.channels = {Column::make<float>("Z", Domain::vertex, 0)};
  try {
    run_of(f);
    ADD_FAILURE() << "there are no colours";
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "missing_plane");
  }
}

}  // namespace
}  // namespace frustum
