// The pictures of docs/stability.md.
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/vector.h"
#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/app/stability/plot.h"
#include "tests/hard/exact.h"
#include "tests/hard/naive.h"
#include "tests/hard/screen.h"
#include "tests/hard/stages.h"

#include <algorithm>
#include <array>
#include <string>

namespace frustum::hard {
namespace {

using Rgb = std::array<float, 3>;  // as they are shown: sRGB
constexpr Rgb white{1, 1, 1}, red{0.84F, 0.19F, 0.15F}, blue{0.13F, 0.40F, 0.67F},
    yellow{0.99F, 0.82F, 0.25F}, grey{0.82F, 0.84F, 0.86F};

class Canvas {
 public:
  Canvas(int width, int height)
      : raster_(Frame{.window = {0, 0, width, height},
                      .planes = {{"R", PlaneKind::f32}, {"G", PlaneKind::f32}, {"B", PlaneKind::f32}},
                      .color_space = "srgb"}) {
    fill(0, 0, width, height, white);
  }
  void fill(int x0, int y0, int width, int height, const Rgb& color) {
    for (int y = y0; y < y0 + height; ++y)
      for (int plane = 0; plane < 3; ++plane)
        std::fill_n(raster_.view().row<float>(plane, 0, y) + x0, width,
                    color[static_cast<std::size_t>(plane)]);
  }
  void save(const std::string& path) const { save_raster(raster_, path); }

 private:
  Raster raster_;
};

// FND-07: on which side of a line the 256 x 256 floats beside (1/2, 1/2) lie; the textbook left, ours right.
void draw_orientation(const std::string& path) {
  constexpr int points = 256, zoom = 1, gap = 16;
  Canvas canvas(2 * points * zoom + gap, points * zoom);
  const glm::dvec2 q(12, 12), r(24, 24);
  const auto color = [](int sign) { return sign > 0 ? blue : (sign < 0 ? red : yellow); };
  for (int i = 0; i < points; ++i)
    for (int j = 0; j < points; ++j) {
      const glm::dvec2 p(0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53);
      const double det = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
      const int y = (points - 1 - j) * zoom;
      canvas.fill(i * zoom, y, zoom, zoom, color((det > 0) - (det < 0)));
      canvas.fill(points * zoom + gap + i * zoom, y, zoom, zoom, color(kernels::orientation(p, q, r)));
    }
  canvas.save(path);
}

// TRI-01: how often each pixel of a mesh without gaps is covered; the textbook left, ours right.
void draw_cracks(const std::string& path) {
  constexpr int size = 96, zoom = 4, gap = 16, offset = 12000;
  stability::Random random(7);
  constexpr int cells = 14;
  constexpr float cell = (size + 8.0F) / cells;
  std::vector<glm::vec4> points;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const auto at = [&](int k) {
        const bool rim = k == 0 || k == cells;
        return offset - 4 + cell * static_cast<float>(k + (rim ? 0 : random.uniform(-0.35, 0.35)));
      };
      const float x = at(i), y = at(j);
      points.emplace_back(x, y, 0.5F, 1.0F);
    }
  std::vector<int> naive_count(size * size), count(size * size);
  const auto add = [&](int a, int b, int c) {
    const std::array<glm::vec4, 3> p{points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)],
                                     points[static_cast<std::size_t>(c)]};
    ScreenTriangles mesh;
    mesh.add(p[0], p[1], p[2], 0);
    const Picture drawn = filled(mesh.mesh(), size, size, kernels::centre_sample(), offset, offset);
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const auto i = static_cast<std::size_t>(y * size + x);
        count[i] += drawn.id[i] != kernels::no_face ? 1 : 0;
        int inside = 0, outside = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const glm::vec4 &from = p[k], &to = p[(k + 1) % 3];
          const float e = (from.y - to.y) * (static_cast<float>(offset + x) + 0.5F) +
                          (to.x - from.x) * (static_cast<float>(offset + y) + 0.5F) +
                          (from.x * to.y - to.x * from.y);
          inside += e >= 0 ? 1 : 0, outside += e <= 0 ? 1 : 0;
        }
        naive_count[i] += inside == 3 || outside == 3 ? 1 : 0;
      }
  };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i, d = a + cells + 1;
      add(a, a + 1, d + 1), add(a, d + 1, d);
    }
  Canvas canvas(2 * size * zoom + gap, size * zoom);
  const auto color = [](int n) { return n == 1 ? grey : (n == 0 ? blue : red); };
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto i = static_cast<std::size_t>(y * size + x);
      canvas.fill(x * zoom, y * zoom, zoom, zoom, color(naive_count[i]));
      canvas.fill(size * zoom + gap + x * zoom, y * zoom, zoom, zoom, color(count[i]));
    }
  canvas.save(path);
}

// FND-01 and FND-02: the error of a unit vector against the size of the vector.
void draw_normalizing(const std::string& path) {
  stability::Plot plot{
      "Normalising a vector of floats", "size of the vector", "error of the direction, ulp", {}, 2};
  plot.series = {{"v / sqrt(v.v)", "#d6312b", {}}, {"kernels::normalized", "#2166ac", {}}};
  for (int k = -148; k <= 126; ++k) {
    const glm::vec3 v = glm::vec3(0.75F, 0.5F, -0.625F) * std::ldexp(1.0F, k);
    if (v.y == 0) continue;
    const auto error = [&](const glm::vec3& got) {
      double worst = 0;
      for (int i = 0; i < 3; ++i) {
        const Real want = exact([&] {
          const Real x = v.x, y = v.y, z = v.z;
          return Real(v[i]) / sqrt(x * x + y * y + z * z);
        });
        const double off = ulps(got[i], want);
        worst = off <= worst ? worst : off;
      }
      return worst;
    };
    plot.series[0].points.emplace_back(k, error(naive::normalized(v)));
    plot.series[1].points.emplace_back(k, error(kernels::normalized_or(v, glm::vec3(0))));
  }
  write_if_changed(path, svg_text(plot));
}

}  // namespace

std::vector<stability::Illustration> illustrations() {
  return {
      {"stability_orientation.png",
       "On which side of a line do points lie that are one float apart? The textbook's 2 x 2 determinant "
       "(left) and the exact predicate "
       "(right) for 256 x 256 points beside (1/2, 1/2): red below the line, yellow on it, blue above. Case "
       "FND-07.",
       draw_orientation},
      {"stability_cracks.png",
       "A mesh without gaps, 12 000 pixels from the origin. Grey pixels are covered once, as all should be; "
       "red ones twice, blue ones not at all. "
       "Edge functions in float (left) and on an integer grid (right). Case TRI-01.",
       draw_cracks},
      {"stability_normalise.svg",
       "The direction of a vector does not depend on its size, but the square of its length leaves the "
       "range of float long before the vector does. What lies on the upper rim is infinite. Cases FND-01 and "
       "FND-02.",
       draw_normalizing},
  };
}

}  // namespace frustum::hard
