// Triangle rasterization.
#include "nodes/kernels/camera.h"
#include "nodes/project/view.h"
#include "tests/hard/exact.h"
#include "tests/hard/screen.h"
#include "tests/hard/stages.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

using glm::vec2, glm::vec3, glm::vec4;
using Wide = __int128;
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

std::uint32_t bits(float x) { return std::bit_cast<std::uint32_t>(x); }

using Corners = std::array<vec2, 3>;

// The textbook's coverage: A x + B y + C >= 0 for all three edges in float, C multiplied out.
bool covers_naively(const Corners& p, float x, float y) {
  float e[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const vec2 &a = p[i], &b = p[(i + 1) % 3];
    e[i] = (a.y - b.y) * x + (b.x - a.x) * y + (a.x * b.y - b.x * a.y);
  }
  return (e[0] >= 0 && e[1] >= 0 && e[2] >= 0) || (e[0] <= 0 && e[1] <= 0 && e[2] <= 0);
}

// Coverage by the kernel's edges, which is what fill_triangles asks of each of them.
bool covers_exactly(const kernels::ScreenTriangle<float>& t, int x, int y) {
  constexpr int middle = kernels::sample_unit / 2;
  return std::all_of(t.edge.begin(), t.edge.end(), [&](const kernels::Edge& e) {
    return kernels::Edge::covers(e.at_pixel(x, y), e.at_offset(middle, middle));
  });
}

// How often a window's pixels are covered by a mesh that should cover each of them once.
struct Counts {
  std::size_t naive_wrong = 0, robust_wrong = 0;
};
Counts count_coverage(const ScreenTriangles& mesh, int x0, int y0, int size) {
  const auto pixels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  std::vector<int> naive(pixels), robust(pixels);
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    Corners p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = vec2(mesh.position[mesh.face[f][static_cast<int>(k)]]);
    const auto exact_triangle = kernels::screen_triangle(mesh.mesh(), f, 1.0F);
    const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
    for (int y = std::max(y0, static_cast<int>(top) - 1);
         y < std::min(y0 + size, static_cast<int>(bottom) + 2); ++y)
      for (int x = std::max(x0, static_cast<int>(left) - 1);
           x < std::min(x0 + size, static_cast<int>(right) + 2); ++x) {
        const auto at = static_cast<std::size_t>((y - y0) * size + (x - x0));
        naive[at] += covers_naively(p, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F) ? 1 : 0;
        robust[at] += exact_triangle && covers_exactly(*exact_triangle, x, y) ? 1 : 0;
      }
  }
  const auto wrong = [](int n) { return n != 1; };
  return {static_cast<std::size_t>(std::count_if(naive.begin(), naive.end(), wrong)),
          static_cast<std::size_t>(std::count_if(robust.begin(), robust.end(), wrong))};
}

// A grid of cells x cells quads, each cut along one of its diagonals, that covers the window with a margin;
// `place(i, j)` says where its points lie, in cells.
ScreenTriangles net(int cells, int x0, int y0, int size, const std::function<vec2(int, int)>& place,
                    const std::function<bool()>& other_diagonal, bool clockwise) {
  ScreenTriangles mesh;
  const float cell = static_cast<float>(size + 8) / static_cast<float>(cells);
  const vec2 corner(static_cast<float>(x0 - 4), static_cast<float>(y0 - 4));
  std::vector<vec4> points;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) points.emplace_back(corner + place(i, j) * cell, 0.5F, 1.0F);
  const auto at = [&](int i, int j) { return points[static_cast<std::size_t>(j * (cells + 1) + i)]; };
  const auto add = [&](const vec4& a, const vec4& b, const vec4& c) {
    clockwise ? mesh.add(a, c, b, 0) : mesh.add(a, b, c, 0);
  };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const vec4 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if (other_diagonal())
        add(a, b, d), add(b, c, d);
      else
        add(a, b, c), add(a, c, d);
    }
  return mesh;
}

void shared_edges(Trial& t) {
  for (const int offset : {0, 4000, 60000})
    for (std::size_t n = t.samples(4, 100); n-- > 0;) {
      constexpr int cells = 40, size = 160;
      const auto place = [&](int i, int j) {
        // By less than a quarter, quads stay convex: either diagonal lies within.
        const auto moved = [&](int k) {
          const bool rim = k == 0 || k == cells;
          return static_cast<float>(k + (rim ? 0 : t.random.uniform(-0.24, 0.24)));
        };
        const float x = moved(i), y = moved(j);
        return vec2(x, y);
      };
      const auto mesh = net(
          cells, offset, offset, size, place, [&] { return t.random.below(2) == 0; }, n % 2 == 0);
      const Counts c = count_coverage(mesh, offset, offset, size);
      t.measure(static_cast<double>(c.naive_wrong), static_cast<double>(c.robust_wrong),
                {static_cast<double>(offset)});
    }
  std::vector<Corners> inputs(100);
  for (auto& p : inputs)
    for (auto& q : p)
      q = {static_cast<float>(t.random.uniform(0, 32)), static_cast<float>(t.random.uniform(0, 32))};
  const auto whole = [](auto&& covers) {
    int n = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) n += covers(x, y) ? 1 : 0;
    return n;
  };
  t.price_over(
      inputs,
      [&](const Corners& p) {
        return whole([&](int x, int y) {
          return covers_naively(p, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
        });
      },
      [&](const Corners& p) {
        ScreenTriangles mesh;
        mesh.add(vec4(p[0], 0, 1), vec4(p[1], 0, 1), vec4(p[2], 0, 1), 0);
        const auto triangle = kernels::screen_triangle(mesh.mesh(), 0, 1.0F);
        return triangle ? whole([&](int x, int y) { return covers_exactly(*triangle, x, y); }) : 0;
      });
}

void edges_through_centres(Trial& t) {
  // Corners on pixel centres: sides are axis-aligned, diagonals have slope 1, 1/2 and 2.
  for (const bool clockwise : {false, true})
    for (const vec2 slope : {vec2(1, 1), vec2(2, 1), vec2(1, 2)})
      for (const bool diagonal : {false, true}) {
        constexpr int cells = 40, size = 152;
        const auto place = [&](int i, int j) { return (vec2(i, j) * slope) + vec2(0.125F); };
        const auto mesh = net(
            cells, 0, 0, size, place, [&] { return diagonal; }, clockwise);
        const Counts c = count_coverage(mesh, 0, 0, size);
        t.measure(static_cast<double>(c.naive_wrong), static_cast<double>(c.robust_wrong),
                  {slope.x, slope.y});
      }
}

void far_edges(Trial& t) {
  struct Sample {
    vec2 from, to;
    int x, y;
  };
  std::vector<Sample> inputs;
  const auto naive_edge = [](const Sample& s) {
    const float a = s.from.y - s.to.y, b = s.to.x - s.from.x, c = s.from.x * s.to.y - s.to.x * s.from.y;
    return a * (static_cast<float>(s.x) + 0.5F) + b * (static_cast<float>(s.y) + 0.5F) + c;
  };
  const auto grid = [](const vec2& p) {
    return kernels::GridPoint{kernels::snap(static_cast<double>(p.x), 8),
                              kernels::snap(static_cast<double>(p.y), 8)};
  };
  const auto robust_edge = [&](const Sample& s) {
    const kernels::Edge e(grid(s.from), grid(s.to));
    return kernels::Edge::covers(e.at_pixel(s.x, s.y),
                                 e.at_offset(kernels::sample_unit / 2, kernels::sample_unit / 2));
  };
  for (std::size_t n = t.samples(100000, 10000000); n-- > 0;) {
    const auto near_16k = [&] { return 16000 + static_cast<float>(t.random.below(384 * 256)) / 256; };
    Sample s{{near_16k(), near_16k()}, {near_16k(), near_16k()}, 0, 0};
    const auto u = static_cast<float>(t.random.uniform(0, 1));
    const vec2 on = s.from + (s.to - s.from) * u;
    s.x = static_cast<int>(on.x), s.y = static_cast<int>(on.y);
    const kernels::GridPoint p = grid(s.from), q = grid(s.to);
    const Wide e = Wide(q.x - p.x) * (s.y * 256 + 128 - p.y) - Wide(q.y - p.y) * (s.x * 256 + 128 - p.x);
    const bool top_left = p.y > q.y || (p.y == q.y && q.x > p.x);
    const bool want = e > 0 || (e == 0 && top_left);
    t.tally((naive_edge(s) > 0) != (e > 0), robust_edge(s) != want,
            {s.from.x, s.from.y, s.to.x, s.to.y, static_cast<double>(s.x), static_cast<double>(s.y)});
    if (inputs.size() < 1000) inputs.push_back(s);
  }
  t.price_over(inputs, naive_edge, robust_edge);
}

// Whether the middle of pixel (x, y) belongs to the triangle of snapped corners, by the top-left rule.
bool covers_in_integers(const Corners& p, int x, int y) {
  std::array<std::array<Wide, 2>, 3> g;
  for (std::size_t k = 0; k < 3; ++k)
    g[k] = {Wide(std::nearbyint(p[k].x * 256.0)), Wide(std::nearbyint(p[k].y * 256.0))};
  const auto edge = [](const std::array<Wide, 2>& a, const std::array<Wide, 2>& b, Wide px, Wide py) {
    return (b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0]);
  };
  if (edge(g[0], g[1], g[2][0], g[2][1]) < 0) std::swap(g[1], g[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto &a = g[i], &b = g[(i + 1) % 3];
    const Wide e = edge(a, b, Wide(x) * 256 + 128, Wide(y) * 256 + 128);
    const bool top_left = a[1] > b[1] || (a[1] == b[1] && b[0] > a[0]);
    if (e < 0 || (e == 0 && !top_left)) return false;
  }
  return true;
}

void slivers(Trial& t) {
  const auto judge = [&](const Corners& p, int x0, int y0, int width, int height) {
    ScreenTriangles mesh;
    mesh.add(vec4(p[0], 0.1F, 1), vec4(p[1], 0.9F, 1), vec4(p[2], 0.5F, 1), 0);
    const Picture got = filled(mesh.mesh(), width, height, kernels::centre_sample(), x0, y0);
    const auto values = interpolated(mesh.mesh(), got, {-1, 2, 0.5F}, x0, y0);
    std::size_t naive_wrong = 0, wrong = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const bool want = covers_in_integers(p, x0 + x, y0 + y), is = got.at(x, y) != kernels::no_face;
        wrong += is != want ? 1 : 0;
        naive_wrong +=
            covers_naively(p, static_cast<float>(x0 + x) + 0.5F, static_cast<float>(y0 + y) + 0.5F) != want
                ? 1
                : 0;
        const float v = values[static_cast<std::size_t>(y * width + x)], z = got.depth(x, y);
        if (is)
          t.require(v >= -1 && v <= 2 && z >= 0.1F && z <= 0.9F, "attributes within the corners' range",
                    {p[1].x, p[1].y});
      }
    t.measure(static_cast<double>(naive_wrong), static_cast<double>(wrong),
              {p[0].x, p[0].y, p[1].x, p[1].y, p[2].x, p[2].y});
  };
  constexpr float step = 1.0F / 256;
  for (const float up : {0.0F, 0.5F, 0.25F}) {
    judge({vec2(0, up), vec2(16384, up + step), vec2(16384, up + 2 * step)}, 0, 0, 16384, 4);
    judge({vec2(up, 0), vec2(up + 2 * step, 16384), vec2(up + step, 16384)}, 0, 0, 4, 16384);
    judge({vec2(0, up), vec2(16384, 3 + step), vec2(16384, 3 + 2 * step)}, 0, 0, 16384, 4);
  }
  for (std::size_t n = t.samples(10, 500); n-- > 0;) {
    const auto far = static_cast<float>(15000 + static_cast<double>(t.random.below(1384 * 256)) / 256),
               side = static_cast<float>(15000 + static_cast<double>(t.random.below(1384 * 256)) / 256);
    const vec2 end(far, side), other = end + vec2(step, -step * static_cast<float>(t.random.below(3)));
    judge({vec2(0, 0), end, other}, 8000, static_cast<int>(8000 * side / far), 256, 256);
  }
}

void fixed_point_overflow(Trial& t) {
  struct Sample {
    kernels::GridPoint from, to;
    int x, y;
  };
  std::vector<Sample> inputs;
  const auto textbook = [](const Sample& s) {
    const auto w = [](std::int64_t v) { return static_cast<std::uint32_t>(v); };  // wraps as int32 does
    return static_cast<std::int32_t>((w(s.to.x) - w(s.from.x)) * (w(s.y * 256) - w(s.from.y)) -
                                     (w(s.to.y) - w(s.from.y)) * (w(s.x * 256) - w(s.from.x)));
  };
  const auto robust = [](const Sample& s) { return kernels::Edge(s.from, s.to).at_pixel(s.x, s.y); };
  for (const int size : {8192, 32768, 65536})
    for (std::size_t n = t.samples(20000, 2000000); n-- > 0;) {
      const auto coordinate = [&] {
        return static_cast<std::int32_t>(t.random.below(static_cast<std::size_t>(size) * 256));
      };
      const auto pixel = [&] { return static_cast<int>(t.random.below(static_cast<std::size_t>(size))); };
      const Sample s{{coordinate(), coordinate()}, {coordinate(), coordinate()}, pixel(), pixel()};
      const Wide want = Wide(s.to.x - s.from.x) * (Wide(s.y) * 256 - s.from.y) -
                        Wide(s.to.y - s.from.y) * (Wide(s.x) * 256 - s.from.x);
      t.tally(textbook(s) != want, robust(s) != want,
              {static_cast<double>(s.from.x), static_cast<double>(s.from.y), static_cast<double>(s.to.x),
               static_cast<double>(s.to.y), static_cast<double>(s.x), static_cast<double>(s.y)});
      if (inputs.size() < 1000) inputs.push_back(s);
    }
  // Corners at the limit, a pixel at the other end of the largest window.
  const auto end = static_cast<std::int32_t>(kernels::corner_limit_px * kernels::corner_unit);
  const kernels::Edge extreme({-end, -end}, {end, end});
  const Wide want = Wide(2) * end * (Wide(65535) * 256 + end) - Wide(2) * end * (Wide(-65536) * 256 + end);
  t.require(Wide(extreme.at_pixel(-65536, 65535)) == want, "corners at the limit do not overflow");
  t.price_over(inputs, textbook, robust);
}

constexpr std::array<std::array<int, 3>, 6> orders{
    {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};

void order_of_corners(Trial& t) {
  for (std::size_t n = t.samples(150, 10000); n-- > 0;) {
    std::array<vec4, 3> p;
    for (auto& q : p)
      q = {static_cast<float>(t.random.uniform(-8, 72)), static_cast<float>(t.random.uniform(-8, 72)),
           static_cast<float>(t.random.uniform(0, 1)), 1};
    const auto in_order = [&](const std::array<int, 3>& o) {
      ScreenTriangles mesh;
      const auto at = [&](int k) { return p[static_cast<std::size_t>(o[static_cast<std::size_t>(k)])]; };
      mesh.add(at(0), at(1), at(2), 0);
      return filled(mesh.mesh(), 64, 64);
    };
    // z0 + l1 (z1 - z0) + l2 (z2 - z0), from whichever corner comes first.
    const auto textbook = [&](const std::array<int, 3>& o, float x, float y) {
      const auto at = [&](std::size_t k) { return p[static_cast<std::size_t>(o[k])]; };
      const vec2 a(at(0)), b = vec2(at(1)) - a, c = vec2(at(2)) - a, d = vec2(x, y) - a;
      const float area = b.x * c.y - b.y * c.x;
      const float l1 = (d.x * c.y - d.y * c.x) / area, l2 = (b.x * d.y - b.y * d.x) / area;
      return at(0).z + l1 * (at(1).z - at(0).z) + l2 * (at(2).z - at(0).z);
    };
    const Picture first = in_order(orders[0]);
    bool naive_differs = false, differs = false;
    for (std::size_t k = 1; k < 6; ++k) {
      const Picture other = in_order(orders[k]);
      differs = differs || other.id != first.id ||
                !std::equal(other.z.begin(), other.z.end(), first.z.begin(),
                            [](float x, float y) { return bits(x) == bits(y); });
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
          if (first.at(x, y) == 0)
            naive_differs =
                naive_differs ||
                bits(textbook(orders[0], static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F)) !=
                    bits(textbook(orders[k], static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F));
    }
    t.tally(naive_differs, differs, {p[0].x, p[0].y, p[1].x, p[1].y, p[2].x, p[2].y});
  }
}

std::array<vec4, 3> random_triangle(Trial& t, float size) {
  std::array<vec4, 3> p;
  for (auto& q : p)
    q = {static_cast<float>(t.random.uniform(0, size)), static_cast<float>(t.random.uniform(0, size)), 0.5F,
         static_cast<float>(t.random.uniform(0.1, 2))};
  return p;
}

void constant_attribute(Trial& t) {
  const auto textbook = [](const vec3& l, float a) { return l.x * a + l.y * a + l.z * a; };
  for (std::size_t n = t.samples(50, 5000); n-- > 0;) {
    const auto p = random_triangle(t, 64);
    ScreenTriangles mesh;
    mesh.add(p[0], p[1], p[2], 0);
    const auto a = n == 0 ? 0.7F : static_cast<float>(t.random.uniform(0, 1));
    const Picture picture = filled(mesh.mesh(), 64, 64);
    const auto values = interpolated(mesh.mesh(), picture, {a, a, a});
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (picture.id[i] == kernels::no_face) continue;
      const auto l1 = static_cast<float>(t.random.uniform(0, 1)),
                 l2 = (1 - l1) * static_cast<float>(t.random.uniform(0, 1));
      t.tally(textbook({1 - l1 - l2, l1, l2}, a) != a, bits(values[i]) != bits(a),
              {a, static_cast<double>(i)});
    }
  }
}

void broken_corner(Trial& t) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf, -inf, 3e38F})
    for (int component = 0; component < 4; ++component)
      for (std::size_t corner = 0; corner < 3; ++corner) {
        if (bad == 3e38F && component == 3) continue;  // a corner very near to the eye is not broken
        std::array<vec4, 3> p{vec4(1, 1, 0.5F, 1), vec4(30, 2, 0.5F, 1), vec4(4, 28, 0.5F, 1)};
        p[corner][component] = bad;
        ScreenTriangles mesh;
        mesh.add(p[0], p[1], p[2], 0);
        const Picture got = filled(mesh.mesh(), 32, 32);
        const auto bins = kernels::bin_triangles(mesh.mesh(), kernels::centre_sample(), {0, 0, 32, 32});
        t.require(bins.out_of_range == 1, "a broken corner is counted", {static_cast<double>(component)});
        // The textbook rejects a pixel where an edge function is negative: NaN never is.
        std::size_t naive_pixels = 0;
        for (int y = 0; y < 32; ++y)
          for (int x = 0; x < 32; ++x) {
            bool rejected = false;
            for (std::size_t i = 0; i < 3; ++i) {
              const vec4 &a = p[i], &b = p[(i + 1) % 3];
              rejected = rejected || (a.y - b.y) * (static_cast<float>(x) + 0.5F - a.x) +
                                             (b.x - a.x) * (static_cast<float>(y) + 0.5F - a.y) <
                                         0;
            }
            naive_pixels += rejected ? 0 : 1;
          }
        const auto drawn_pixels = static_cast<double>(
            std::count_if(got.id.begin(), got.id.end(), [](auto id) { return id != kernels::no_face; }));
        t.measure(static_cast<double>(naive_pixels), drawn_pixels,
                  {bad, static_cast<double>(component), static_cast<double>(corner)});
      }
}

void overshoot(Trial& t) {
  // The sample that is covered lies in a pixel's corner; the textbook takes the depth of its middle.
  const std::array<std::uint16_t, 1> x_offset{200}, y_offset{3900};
  const kernels::SamplePositions pattern{1, 1, x_offset, y_offset};
  for (std::size_t n = t.samples(300, 30000); n-- > 0;) {
    const vec2 a(static_cast<float>(t.random.uniform(0, 64)), static_cast<float>(t.random.uniform(0, 64))),
        along(static_cast<float>(t.random.uniform(-60, 60)), static_cast<float>(t.random.uniform(-60, 60)));
    const auto width = static_cast<float>(t.random.uniform(0.01, 0.5));
    const vec2 b = a + along, c = a + along * 0.5F + vec2(-along.y, along.x) * (width / 60);
    ScreenTriangles mesh;
    mesh.add(vec4(a, 0.1F, 1), vec4(b, 0.2F, 1), vec4(c, 0.9F, 1), 0);
    const Picture got = filled(mesh.mesh(), 64, 64, pattern);
    const auto outside = [](float z) {
      return static_cast<double>(std::max({0.1F - z, z - 0.9F, 0.0F})) / 0x1p-24;
    };
    const vec2 ab = b - a, ac = c - a;
    const float area = ab.x * ac.y - ab.y * ac.x;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        if (got.at(x, y) == kernels::no_face) continue;
        const vec2 d = vec2(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F) - a;
        const float z =
            0.1F + (d.x * ac.y - d.y * ac.x) / area * 0.1F + (ab.x * d.y - ab.y * d.x) / area * 0.8F;
        t.measure(outside(z), outside(got.depth(x, y)), {a.x, a.y, b.x, b.y, c.x, c.y});
      }
  }
}

void same_place_two_ways(Trial& t) {
  const auto volume = kernels::perspective(1, 1.5, 0.1, 100);
  const auto view = kernels::look_at({3, 2, 5}, {0, 0.5, 0}, {0, 1, 0}).eye_from_world;
  const glm::mat4 v(kernels::matrix_of(view)), p(kernels::matrix_of(volume)), together = p * v;
  std::vector<vec3> world(20000);
  for (vec3& x : world)
    for (int i = 0; i < 3; ++i) x[i] = static_cast<float>(t.random.uniform(-2, 2));
  const auto by_nodes = [&](const std::vector<vec3>& points) {
    std::vector<vec3> eye(points.size());
    std::vector<vec4> clip(points.size());
    project::world_to_eye<float>(view, points, eye);
    kernels::map_to_clip<float>(volume, eye, clip);
    return clip;
  };
  // The other mesh holds the same points elsewhere in its buffer, among others.
  std::vector<vec3> shifted(world.rbegin(), world.rend());
  shifted.insert(shifted.begin(), 13, vec3(0));
  const auto one = by_nodes(world), other = by_nodes(shifted);
  for (std::size_t i = 0; i < world.size(); ++i) {
    const vec4 x(world[i], 1);
    t.tally(together * x != p * (v * x), one[i] != other[other.size() - 1 - i], {x.x, x.y, x.z});
  }
  t.price(
      [&] {
        std::vector<vec4> clip(world.size());
        for (std::size_t i = 0; i < world.size(); ++i) clip[i] = p * (v * vec4(world[i], 1));
        keep(clip[0]);
      },
      [&] { keep(by_nodes(world)[0]); });
}

}  // namespace

std::vector<HardCase> triangles() {
  return {
      {"TRI-01", "nets of 3200 random triangles without gaps, 0, 4000 and 60000 px out",
       "A x + B y + C >= 0 in float", "kernels::screen_triangle, Edge", "each pixel once",
       "every pixel is covered exactly once", "pixels not covered once", 0, shared_edges},
      {"TRI-03", "nets whose edges run through pixel centres, slopes 0, 1/2, 1, 2, both windings",
       ">= 0 on both sides", "kernels::screen_triangle, Edge", "each pixel once",
       "every pixel is covered exactly once", "pixels not covered once", 0, edges_through_centres},
      {"TRI-05", "edges at 16000 to 16384 px, samples in the pixels they cross", "A x + B y + C in float",
       "kernels::Edge", "128-bit integers", "no wrong side", "wrong sides", 0, far_edges},
      {"TRI-06", "triangles 1/256 px wide and 16384 px long, level, upright, oblique",
       "A x + B y + C >= 0 in float", "kernels: bins, simd::fill_triangles, interpolate_attributes",
       "128-bit integers", "the set of pixels is exact; depth and attributes within the corners' range",
       "wrong pixels", 0, slivers},
      {"TRI-07", "random edges in pictures of 8192, 32768 and 65536 px; corners at the limit",
       "8 sub-pixel bits in int32", "kernels::Edge::at_pixel", "128-bit integers", "no overflow",
       "wrong edge values", 0, fixed_point_overflow},
      {"TRI-09", "random triangles, their corners in all six orders",
       "z0 + l1 (z1 - z0) + l2 (z2 - z0) in float", "kernels: bins, simd::fill_triangles",
       "comparison of bits", "coverage and depth have the same bits in every order",
       "triangles that depend on the order", 0, order_of_corners},
      {"TRI-10", "the same number at all three corners", "l0 a + l1 a + l2 a in float",
       "kernels::simd::interpolate_attributes", "equality", "the number itself, bit for bit",
       "changed samples", 0, constant_attribute},
      {"TRI-11", "a corner with NaN, an infinity or 3e38", "reject where an edge function is below 0",
       "kernels: bins, simd::fill_triangles", "truth table", "nothing is drawn, the triangle is counted",
       "pixels drawn", 0, broken_corner},
      {"TRI-12", "slivers with depths 0.1, 0.2, 0.9, sampled in a corner of the pixel",
       "depth of the pixel's middle, float", "kernels: bins, simd::fill_triangles", "the corners' depths",
       "within the corners' depths and 2 ulp", "ulp outside", 2, overshoot},
      {"TRI-13", "20000 points of two meshes, at other places of their buffers",
       "(P V) p against P (V p), float", "project::world_to_eye, kernels::map_to_clip", "comparison of bits",
       "the same bits in both meshes", "points that differ", 0, same_place_two_ways},
  };
}

}  // namespace frustum::hard
