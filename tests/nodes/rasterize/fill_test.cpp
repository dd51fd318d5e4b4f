#include "nodes/rasterize/fill.h"

#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/value.h"
#include "tests/support/run_node.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string>

namespace frustum {
namespace {

using fill::Connectivity;
using fill::Filled;

// The oracle: which pixels hang together, by union-find.
class Components {
 public:
  template <class Inside>
  Components(int width, int height, Connectivity connectivity, const Inside& inside)
      : width_(width), parent_(static_cast<std::size_t>(width * height)) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    const bool corners = connectivity == Connectivity::eight;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (!inside(x, y)) continue;
        if (x > 0 && inside(x - 1, y)) join(x, y, x - 1, y);
        if (y > 0 && inside(x, y - 1)) join(x, y, x, y - 1);
        if (corners && y > 0 && x > 0 && inside(x - 1, y - 1)) join(x, y, x - 1, y - 1);
        if (corners && y > 0 && x + 1 < width && inside(x + 1, y - 1)) join(x, y, x + 1, y - 1);
      }
  }
  bool together(int x, int y, int u, int v) { return root(index(x, y)) == root(index(u, v)); }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * width_ + x); }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int x, int y, int u, int v) { parent_[root(index(x, y))] = root(index(u, v)); }
  int width_;
  std::vector<std::size_t> parent_;
};

const auto no_poll = [] {};

TEST(RasterizeFill, FillsTheComponentOfTheSeed) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const int width = 1 + static_cast<int>(random() % 40), height = 1 + static_cast<int>(random() % 40);
    std::vector<bool> open(static_cast<std::size_t>(width * height));
    for (std::size_t i = 0; i < open.size(); ++i)
      open[i] = random() % 100 < 58;  // near the percolation threshold
    const auto inside = [&](int x, int y) { return bool(open[static_cast<std::size_t>(y * width + x)]); };
    const int sx = static_cast<int>(random()) & 63, sy = static_cast<int>(random()) & 63;
    const int x0 = sx % width, y0 = sy % height;
    for (const Connectivity c : {Connectivity::four, Connectivity::eight}) {
      const Filled filled = fill::spans_from(width, height, x0, y0, c, inside, no_poll);
      std::vector<int> times(open.size(), 0);
      for (const fill::Span& s : filled.spans)
        for (int x = s.x0; x < s.x1; ++x) ++times[static_cast<std::size_t>(s.y * width + x)];
      Components components(width, height, c, inside);
      std::uint64_t expected = 0;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const bool hit = inside(x0, y0) && inside(x, y) && components.together(x, y, x0, y0);
          ASSERT_EQ(times[static_cast<std::size_t>(y * width + x)], hit ? 1 : 0) << x << " " << y;
          expected += hit ? 1 : 0;
        }
      EXPECT_EQ(filled.pixels, expected);
    }
  }
}

TEST(RasterizeFill, NeedsNeitherDepthNorSecondLooksInALargeRegion) {
  constexpr int size = 4096;
  const auto all = [](int, int) { return true; };
  const Filled filled = fill::spans_from(size, size, 1234, 777, Connectivity::four, all, no_poll);
  EXPECT_EQ(filled.pixels, std::uint64_t{size} * size);
  EXPECT_LE(filled.tests, 4 * filled.pixels);
  EXPECT_LE(filled.deepest, 4u);
  // A comb, where every tooth waits: still no more spans than teeth.
  const auto comb = [](int x, int y) { return y == 0 || x % 2 == 0; };
  const Filled teeth = fill::spans_from(size, size, 0, 0, Connectivity::four, comb, no_poll);
  EXPECT_EQ(teeth.pixels, std::uint64_t{size} + std::uint64_t{size - 1} * (size / 2));
  EXPECT_LE(teeth.deepest, std::size_t{size});
}

// ----- the node: a picture from rows of letters

Ref<Image> picture(const std::vector<std::string>& rows, const std::map<char, float>& red) {
  const int width = static_cast<int>(rows[0].size()), height = static_cast<int>(rows.size());
  Raster raster(Frame{.window = {0, 0, width, height},
                      .planes = {{"R", PlaneKind::f32}, {"G", PlaneKind::f32}, {"B", PlaneKind::f32}}});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      raster.view().row<float>(0, 0, y)[x] =
          red.at(rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)]);
  return std::make_shared<const Image>(Image{std::move(raster)});
}
double filled_pixels(const Ref<Image>& image, const Json& params) {
  return test::run_node(nodes::rasterize_fill(), params, {{image}}).at(1).as<Number>()->value;
}

const std::map<char, float> inks{
    {'.', 0.0F}, {'#', 1.0F}, {'o', 0.5F}, {'?', std::numeric_limits<float>::quiet_NaN()}};

TEST(RasterizeFill, IsNotStoppedByPixelsThatHaveItsColourAlready) {
  // The course's loop (errata E18) stops at the column of its own colour in the middle.
  const auto image = picture({"#######", "#..o..#", "#..o..#", "#######"}, inks);
  const Json params = {
      {"seed", {1, 1}}, {"until", "boundary"}, {"boundary", {1, 0, 0}}, {"color", {0.5, 0, 0}}};
  EXPECT_EQ(filled_pixels(image, params), 10);
  EXPECT_EQ(filled_pixels(image, {{"seed", {1, 1}}, {"color", {0.5, 0, 0}}}), 4)
      << "a flood stays in its colour";
  EXPECT_EQ(filled_pixels(image, {{"seed", {1, 1}}, {"tolerance", 0.5}}), 10);
}

TEST(RasterizeFill, EndsAmongNansAndSaysWhatTheyAre) {
  const auto image = picture({"..?..", "..?..", "#####"}, inks);
  const Json until = {{"seed", {0, 0}}, {"until", "boundary"}, {"boundary", {1, 0, 0}}};
  EXPECT_EQ(filled_pixels(image, until), 10) << "NaN is no boundary";
  EXPECT_EQ(filled_pixels(image, {{"seed", {0, 0}}, {"tolerance", 100}}), 13) << "and near no number";
  EXPECT_EQ(filled_pixels(image, {{"seed", {2, 1}}}), 2) << "but near itself";
}

TEST(RasterizeFill, CrossesCornersOnlyWhenAsked) {
  const auto image = picture({"#.#", ".#.", "#.#"}, inks);
  EXPECT_EQ(filled_pixels(image, {{"seed", {1, 1}}}), 1);
  EXPECT_EQ(filled_pixels(image, {{"seed", {1, 1}}, {"connectivity", "eight"}}), 5);
}

TEST(RasterizeFill, PaintsTheRegionAndNothingElse) {
  const auto image = picture({"..#", "..#"}, inks);
  const auto out =
      test::run_node(nodes::rasterize_fill(), {{"seed", {0, 0}}, {"color", {0.25, 0.5, 0.75}}}, {{image}});
  const Raster& raster = out.at(0).as<Image>()->raster;
  EXPECT_EQ(raster.value(2, 0, 1, 1), 0.75);
  EXPECT_EQ(raster.value(0, 0, 2, 1), 1);
  EXPECT_EQ(out.at(2).as<Table>()->rows(), 2u);
}

TEST(RasterizeFill, RefusesASeedOutside) {
  const auto image = picture({"..", ".."}, inks);
  EXPECT_EQ(test::run_error(nodes::rasterize_fill(), {{"seed", {2, 0}}}, {{image}}).first, "outside_window");
}

}  // namespace
}  // namespace frustum
