// Small nodes with known answers, for tests of the runtime alone.
#pragma once

#include "runtime/buffers/image.h"
#include "runtime/buffers/value.h"
#include "runtime/graph/run.h"

#include <atomic>
#include <cmath>
#include <limits>

namespace frustum::test {

inline std::atomic<int> number_runs{0};  // how often "test.number" ran

namespace number {
struct Inputs {};
struct Params {
  double value = 1;
};
struct Outputs {
  Ref<Number> number;
};
inline Outputs run(const Inputs&, const Params& p, Context&) {
  ++number_runs;
  if (p.value < 0) throw NodeError("negative", "the value is negative");
  return {std::make_shared<Number>(Number{p.value})};
}
inline NodeType type() {
  return node("test.number", run)
      .doc("A number.")
      .param("value", &Params::value, "It.")
      .output("number", &Outputs::number, "It.");
}
}  // namespace number

// plane R at (x, y, sample): a scramble of all three, times the number.
namespace source {
struct Inputs {
  std::optional<Ref<Number>> scale;
};
struct Params {
  glm::ivec2 size{40, 30};
  int samples = 1;
  glm::ivec2 nan_at{-1, -1};
};
struct Outputs {
  Tiled<Image> image;
};
struct State {
  float scale;
  glm::ivec2 nan_at;
};
inline float value(int x, int y, int s) {
  const auto h = (static_cast<std::uint32_t>(x) * 73856093u ^ static_cast<std::uint32_t>(y) * 19349663u ^
                  static_cast<std::uint32_t>(s) * 83492791u) *
                 2654435761u;
  return static_cast<float>(h >> 8) / 16777216.0f;
}
inline Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context&) {
  Frame f;
  f.window = {0, 0, p.size.x, p.size.y};
  f.planes = {{"R", PlaneKind::f32}};
  if (p.samples > 1) {
    auto pattern = std::make_shared<SamplePattern>();
    pattern->samples = p.samples;
    for (int s = 0; s < p.samples; ++s)
      pattern->x.push_back(static_cast<std::uint16_t>(s)), pattern->y.push_back(2048);
    f.pattern = pattern;
  }
  return {{static_cast<float>(in.scale ? (*in.scale)->value : 1.0), p.nan_at}, {std::move(f)}};
}
inline void tile(const State& s, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena&) {
  const Tile& t = out[&Outputs::image];
  for (int i = 0; i < t.samples(); ++i)
    for (int y = t.rect().y0; y < t.rect().y1; ++y)
      for (int x = t.rect().x0; x < t.rect().x1; ++x)
        t.row<float>(0, i, y)[x - t.rect().x0] = x == s.nan_at.x && y == s.nan_at.y
                                                     ? std::numeric_limits<float>::quiet_NaN()
                                                     : s.scale * value(x, y, i);
}
inline NodeType type() {
  return pixel_node("test.source", prepare, tile)
      .doc("Noise.")
      .input("scale", &Inputs::scale, "Factor.")
      .param("size", &Params::size, "Size.")
      .param("samples", &Params::samples, "Samples.")
      .param("nan_at", &Params::nan_at, "A NaN.")
      .output("image", &Outputs::image, "Noise.");
}
}  // namespace source

// The mean of the (2 radius + 1)^2 pixels around, in fixed order; pixels outside the window do not count.
namespace blur {
struct Inputs {
  Tiled<Image> image;
};
struct Params {
  int radius = 1;
};
struct Outputs {
  Tiled<Image> image;
};
struct State {
  int plane, radius;
  Rect window;
};
inline Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context&) {
  return {{in.image.read("R"), p.radius, in.image.frame().window}, {in.image.frame()}};
}
inline void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena&) {
  const Tile& a = in[&Inputs::image];
  const Tile& b = out[&Outputs::image];
  for (int i = 0; i < b.samples(); ++i)
    for (int y = b.rect().y0; y < b.rect().y1; ++y)
      for (int x = b.rect().x0; x < b.rect().x1; ++x) {
        float sum = 0, n = 0;
        const Rect r = intersection(Rect{x, y, x + 1, y + 1}.grown(s.radius), s.window);
        for (int v = r.y0; v < r.y1; ++v)
          for (int u = r.x0; u < r.x1; ++u) sum += a.row<const float>(s.plane, i, v)[u - a.rect().x0], ++n;
        b.row<float>(0, i, y)[x - b.rect().x0] = sum / n;
      }
}
inline Rect reads(const State& s, std::string_view, Rect r) { return r.grown(s.radius); }
inline NodeType type() {
  return pixel_node("test.blur", prepare, tile)
      .reads(reads)
      .doc("Mean.")
      .input("image", &Inputs::image, "Pixels.")
      .param("radius", &Params::radius, "Radius.")
      .output("image", &Outputs::image, "Means.");
}
// The same, and it says that the mean of zeros is 0.
inline NodeType smear() {
  return pixel_node("test.smear", prepare, tile)
      .reads(reads)
      .doc("Mean.")
      .input("image", &Inputs::image, "Pixels.")
      .param("radius", &Params::radius, "Radius.")
      .output("image", &Outputs::image, "Means.")
      .blank_where(&Inputs::image);
}
}  // namespace blur

// Noise within a rectangle and 0 around it, which it says.
namespace spot {
struct Inputs {};
struct Params {
  glm::ivec2 size{40, 30}, from{0, 0}, to{0, 0};
};
struct Outputs {
  Tiled<Image> image;
};
struct State {
  Rect seen;
};
inline Prepared<State, Outputs> prepare(const Inputs&, const Params& p, Context&) {
  return {{{p.from.x, p.from.y, p.to.x, p.to.y}},
          {Frame{.window = {0, 0, p.size.x, p.size.y}, .planes = {{"R", PlaneKind::f32}}}}};
}
inline void tile(const State& s, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena&) {
  const Tile& t = out[&Outputs::image];
  for (int y = t.rect().y0; y < t.rect().y1; ++y)
    for (int x = t.rect().x0; x < t.rect().x1; ++x)
      t.row<float>(0, 0, y)[x - t.rect().x0] = s.seen.contains(x, y) ? source::value(x, y, 0) : 0;
}
inline Rect seen(const State& s, Rect rect) { return intersection(s.seen, rect); }
inline NodeType type() {
  return pixel_node("test.spot", prepare, tile)
      .doc("Noise.")
      .param("size", &Params::size, "Size.")
      .param("from", &Params::from, "Top left pixel of the noise.")
      .param("to", &Params::to, "Where it ends.")
      .output("image", &Outputs::image, "Noise.")
      .seen(seen);
}
}  // namespace spot

// a + b, pixel by pixel.
namespace add {
struct Inputs {
  Tiled<Image> a, b;
};
struct Params {};
struct Outputs {
  Tiled<Image> image;
};
struct State {};
inline Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context&) {
  in.a.read("R"), in.b.read("R");
  return {{}, {in.a.frame()}};
}
inline void tile(const State&, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena&) {
  const Tile& t = out[&Outputs::image];
  for (int i = 0; i < t.samples(); ++i)
    for (int y = t.rect().y0; y < t.rect().y1; ++y)
      for (int x = t.rect().x0; x < t.rect().x1; ++x) {
        const Tile &a = in[&Inputs::a], &b = in[&Inputs::b];
        t.row<float>(0, i, y)[x - t.rect().x0] =
            a.row<const float>(0, i, y)[x - a.rect().x0] + b.row<const float>(0, i, y)[x - b.rect().x0];
      }
}
inline NodeType type() {
  return pixel_node("test.add", prepare, tile)
      .doc("Sum.")
      .input("a", &Inputs::a, "One.")
      .input("b", &Inputs::b, "Other.")
      .output("image", &Outputs::image, "Sums.");
}
}  // namespace add

// Needs the whole picture: the sum of all values.
namespace total {
struct Inputs {
  Ref<Image> image;
};
struct Params {};
struct Outputs {
  Ref<Number> number;
};
inline Outputs run(const Inputs& in, const Params&, Context&) {
  const Raster& r = in.image->raster;
  double sum = 0;
  for (int s = 0; s < r.frame().samples(); ++s)
    for (int y = r.frame().window.y0; y < r.frame().window.y1; ++y)
      for (int x = r.frame().window.x0; x < r.frame().window.x1; ++x) sum += r.value(0, s, x, y);
  return {std::make_shared<Number>(Number{sum})};
}
inline NodeType type() {
  return node("test.total", run)
      .doc("Sum.")
      .input("image", &Inputs::image, "Pixels.")
      .output("number", &Outputs::number, "Sum.");
}
}  // namespace total

inline const Registry& registry() {
  static const Registry r({number::type(), source::type(), blur::type(), blur::smear(), spot::type(),
                           add::type(), total::type()});
  return r;
}

// Builds a Graph without a file: add("blur", "test.blur", {{"image", "noise"}}, R"({"radius": 3})").
class GraphMaker {
 public:
  Graph graph;
  GraphMaker& add(const std::string& id, const std::string& type,
                  std::vector<std::pair<std::string, std::string>> links, const std::string& params = "{}");
  GraphMaker& output(const std::string& name, const std::string& from, const std::string& file);
  PortRef port(const std::string& address) const { return graph.find_port(address).value(); }
};

}  // namespace frustum::test
