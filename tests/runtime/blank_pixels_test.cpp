// Where nothing is seen, pixel nodes that are blank there do not run, and who reads them finds zeros all the same.
#include <gtest/gtest.h>

#include <map>

#include "tests/support/pixel_nodes.h"

namespace frustum::test {
namespace {

constexpr int width = 200, height = 140;

GraphMaker spot_graph(const std::string& from, const std::string& to) {
  GraphMaker g;
  g.add("spot", "test.spot", {}, R"({"size": [200, 140], "from": )" + from + R"(, "to": )" + to + "}")
      .add("near", "test.smear", {{"image", "spot"}}, R"({"radius": 2})")
      .add("far", "test.smear", {{"image", "near"}}, R"({"radius": 9})")
      .add("noise", "test.source", {}, R"({"size": [200, 140]})")
      .add("sum", "test.add", {{"a", "far"}, {"b", "noise"}});
  return g;
}

struct Pixels : Observer {
  std::map<std::string, std::uint64_t> of;
  void pixel_times(const std::vector<PixelNodeTime>& times) override {
    for (const PixelNodeTime& t : times) of[t.node] += t.pixels;
  }
};

Raster pixels_of(const GraphMaker& g, const std::string& port, RunOptions options) {
  options.demand.ports = {g.port(port)};
  const RunResult r = run_graph(g.graph, options);
  EXPECT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
  return r.buffers.at(g.port(port)).as<Image>()->raster;
}

void expect_equal(const Raster& a, const Raster& b) {
  int different = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) different += a.at<float>(0, 0, x, y) != b.at<float>(0, 0, x, y);
  EXPECT_EQ(different, 0);
}

// Not fused, every node gets whole rasters, and nothing is known of what they show.
TEST(BlankPixels, AreThoseThatComputingThemWouldGive) {
  for (const auto& [from, to] : {std::pair("[70, 60]", "[71, 61]"), std::pair("[0, 0]", "[5, 140]"),
                                 std::pair("[150, 90]", "[200, 140]"), std::pair("[0, 0]", "[0, 0]"),
                                 std::pair("[0, 0]", "[200, 140]")}) {
    const GraphMaker g = spot_graph(from, to);
    for (const std::string port : {"near", "far", "sum"}) {
      const Raster truth = pixels_of(g, port, {.threads = 1, .tile_edge = -1, .fuse = false});
      for (const int edge : {0, 16, 17, 64, -1}) {
        SCOPED_TRACE(port + " of " + from + " to " + to + ", tiles of " + std::to_string(edge));
        expect_equal(pixels_of(g, port, {.tile_edge = edge}), truth);
      }
    }
  }
}

TEST(BlankPixels, AreNotComputed) {
  Pixels pixels;
  const GraphMaker g = spot_graph("[96, 64]", "[112, 70]");
  pixels_of(g, "sum", {.tile_edge = -1, .observer = &pixels});
  EXPECT_EQ(pixels.of["sum"], std::uint64_t{width * height}) << "it says nothing of what is blank";
  // 16 x 6 px spread by 2 and by 9 on all sides, begun and ended at multiples of 16 from where they are stored.
  EXPECT_EQ(pixels.of["far"], std::uint64_t{48 * 28});
  EXPECT_EQ(pixels.of["near"], std::uint64_t{32 * 10});
}

TEST(BlankPixels, AreZeroInMemoryThatHeldSomethingElse) {
  const GraphMaker g = spot_graph("[0, 0]", "[0, 0]");
  for (int i = 0; i < 3; ++i) pixels_of(g, "noise", {});  // given back, and taken again
  Pixels pixels;
  const Raster empty = pixels_of(g, "far", {.observer = &pixels});
  EXPECT_EQ(pixels.of["far"] + pixels.of["near"] + pixels.of["spot"], 0u);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) ASSERT_EQ(empty.at<float>(0, 0, x, y), 0.0F) << x << ", " << y;
}

}  // namespace
}  // namespace frustum::test
