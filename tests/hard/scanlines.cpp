// Scanlines, and depth in whole numbers.
#include "nodes/visibility/zbuffer.h"
#include "tests/hard/exact.h"
#include "tests/hard/stages.h"
#include "tests/hard/visible.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

namespace frustum::hard {
namespace {

using glm::vec2, glm::vec4;
using Outline = std::vector<vec2>;  // corners on the grid of 2^-8 px
constexpr int edge = 48;            // px

// How often the outline runs around each pixel's middle, by the scanner: a triangle of a fan from the first
// corner counts as it turns.
std::vector<int> windings(const Outline& p) {
  std::vector<int> out(static_cast<std::size_t>(edge * edge), 0);
  for (std::size_t k = 2; k < p.size(); ++k) {
    const vec2 a = p[k - 1] - p[0], b = p[k] - p[0];
    ScreenTriangles one;
    one.add({p[0], 0.5F, 1}, {p[k - 1], 0.5F, 1}, {p[k], 0.5F, 1}, 0);
    const Picture seen = by_scanline(one.mesh(), edge, edge);
    for (std::size_t i = 0; i < out.size(); ++i)
      if (seen.id[i] == 0) out[i] += a.x * b.y - a.y * b.x > 0 ? 1 : -1;
  }
  return out;
}

// The same in whole numbers: crossings to the left of the middle, which the rule of top and left sides moves
// to the right by next to nothing and down by nothing at all beside that.
std::vector<int> exact_windings(const Outline& p) {
  std::vector<int> out;
  const auto grid = [](float px) { return static_cast<std::int64_t>(px * 256); };
  for (int row = 0; row < edge; ++row)
    for (int column = 0; column < edge; ++column) {
      const std::int64_t x = 256 * column + 128, y = 256 * row + 128;
      int n = 0;
      for (std::size_t k = 0; k < p.size(); ++k) {
        const vec2 &a = p[k], &b = p[(k + 1) % p.size()];
        const bool up = a.y > b.y;
        const vec2 &top = up ? b : a, &low = up ? a : b;
        if (!(grid(top.y) <= y && y < grid(low.y))) continue;
        const std::int64_t right_of =
            (x - grid(top.x)) * (grid(low.y) - grid(top.y)) - (y - grid(top.y)) * (grid(low.x) - grid(top.x));
        if (right_of >= 0) n += up ? 1 : -1;
      }
      out.push_back(n);
    }
  return out;
}

// The textbook: where the sides cross a row, from left to right, filled between the first and the second and
// so on; an odd one floods the rest. Sides hold both their ends.
std::vector<bool> textbook_fill(const Outline& p, bool without_horizontals) {
  std::vector<bool> out(static_cast<std::size_t>(edge * edge), false);
  for (int row = 0; row < edge; ++row) {
    const float y = static_cast<float>(row) + 0.5F;
    std::vector<float> crossing;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const vec2 &a = p[k], &b = p[(k + 1) % p.size()];
      if (y < std::min(a.y, b.y) || y > std::max(a.y, b.y) || (without_horizontals && a.y == b.y)) continue;
      const float x = a.x + (y - a.y) * ((b.x - a.x) / (b.y - a.y));
      crossing.push_back(x);
      for (std::size_t i = crossing.size() - 1; i > 0 && x < crossing[i - 1]; --i)
        std::swap(crossing[i], crossing[i - 1]);
    }
    for (std::size_t i = 0; i < crossing.size(); i += 2)
      for (int column = 0; column < edge; ++column) {
        const float x = static_cast<float>(column) + 0.5F;
        if (x >= crossing[i] && !(i + 1 < crossing.size() && x >= crossing[i + 1]))
          out[static_cast<std::size_t>(row * edge + column)] = true;
      }
  }
  return out;
}

// Compares sets of both rules; the textbook's is that of even and odd.
void judge_outline(Trial& t, const Outline& p, bool without_horizontals) {
  const auto want = exact_windings(p), got = windings(p);
  const auto naive = textbook_fill(p, without_horizontals);
  std::size_t naive_wrong = 0, wrong = 0;
  for (std::size_t i = 0; i < want.size(); ++i) {
    naive_wrong += naive[i] != (want[i] % 2 != 0);
    wrong += (got[i] != 0) != (want[i] != 0) || (got[i] % 2 != 0) != (want[i] % 2 != 0);
  }
  t.measure(static_cast<double>(naive_wrong), static_cast<double>(wrong), {p[0].x, p[0].y, p[1].x, p[1].y});
}

void corners_on_lines(Trial& t) {
  for (std::size_t n = t.samples(60, 5000); n-- > 0;) {
    const std::size_t corners = 5 + 2 * t.random.below(6), step = 2 + t.random.below(corners / 2 - 1);
    const double turn = t.random.uniform(0, 6);
    Outline p;
    for (std::size_t k = 0; k < corners; ++k) {
      const double angle =
          turn + 6.283185307179586 * static_cast<double>(k * step) / static_cast<double>(corners);
      p.emplace_back(static_cast<float>(std::floor(256 * (24 + 22 * std::cos(angle))) / 256),
                     static_cast<float>(std::floor(24 + 22 * std::sin(angle)) + 0.5));
    }
    judge_outline(t, p, true);
  }
}

void horizontal_sides(Trial& t) {
  for (std::size_t n = t.samples(60, 5000); n-- > 0;) {
    const auto on = [&](double low, double high) {
      return static_cast<float>(std::floor(t.random.uniform(low, high)) + 0.5);
    };
    const float bottom = on(38, 46), left = on(1, 5);
    Outline p{{left, bottom}, {left, on(2, 12)}};
    // No tooth is a rectangle; teeth stand on heights of their own.
    for (std::size_t teeth = t.random.below(5); teeth-- > 0;) {
      const float right = p.back().x + on(1, 4), gap = on(15, 36), next = right + on(1, 4);
      p.emplace_back(right, p.back().y), p.emplace_back(right, gap);
      p.emplace_back(next, gap), p.emplace_back(next, on(2, 12));
    }
    const float right = p.back().x + on(1, 4);
    p.emplace_back(right, p.back().y), p.emplace_back(right, bottom);
    judge_outline(t, p, false);
  }
}

// Spans between one begin or end and the next, each shown by who is nearest at its first pixel.
Picture shown_by_first_pixel(const ScreenTriangles& mesh, int width, int height) {
  std::vector<Picture> alone;
  for (std::size_t f = 0; f < mesh.face.size(); ++f) {
    ScreenTriangles one{mesh.position, {mesh.face[f]}, {mesh.origin[f]}};
    alone.push_back(filled(one.mesh(), width, height));
  }
  Picture out = alone.front();
  for (int y = 0; y < height; ++y) {
    std::set<std::size_t> before;
    std::uint32_t id = kernels::no_face;
    for (int x = 0; x < width; ++x) {
      std::set<std::size_t> active;
      for (std::size_t f = 0; f < alone.size(); ++f)
        if (alone[f].at(x, y) != kernels::no_face) active.insert(f);
      if (active != before) {
        const auto nearest = std::min_element(
            active.begin(), active.end(),
            [&](std::size_t a, std::size_t b) { return alone[a].depth(x, y) < alone[b].depth(x, y); });
        id = nearest == active.end() ? kernels::no_face : mesh.origin[*nearest];
        before = active;
      }
      out.id[static_cast<std::size_t>(y * width + x)] = id;
    }
  }
  return out;
}

void crossing_spans(Trial& t) {
  ScreenTriangles last;
  for (std::size_t n = t.samples(100, 5000); n-- > 0;) {
    ScreenTriangles mesh;
    for (const std::uint32_t source : {0U, 1U}) add_random_face(mesh, t.random, edge, edge, source);
    const Picture got = by_scanline(mesh.mesh(), edge, edge), want = filled(mesh.mesh(), edge, edge);
    t.measure(static_cast<double>(pixels_apart(shown_by_first_pixel(mesh, edge, edge), want)),
              static_cast<double>(pixels_apart(got, want)), {mesh.position[0].x, mesh.position[0].y});
    t.require(wrong_pixels(got, seen_by_rays(mesh, edge, edge)) == 0, "rays see the same");
  }
}

// The textbook's scanlines: x and depth along the sides, depth along the row by adding.
Picture textbook_scanlines(const ScreenTriangles& mesh, int width, int height) {
  Picture out = filled({}, width, height);
  for (std::size_t f = 0; f < mesh.face.size(); ++f) {
    std::array<vec4, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.position[mesh.face[f][static_cast<glm::length_t>(k)]];
    std::sort(p.begin(), p.end(), [](const vec4& a, const vec4& b) { return a.y < b.y; });
    const auto along = [](const vec4& a, const vec4& b, float y) {
      return a + (b - a) * ((y - a.y) / (b.y - a.y));
    };
    for (int row = 0; row < height; ++row) {
      const float y = static_cast<float>(row) + 0.5F;
      if (y < p[0].y || y >= p[2].y) continue;
      vec4 a = along(p[0], p[2], y), b = y < p[1].y ? along(p[0], p[1], y) : along(p[1], p[2], y);
      if (a.x > b.x) std::swap(a, b);
      const int begin = std::max(0, static_cast<int>(std::ceil(a.x - 0.5F)));
      const int end = std::min(width, static_cast<int>(std::ceil(b.x - 0.5F)));
      const float slope = (b.z - a.z) / (b.x - a.x);
      float z = a.z + (static_cast<float>(begin) + 0.5F - a.x) * slope;
      for (int x = begin; x < end; ++x, z += slope) {
        const auto i = static_cast<std::size_t>(row * width + x);
        if (z < out.z[i]) out.z[i] = z, out.id[i] = mesh.origin[f];
      }
    }
  }
  return out;
}

void same_as_depth_buffer(Trial& t) {
  ScreenTriangles mesh;
  for (std::size_t n = t.samples(500, 5000); n-- > 0;) {
    mesh = {};
    for (std::uint32_t f = 0; f < 12; ++f) add_random_face(mesh, t.random, edge, edge, 11 - f);
    if (n % 3 == 0)  // corners on samples and equal depths: ties
      for (vec4& p : mesh.position)
        p = {std::floor(p.x) + 0.5F, std::floor(p.y) + 0.5F, std::round(p.z * 4) / 4, 1};
    const Picture want = filled(mesh.mesh(), edge, edge);
    t.tally(!same_bits(textbook_scanlines(mesh, edge, edge), want),
            !same_bits(by_scanline(mesh.mesh(), edge, edge), want), {mesh.position[0].x, mesh.position[0].y});
  }
  t.price([&] { keep(textbook_scanlines(mesh, edge, edge).id[0]); },
          [&] { keep(by_scanline(mesh.mesh(), edge, edge).id[0]); });
}

// A pixel of two faces in a depth buffer of whole numbers.
std::uint32_t nearer_of(float first, float second, zbuffer::Format format) {
  ScreenTriangles mesh;
  mesh.add({0, 0, first, 1}, {8, 0, first, 1}, {0, 8, first, 1}, 0);
  mesh.add({0, 0, second, 1}, {8, 0, second, 1}, {0, 8, second, 1}, 1);
  Picture p = filled({}, 2, 2);
  const zbuffer::DepthBuffer<float> buffer(mesh.mesh(), kernels::centre_sample(), {0, 0, 2, 2},
                                           kernels::DepthRange::minus_one_to_one, format,
                                           zbuffer::Interpolation::plane, {});
  buffer.fill({0, 0, 2, 2}, {p.id.data(), 2, 0}, {p.z.data(), 2, 0});
  return p.id[0];
}

void whole_depths(Trial& t) {
  struct Kept {
    zbuffer::Format format;
    int bits;
  };
  for (const auto& [format, bits] : {Kept{zbuffer::Format::unorm16, 16}, Kept{zbuffer::Format::unorm24, 24},
                                     Kept{zbuffer::Format::unorm32, 32}}) {
    std::vector<double> depths{0,
                               1,
                               1 - 0x1p-25,
                               std::nextafter(1.0, 0.0),
                               0.5,
                               std::nextafter(0.5, 0.0),
                               std::nextafter(0.5, 1.0),
                               0x1p-1074,
                               0.5 - 0x1p-24,
                               0.5 + 0x1p-24};
    for (std::size_t n = t.samples(2000, 200000); n-- > 0;) depths.push_back(t.random.uniform());
    std::sort(depths.begin(), depths.end());
    const double steps = std::exp2(bits) - 1;
    double before = -1;
    for (const double z : depths) {
      const double got = std::round(zbuffer::kept(format, z, 0) * steps);
      // The textbook: scaled in float, rounded, and the low bits kept.
      const auto scaled =
          static_cast<std::uint64_t>(static_cast<float>(z) * static_cast<float>(steps) + 0.5F);
      const auto naive = static_cast<double>(scaled & ((std::uint64_t{1} << bits) - 1));
      const Rational want = Rational(z) * Rational(steps);
      t.measure(distance(naive, want), distance(got, want), {z, steps});
      t.require(got >= before && got <= steps, "monotone, and nothing wraps", {z, steps});
      before = got;
    }
    t.require(before == steps, "1 is the greatest number", {steps});
    t.require(nearer_of(1, 0.5F, format) == 1 && nearer_of(0.5F, 1, format) == 0 &&
                  nearer_of(std::nextafter(1.0F, 0.0F), 0.99F, format) == 1,
              "nothing at the far end is nearer than what lies before it", {steps});
  }
}

}  // namespace

std::vector<HardCase> scanlines() {
  return {
      {"ZBF-10", "1, 1 - 2^-25, 0.5 +- ulp, 2^-1074, random depths; 16, 24 and 32 bits",
       "float times 2^n - 1, plus 1/2, low bits", "zbuffer::kept, zbuffer::DepthBuffer", "rationals",
       "nearest step but for 2^-20; monotone; 1 is the greatest; no wrap", "steps", 0.5 + 0x1p-20,
       whole_depths},
      {"SCN-02", "stars {n/k}, all corners at y = k + 0.5", "pairs of crossings, sides with both ends",
       "scanline::Scanner", "winding in whole numbers", "the set, of even-odd and of non-zero", "wrong px", 0,
       corners_on_lines},
      {"SCN-03", "rectangles and combs, horizontals at y = k + 0.5", "a horizontal's slope: 1 / 0",
       "scanline::Scanner", "winding in whole numbers", "the set", "wrong px", 0, horizontal_sides},
      {"SCN-04", "two faces that pierce one another or not", "a span is who is nearest at its begin",
       "scanline::Scanner", "depth buffer, rays in 128 bits", "ids equal", "wrong px", 0, crossing_spans},
      {"SCN-05", "500 random scenes of 12 faces, a third of them full of ties",
       "x and z along sides and rows, float", "scanline::Scanner", "bits of simd::fill_triangles",
       "ids and depths the same bits", "pictures that differ", 0, same_as_depth_buffer},
  };
}

}  // namespace frustum::hard
