// How the work of each method grows with the number of faces, in counters that any machine repeats.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "nodes/kernels/depth_sort.h"
#include "nodes/kernels/elementary.h"
#include "nodes/kernels/painter_order.h"
#include "nodes/kernels/scan_survey.h"
#include "nodes/kernels/space_partition.h"

namespace frustum::growth {

// Faces in a square picture, near one another at random, that together cover it `layers` times.
struct Scene {
  std::vector<glm::dvec4> position;
  std::vector<glm::uvec3> face;
  kernels::ScreenMesh<double> mesh() const { return {position, face, {}}; }
};

// `random(i)` gives the i-th number of [0, 1). Right-angled faces of equal size, tilted little.
template <class Random>
Scene scene(std::uint32_t faces, double layers, int side_px, const Random& random) {
  const double leg = side_px * std::sqrt(2 * layers / faces);
  Scene s;
  for (std::uint32_t f = 0; f < faces; ++f) {
    const std::uint64_t at = std::uint64_t{f} * 8;
    const double x = random(at) * side_px - leg / 3, y = random(at + 1) * side_px - leg / 3;
    const double z = random(at + 2), turn = random(at + 3) < 0.5 ? 1 : -1;
    const auto first = static_cast<std::uint32_t>(s.position.size());
    const auto tilt = [&](std::uint64_t k) { return z + (random(at + k) - 0.5) * leg / side_px; };
    s.position.emplace_back(x, y, tilt(4), 1);
    s.position.emplace_back(x + turn * leg, y, tilt(5), 1);
    s.position.emplace_back(x, y + turn * leg, tilt(6), 1);
    s.face.emplace_back(first, first + 1, first + 2);
  }
  return s;
}

// The work of one scene: comparisons of depths at samples, or of faces with one another.
struct Work {
  double depth_buffer, scanline, painter, depth_sort, bsp;
};

// Covered samples, each of which the depth buffer compares once.
inline std::uint64_t covered(const kernels::ScreenMesh<double>& mesh, int side_px) {
  std::uint64_t count = 0;
  const auto half = static_cast<std::int32_t>(kernels::sample_unit / 2);
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    const auto t = kernels::screen_triangle(mesh, f, 1.0);
    kernels::BoxCounts counts;
    kernels::BoxedTriangle box;
    kernels::box_triangle(mesh, f, {half, half, half, half}, {0, 0, side_px, side_px}, &box, counts);
    if (!t || counts.boxed == 0) continue;
    for (int y = box.y0; y <= box.y1; ++y)
      for (int x = box.x0; x <= box.x1; ++x)
        count += std::all_of(t->edge.begin(), t->edge.end(), [&](const kernels::Edge& e) {
          return kernels::Edge::covers(e.at_pixel(x, y), e.at_offset(half, half));
        });
  }
  return count;
}

inline Work work(const Scene& s, int side_px, const std::function<void()>& poll) {
  const kernels::ScreenMesh<double> mesh = s.mesh();
  const kernels::PixelRect window{0, 0, side_px, side_px};
  const auto faces = kernels::screen_faces(mesh, 1.0);
  const auto count = [](std::uint64_t n) { return static_cast<double>(n); };
  Work w{};
  w.depth_buffer = count(covered(mesh, side_px));
  const scanline::Scanner<double> scanner(mesh, kernels::centre_sample(), window,
                                          kernels::DepthOrder::standard, {});
  w.scanline = count(scanline::survey(scanner, window, -1, poll).counts.comparisons);
  w.painter = count(painter::order(faces, window, painter::Key::overlap, {poll}).comparisons);
  const depth_sort::Watch watch{poll};
  w.depth_sort =
      count(depth_sort::Sorter(faces, window, watch).run([](const kernels::Piece&) {}).comparisons);
  w.bsp = count(bsp::build(faces, window, {}, {poll}).comparisons);
  return w;
}

// The slope of log(work) over log(faces), by least squares; NaN for fewer than two sizes or no work.
inline double exponent(std::span<const double> faces, std::span<const double> work) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double lx = kernels::log2(faces[i]), ly = kernels::log2(work[i]);
    n += 1, x += lx, y += ly, xx += lx * lx, xy += lx * ly;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace frustum::growth
