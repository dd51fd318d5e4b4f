// Scenes on which every algorithm of visibility has to show what rasterize.triangles shows.
#pragma once

#include "nodes/rasterize.h"
#include "nodes/visibility.h"
#include "tests/nodes/rasterize/screen_mesh.h"

#include <array>
#include <cmath>
#include <functional>

namespace frustum::test {

constexpr glm::ivec2 scene_size{96, 64};

// Three slanted bars, each over one neighbour and under the other; bar k is faces 2 k and 2 k + 1.
template <class R>
ScreenMeshMaker<R> three_bars() {
  ScreenMeshMaker<R> m;
  constexpr double x[3] = {48, 14, 82}, y[3] = {4, 60, 60};
  for (int k = 0; k < 3; ++k) {
    const int n = (k + 1) % 3;
    const double dx = x[n] - x[k], dy = y[n] - y[k], length = std::hypot(dx, dy), ax = 5 * -dy / length,
                 ay = 5 * dx / length, ex = 0.15 * dx, ey = 0.15 * dy;
    const auto a = m.vertex(x[k] - ex - ax, y[k] - ey - ay, 0.2);
    const auto b = m.vertex(x[n] + ex - ax, y[n] + ey - ay, 0.8);
    const auto c = m.vertex(x[n] + ex + ax, y[n] + ey + ay, 0.8);
    const auto d = m.vertex(x[k] - ex + ax, y[k] - ey + ay, 0.2);
    m.face.emplace_back(a, b, c), m.face.emplace_back(a, c, d);
  }
  return m;
}

enum class Soup { any, small, piercing, grid, level, slivers, spheres };

// A closed ball of shared vertices, both its front and its back.
template <class R>
void add_ball(ScreenMeshMaker<R>& m, Random& random) {
  constexpr int around = 8, down = 6;
  const double x = random.uniform(20, 76), y = random.uniform(16, 48), radius = random.uniform(8, 24);
  const auto first = static_cast<std::uint32_t>(m.position.size());
  for (int j = 0; j <= down; ++j)
    for (int i = 0; i < around; ++i) {
      const double t = 3.141592653589793 * j / down, p = 2 * 3.141592653589793 * i / around;
      m.vertex(x + radius * std::sin(t) * std::cos(p), y + radius * std::cos(t),
               0.5 * std::sin(t) * std::sin(p));
    }
  for (std::uint32_t j = 0; j < down; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t a = first + j * around + i, b = first + j * around + (i + 1) % around;
      m.face.emplace_back(a, b, a + around), m.face.emplace_back(b, b + around, a + around);
    }
}

template <class R>
ScreenMeshMaker<R> soup(Random& random, Soup kind, int faces) {
  ScreenMeshMaker<R> m;
  if (kind == Soup::spheres) {
    for (int k = 0; k < 3; ++k) add_ball(m, random);
    return m;
  }
  for (int i = 0; i < faces; ++i) {
    const double size = kind == Soup::small      ? 6
                        : kind == Soup::piercing ? 120
                                                 : std::exp2(random.uniform(1, 6));
    const double cx = random.uniform(-5, 101), cy = random.uniform(-5, 69);
    std::array<glm::dvec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = {cx + random.uniform(-size, size), cy + random.uniform(-size, size), random.uniform(-1, 1)};
      // Corners on sample places, few depths: ties, touching, coplanar and coincident faces.
      if (kind == Soup::grid)
        p[k] = {std::round(p[k].x / 8) * 8 + 0.5, std::round(p[k].y / 8) * 8 + 0.5,
                std::round(p[k].z * 4) / 4};
      if (kind == Soup::level) p[k].z = 0.3 + 1e-3 * p[k].x - 2e-3 * p[k].y + (i % 5 == 0 ? 1e-7 : 0);
    }
    if (kind == Soup::slivers) {
      p[2].x = (p[0].x + p[1].x) / 2 + random.uniform(-0.02, 0.02);
      p[2].y = (p[0].y + p[1].y) / 2 + random.uniform(-0.02, 0.02);
    }
    glm::uvec3 f;
    for (std::size_t k = 0; k < 3; ++k) f[static_cast<glm::length_t>(k)] = m.vertex(p[k].x, p[k].y, p[k].z);
    m.face.push_back(f);
  }
  return m;
}

// With origins in another order than faces where `shuffled`.
template <class R>
Buffer screen_buffer(const ScreenMeshMaker<R>& m, Random& random, bool reversed_z, bool shuffled,
                     int subpixel_bits = 8) {
  auto mesh = m.make(scene_size, reversed_z, subpixel_bits);
  if (shuffled) {
    std::vector<std::uint32_t> origin(m.face.size());
    for (auto& o : origin) o = static_cast<std::uint32_t>(random.below(origin.size()));
    mesh->columns.push_back(Column::make("origin", Domain::face, std::span<const std::uint32_t>(origin)));
  }
  return buffer_of(std::move(mesh));
}

// Two samples a pixel, in a pattern that repeats every other pixel.
inline Buffer scene_pattern() {
  return buffer_of(std::make_shared<SamplePattern>(SamplePattern{
      2, 2, {512, 900, 2048, 0, 2048, 2048, 100, 4095}, {3000, 2048, 77, 2048, 2048, 1, 4000, 0}}));
}

// Samples at which the id or the bits of the depth differ.
inline int differences(const Raster& a, const Raster& b) {
  int count = 0;
  for (int s = 0; s < a.frame().samples(); ++s)
    for (int y = 0; y < a.frame().window.y1; ++y)
      for (int x = 0; x < a.frame().window.x1; ++x)
        count += a.at<std::uint32_t>(0, s, x, y) != b.at<std::uint32_t>(0, s, x, y) ||
                 a.value(1, s, x, y) != b.value(1, s, x, y);
  return count;
}

// What a node that fills pixels shows of its inputs, whole or in tiles.
inline Raster shown(const NodeType& type, const NodeInputs& inputs, Precision precision, int tile_edge = 0,
                    const Json& params = nlohmann::json::object()) {
  Context ctx = with_precision(precision);
  return run_node(type, params, inputs, &ctx, {}, tile_edge).at(0).as<Visibility>()->raster;
}

// Runs `show(mesh, pattern, precision)` over random scenes of all kinds, on grids of 8, 4 and 6 bits below a pixel,
// and asks for the bytes of rasterize.triangles.
template <class R>
void expect_depth_buffer(Precision precision, int rounds,
                         const std::function<Raster(const Buffer&, const Buffer&, Precision)>& show) {
  Random random(41);
  for (int round = 0; round < rounds; ++round)
    for (const Soup kind :
         {Soup::any, Soup::small, Soup::piercing, Soup::grid, Soup::level, Soup::slivers, Soup::spheres}) {
      const auto m = soup<R>(random, kind, kind == Soup::piercing ? 16 : 50);
      const Buffer mesh = screen_buffer(m, random, round % 2 == 1, round % 3 == 1,
                                        std::array{8, 4, 6}[static_cast<std::size_t>(round % 3)]);
      const Raster want = shown(nodes::rasterize_triangles(), {{mesh}, {scene_pattern()}}, precision);
      ASSERT_EQ(differences(want, show(mesh, scene_pattern(), precision)), 0)
          << "soup " << static_cast<int>(kind) << ", round " << round;
    }
}

// The same by a node that finds an order, painted.
inline Raster painted(const NodeType& type, const Json& params, const Buffer& mesh, const Buffer& pattern,
                      Precision precision) {
  Context ctx = with_precision(precision);
  const Buffer order = run_node(type, params, {{mesh}}, &ctx).at(0);
  return shown(nodes::visibility_paint(), {{order}, {mesh}, {pattern}}, precision);
}

inline std::uint64_t counter(const Context& ctx, std::string_view name) {
  for (const auto& [counter, n] : ctx.counters())
    if (counter == name) return n;
  ADD_FAILURE() << "no counter " << name;
  return 0;
}

}  // namespace frustum::test
