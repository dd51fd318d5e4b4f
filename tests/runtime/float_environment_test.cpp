// Nodes compute in the usual floating-point environment, whatever the node before them left behind.
#include "runtime/core/float_environment.h"

#include "runtime/buffers/image.h"
#include "runtime/buffers/value.h"
#include "runtime/graph/run.h"

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <cmath>

namespace frustum {
namespace {

constexpr unsigned control = 0xffc0;  // all of MXCSR but its sticky flags

// What a library leaves behind: subnormals flushed, rounding upwards.
void leak() { _mm_setcsr(_mm_getcsr() | 0x8040u | 0x4000u); }
bool usual() { return (_mm_getcsr() & control) == 0x1f80; }

TEST(FloatEnvironment, IsTheUsualOneInsideAndWhatItWasAfterwards) {
  const unsigned before = _mm_getcsr();
  leak();
  const unsigned leaked = _mm_getcsr();
  {
    const FloatEnvironment environment;
    EXPECT_TRUE(usual());
    leak();
  }
  EXPECT_EQ(_mm_getcsr() & control, leaked & control);
  _mm_setcsr(before);
}

// 1 where a node finds the usual environment; it leaves another one behind.
namespace leaky {
struct Inputs {
  std::optional<Ref<Number>> before;
};
struct Params {};
struct Outputs {
  Ref<Number> found;
};
Outputs run(const Inputs& in, const Params&, Context&) {
  const bool all = usual() && (!in.before || (*in.before)->value == 1);
  leak();
  return {std::make_shared<Number>(Number{all ? 1.0 : 0.0})};
}
NodeType type() {
  return node("test.leaky", run)
      .doc("Leaves its floating-point environment behind.")
      .input("before", &Inputs::before, "What the node before found.")
      .output("found", &Outputs::found, "Whether it was the usual one.");
}
}  // namespace leaky

namespace leaky_pixels {
struct Inputs {
  Ref<Number> before;
};
struct Params {};
struct Outputs {
  Tiled<Image> image;
};
struct State {
  bool usual_before;
};
Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context&) {
  const bool all = usual() && in.before->value == 1;
  leak();
  Frame f;
  f.window = {0, 0, 200, 100};
  f.planes = {{"R", PlaneKind::f32}};
  return {{all}, {std::move(f)}};
}
void tile(const State& s, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena&) {
  const Tile& t = out[&Outputs::image];
  const float found = usual() && s.usual_before ? 1.0F : 0.0F;
  leak();
  for (int y = t.rect().y0; y < t.rect().y1; ++y) std::fill_n(t.row<float>(0, 0, y), t.rect().width(), found);
}
NodeType type() {
  return pixel_node("test.leaky_pixels", prepare, tile)
      .doc("Leaves its floating-point environment behind in every tile.")
      .input("before", &Inputs::before, "What the node before found.")
      .output("image", &Outputs::image, "1 where the environment was the usual one.");
}
}  // namespace leaky_pixels

GraphNode made(const std::string& id, const NodeType& type, std::vector<std::vector<Source>> inputs) {
  GraphNode n;
  n.id = id;
  n.type = &type;
  n.inputs = std::move(inputs);
  n.params = type.default_params();
  return n;
}

TEST(FloatEnvironment, IsTheUsualOneForEveryNodeAndTileOfARun) {
  const NodeType leaky = leaky::type(), pixels = leaky_pixels::type();
  Graph graph;
  graph.nodes.push_back(made("first", leaky, {{}}));
  graph.nodes.push_back(made("second", leaky, {{PortRef{0, 0}}}));
  graph.nodes.push_back(made("image", pixels, {{PortRef{1, 0}}}));
  const unsigned before = _mm_getcsr();
  for (const int threads : {1, 2}) {
    RunOptions options;
    options.threads = threads;
    options.tile_edge = 16;
    options.demand.ports = {PortRef{2, 0}};
    const RunResult r = run_graph(graph, options);
    ASSERT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
    const Buffer& image = r.buffers.at(PortRef{2, 0});
    const Raster& raster = image.type().raster(image.data());
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 200; ++x) ASSERT_EQ(raster.value(0, 0, x, y), 1) << x << "," << y;
    EXPECT_EQ(_mm_getcsr() & control, before & control) << "the caller's own";
  }
}

}  // namespace
}  // namespace frustum
