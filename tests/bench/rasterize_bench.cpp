// The stages of rasterization alone, at 1920 x 1080: what targets of frames a second are made of.
//  The scenes are those that are drawn with Mesa llvmpipe for comparison: a torus of a million triangles seen
// from (0, 1.2, 2.2), half of them facing away and culled, and eight layers that cover the screen, farthest
// first.
#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "nodes/kernels/simd/fill_triangles.h"
#include "nodes/kernels/simd/interpolate_attributes.h"

namespace frustum::kernels {
namespace {

constexpr int width = 1920, height = 1080, edge = 64;

struct Scene {
  std::vector<glm::vec4> position;  // on the screen
  std::vector<glm::vec3> normal, world;
  std::vector<glm::vec2> uv;
  std::vector<glm::uvec3> face;

  ScreenMesh<float> mesh() const { return {position, face, {}}; }
};

// The pinhole camera of the comparison: 45 degrees high, from (0, 1.2, 2.2) to the origin.
glm::vec4 on_screen(glm::dvec3 p) {
  const glm::dvec3 eye(0, 1.2, 2.2), forward = -eye / glm::length(eye), right(1, 0, 0),
                                     up = glm::cross(right, forward);
  const double near = 0.1, far = 100, focal = 1 / std::tan(std::numbers::pi / 8),
               w = glm::dot(p - eye, forward);
  const double x = glm::dot(p - eye, right) * focal * height / width / w,
               y = glm::dot(p - eye, up) * focal / w;
  const double z = (far + near - 2 * far * near / w) / (far - near);
  return {glm::dvec4((x + 1) / 2 * width, (1 - y) / 2 * height, z, 1 / w)};
}

Scene torus(int columns, int rows) {
  Scene s;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double u = double(i) / columns, v = double(j) / rows, a = 2 * std::numbers::pi * u,
                   b = -2 * std::numbers::pi * v;
      const glm::dvec3 n(std::cos(b) * std::cos(a), std::sin(b), -std::cos(b) * std::sin(a));
      const glm::dvec3 p = 0.7 * glm::dvec3(std::cos(a), 0, -std::sin(a)) + 0.3 * n;
      s.position.push_back(on_screen(p));
      s.world.emplace_back(p);
      s.normal.emplace_back(n);
      s.uv.emplace_back(u, v);
    }
  const auto add = [&s](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const glm::vec2 p(s.position[a]), q = glm::vec2(s.position[b]) - p, r = glm::vec2(s.position[c]) - p;
    if (q.x * r.y < q.y * r.x) s.face.emplace_back(a, b, c);  // the others face away
  };
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows); ++j)
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(columns); ++i) {
      const std::uint32_t a = j * static_cast<std::uint32_t>(columns + 1) + i, b = a + 1,
                          c = a + static_cast<std::uint32_t>(columns + 1);
      add(a, c, b);
      add(b, c, c + 1);
    }
  return s;
}

Scene layers(int count) {
  Scene s;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(s.position.size());
    for (const glm::vec2 corner : {glm::vec2(0, 0), {width, 0}, {0, height}, {width, height}})
      s.position.emplace_back(corner, 0.9f - 0.1f * static_cast<float>(i), 1);
    s.face.emplace_back(first, first + 1, first + 2);
    s.face.emplace_back(first + 1, first + 3, first + 2);
  }
  return s;
}

const Scene& million() {
  static const Scene scene = torus(1000, 500);
  return scene;
}

struct Picture {
  std::vector<std::uint32_t> id = std::vector<std::uint32_t>(std::size_t{width} * height);
  std::vector<float> z = std::vector<float>(id.size());

  template <class T>
  static PlaneView<T> part(T* plane, PixelRect rect) {
    return {plane + std::ptrdiff_t{rect.y0} * width + rect.x0, width, 0};
  }
};

template <class F>
void each_tile(F&& f) {
  constexpr int columns = (width + edge - 1) / edge, rows = (height + edge - 1) / edge;
  tbb::parallel_for(0, columns * rows, [&](int i) {
    const int x = i % columns * edge, y = i / columns * edge;
    f(PixelRect{x, y, std::min(x + edge, width), std::min(y + edge, height)});
  });
}

void fill(const Scene& scene, const TriangleBins& bins, Picture& picture) {
  const FillScene<float> from{scene.mesh(), centre_sample(), &bins};
  each_tile([&](PixelRect rect) {
    simd::fill_triangles(from, rect, Picture::part(picture.id.data(), rect),
                         Picture::part(picture.z.data(), rect));
  });
}

void bench_bins(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(
        bin_triangles(million().mesh(), centre_sample(), {0, 0, width, height}).entries.data());
}
BENCHMARK(bench_bins)->Name("torus_1m/bins")->Unit(benchmark::kMillisecond)->UseRealTime();

void bench_fill(benchmark::State& state, const Scene& scene) {
  const TriangleBins bins = bin_triangles(scene.mesh(), centre_sample(), {0, 0, width, height});
  Picture picture;
  for (auto _ : state) fill(scene, bins, picture);
}
BENCHMARK_CAPTURE(bench_fill, torus, million())
    ->Name("torus_1m/fill")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(bench_fill, layers, layers(8))
    ->Name("layers_8/fill")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// Normal, world position, uv and its derivatives, into planes that stay in the cache as they do in a fused
// pass.
void bench_attributes(benchmark::State& state) {
  const Scene& scene = million();
  Picture picture;
  fill(scene, bin_triangles(scene.mesh(), centre_sample(), {0, 0, width, height}), picture);
  for (auto _ : state)
    each_tile([&](PixelRect rect) {
      thread_local std::vector<float> planes(12 * edge * edge);
      std::size_t used = 0;
      const auto next = [&] { return PlaneView<float>{planes.data() + edge * edge * used++, edge, 0}; };
      std::array<Attribute<float>, 3> a{{{&scene.normal[0].x, 3, AttributeDomain::vertex},
                                         {&scene.world[0].x, 3, AttributeDomain::vertex},
                                         {&scene.uv[0].x, 2, AttributeDomain::vertex}}};
      for (std::size_t i = 0; i < 3; ++i) a[0].value[i] = next(), a[1].value[i] = next();
      for (std::size_t i = 0; i < 2; ++i) a[2].value[i] = next(), a[2].dx[i] = next(), a[2].dy[i] = next();
      simd::interpolate_attributes({scene.mesh(), centre_sample()}, rect,
                                   Picture::part<const std::uint32_t>(picture.id.data(), rect), {a, {}});
    });
}
BENCHMARK(bench_attributes)->Name("torus_1m/attributes")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace frustum::kernels
