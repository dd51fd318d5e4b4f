// Clipping; culling stands in culling.cpp.
#include "nodes/clip/line.h"
#include "nodes/kernels/clip.h"
#include "nodes/kernels/screen_triangle.h"
#include "nodes/kernels/vector.h"
#include "tests/hard/exact.h"
#include "tests/hard/screen.h"
#include "tests/hard/stages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>
#include <set>
#include <vector>

namespace frustum::hard {
namespace {

using glm::vec4;
using Ring = std::vector<vec4>;
constexpr float largest = std::numeric_limits<float>::max();
const auto volume = kernels::view_volume();
constexpr std::size_t right_side = 3;  // planes[3] of the volume: x <= w

bool same_bits(const vec4& a, const vec4& b) {
  return std::bit_cast<std::array<std::uint32_t, 4>>(a) == std::bit_cast<std::array<std::uint32_t, 4>>(b);
}

float side(const vec4& p) { return p.w - p.x; }  // of x <= w

// Sutherland and Hodgman as the textbook has it: the crossing is measured from the first end of the edge.
vec4 textbook_crossing(const vec4& a, const vec4& b) {
  const float da = side(a), db = side(b), t = da / (da - db);
  return a + (b - a) * t;
}

Ring textbook_clip(const Ring& ring) {
  Ring out;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const vec4 &a = ring[i], &b = ring[(i + 1) % ring.size()];
    const bool a_in = side(a) >= 0, b_in = side(b) >= 0;
    if (a_in) out.push_back(a);
    if (a_in != b_in) out.push_back(textbook_crossing(a, b));
  }
  return out;
}

kernels::ClipRing<float> ring_of(const Ring& points) {
  kernels::ClipRing<float> ring;
  for (const vec4& p : points) ring.push({p, {1, 0, 0}, 0});
  return ring;
}

Ring clipped(const Ring& points) {
  const auto ring = kernels::clip_halfspace(ring_of(points), volume, right_side);
  Ring out;
  for (std::size_t i = 0; i < ring.size; ++i) out.push_back(ring.vertex[i].p);
  return out;
}

vec4 point(Trial& t, double size = 2) {
  vec4 p;
  for (int i = 0; i < 4; ++i) p[i] = static_cast<float>(t.random.uniform(-size, size));
  return p;
}

struct Edge {
  vec4 in, out;
};
Edge crossing_edge(Trial& t) {
  for (;;) {
    const vec4 a = point(t), b = point(t);
    if (side(a) > 0 && side(b) < 0) return {a, b};
  }
}

vec4 robust_crossing(const Edge& e) {
  return kernels::clip_crossing<float>(volume, right_side, {e.in, {1, 0, 0}, 0}, {e.out, {0, 1, 0}, 1}).p;
}

void price_of_crossings(Trial& t) {
  std::vector<Ring> inputs(500);
  for (auto& ring : inputs) {
    const Edge e = crossing_edge(t);
    ring = {e.in, e.out, point(t)};
  }
  t.price_over(inputs, textbook_clip, clipped);
}

void shared_edge(Trial& t) {
  for (std::size_t n = t.samples(100000, 1000000); n-- > 0;) {
    const Edge e = crossing_edge(t);
    // The neighbours on either side walk the edge in opposite directions; their third corners are inside.
    const vec4 third(-1, 0, 0, 1);
    const Ring one = clipped({e.in, e.out, third}), other = clipped({e.out, e.in, third});
    t.tally(!same_bits(textbook_crossing(e.in, e.out), textbook_crossing(e.out, e.in)),
            one.size() != 4 || other.size() != 4 || !same_bits(one[1], other[0]),
            {e.in.x, e.in.y, e.in.z, e.in.w, e.out.x, e.out.y, e.out.z, e.out.w});
  }
  price_of_crossings(t);
}

// What is left of a triangle inside x <= w in exact arithmetic: distinct corners (x, y), w = 1 everywhere.
struct Left {
  std::size_t corners;
  Rational area;
};
using Point2 = std::array<Rational, 2>;

Left measured(const std::vector<Point2>& ring) {
  std::vector<Point2> distinct;
  for (const auto& p : ring)
    if (std::find(distinct.begin(), distinct.end(), p) == distinct.end()) distinct.push_back(p);
  Rational area = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const auto &p = ring[i], &q = ring[(i + 1) % ring.size()];
    area += p[0] * q[1] - p[1] * q[0];
  }
  return {distinct.size() < 3 ? 0 : distinct.size(), ::abs(area)};
}

Left exact_left(const Ring& points) {
  std::vector<Point2> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const vec4 &a = points[i], &b = points[(i + 1) % points.size()];
    const Rational da = 1 - Rational(a.x), db = 1 - Rational(b.x);
    if (da >= 0) out.push_back({a.x, a.y});
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
      const Rational s = da / (da - db);
      out.push_back({Rational(a.x) + s * (Rational(b.x) - Rational(a.x)),
                     Rational(a.y) + s * (Rational(b.y) - Rational(a.y))});
    }
  }
  return measured(out);
}

void corners_on_the_plane(Trial& t) {
  // x at equal distances from 1, so that every crossing is exact; y spreads the corners.
  const auto judge = [&](float ax, float bx, float cx) {
    const Ring ring{{ax, 0, 0, 1}, {bx, 4, 0, 1}, {cx, 0.5F, -0.0F, 1}};
    const Left want = exact_left(ring);
    const auto wrong = [&](const Ring& got) {
      std::vector<Point2> points;
      for (const vec4& p : got) points.push_back({p.x, p.y});
      return got.size() != want.corners || (want.corners > 0 && measured(points).area != want.area);
    };
    t.tally(wrong(textbook_clip(ring)), wrong(clipped(ring)), {ax, bx, cx});
  };
  const auto all_of = [&](std::array<float, 3> x) {
    for (const float p : x)
      for (const float q : x)
        for (const float r : x)
          if (p != q || q != r) judge(p, q, r);
  };
  all_of({0, 1, 2}), all_of({0.5F, 1, 1.5F}), all_of({-1, 1, 3});
  price_of_crossings(t);
}

void edge_along_the_plane(Trial& t) {
  const auto judge = [&](const Edge& e) {
    const Rational d_in = Rational(e.in.w) - Rational(e.in.x), d_out = Rational(e.out.w) - Rational(e.out.x);
    if (!(d_in > 0 && d_out < 0)) return;
    const vec4 got = robust_crossing(e), textbook = textbook_crossing(e.in, e.out);
    const Rational s = d_in / (d_in - d_out);
    double naive_error = 0, error = 0;
    const float scale = std::max(kernels::largest_component(e.in), kernels::largest_component(e.out));
    for (int i = 0; i < 4; ++i) {
      const Rational want = Rational(e.in[i]) + s * (Rational(e.out[i]) - Rational(e.in[i]));
      const Rational unit = Rational(scale) * Rational(u32);
      naive_error = std::max(naive_error, distance(textbook[i], want, unit));
      error = std::max(error, distance(got[i], want, unit));
      const auto [low, high] = std::minmax(e.in[i], e.out[i]);
      t.require(got[i] >= low && got[i] <= high, "the crossing lies in the edge's box",
                {e.in.x, e.in.w, e.out.x, e.out.w});
    }
    t.measure(naive_error, error, {e.in.x, e.in.y, e.in.z, e.in.w, e.out.x, e.out.y, e.out.z, e.out.w});
  };
  constexpr float tiny = std::numeric_limits<float>::denorm_min();
  judge({{0, 1, 0, tiny}, {tiny, -1, 0, 0}});
  judge({{-1e-30F, 1, 0, 1}, {1e-30F, 0, 0, 0}});
  judge({{1, 1, 0, std::nextafter(1.0F, 2.0F)}, {1, -1, 0.5F, std::nextafter(1.0F, 0.0F)}});
  judge({{0, largest, 0, largest}, {largest, -largest, 0, -largest}});
  judge({{-largest, 1, 0, largest}, {largest, 1, 0, -largest}});
  for (std::size_t n = t.samples(5000, 500000); n-- > 0;) {
    const Edge e = crossing_edge(t);
    const float size = std::ldexp(1.0F, static_cast<int>(t.random.below(250)) - 124);
    const float w = size * static_cast<float>(t.random.uniform(0.5, 1)), ulp = std::nextafter(w, largest) - w;
    const auto steps = [&] { return ulp * static_cast<float>(1 + t.random.below(8)); };
    judge(
        {{w, e.in.y * size, e.in.z * w / 3, w + steps()}, {w + steps(), e.out.y * size, e.out.z * w / 3, w}});
  }
  price_of_crossings(t);
}

void straddling_the_eye(Trial& t) {
  std::vector<ClipTriangle> inputs{{vec4(0.5F, 0.5F, 0, 1), vec4(-0.5F, 0.5F, 0, 1), vec4(1, -1, 0, -1)}};
  for (std::size_t n = t.samples(12, 1000); n-- > 0;) {
    // All three corners look as if they were in view: |x / w| <= 1, |y / w| <= 1.
    ClipTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto w = static_cast<float>((k == 2 ? -1 : 1) * t.random.uniform(0.5, 2));
      const auto in_view = [&] { return w * static_cast<float>(t.random.uniform(-0.9, 0.9)); };
      triangle[k] = {in_view(), in_view(), 0.5F * in_view(), w};
    }
    inputs.push_back(triangle);
  }
  for (const auto& triangle : inputs) {
    const auto want = seen(triangle, 64, 64);
    t.measure(static_cast<double>(wrong_pixels(drawn_without_clipping({&triangle, 1}, 64, 64), want)),
              static_cast<double>(wrong_pixels(drawn({&triangle, 1}, 64, 64), want)),
              {triangle[2].x, triangle[2].y, triangle[2].z, triangle[2].w});
  }
  t.price(
      [&] {
        for (const auto& x : inputs) keep(drawn_without_clipping({&x, 1}, 64, 64).id[0]);
      },
      [&] {
        for (const auto& x : inputs) keep(drawn({&x, 1}, 64, 64).id[0]);
      });
}

void clipping_twice(Trial& t) {
  for (std::size_t n = t.samples(100000, 1000000); n-- > 0;) {
    const Edge e = crossing_edge(t);
    const Ring once = clipped({e.in, e.out, vec4(-1, 0, 0, 1)}), twice = clipped(once);
    bool same = once.size() == twice.size();
    for (std::size_t i = 0; same && i < once.size(); ++i)
      same = same_bits(once[i], twice[i]) && side(once[i]) >= 0;
    t.tally(side(textbook_crossing(e.in, e.out)) < 0, !same,
            {e.in.x, e.in.y, e.in.z, e.in.w, e.out.x, e.out.y, e.out.z, e.out.w});
  }
  price_of_crossings(t);
}

// The textbook's clip against all sides of the volume, in the order of `planes`.
Ring textbook_clip(Ring ring, const std::array<kernels::ClipPlane, 6>& planes) {
  for (const auto& plane : planes) {
    const auto inside = [&](const vec4& p) {
      return static_cast<float>(plane.sign) * p[plane.axis] + static_cast<float>(plane.bound) * p.w;
    };
    Ring out;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const vec4 &a = ring[i], &b = ring[(i + 1) % ring.size()];
      const float da = inside(a), db = inside(b);
      if (da >= 0) out.push_back(a);
      if ((da >= 0) != (db >= 0)) out.push_back(a + (b - a) * (da / (da - db)));
    }
    ring = out;
  }
  return ring;
}

// Corners on a screen of 1024 px, in 1/256 px.
using Snapped = std::set<std::array<std::int32_t, 2>>;
Snapped snapped(const Ring& ring) {
  Snapped corners;
  for (const vec4& p : ring) {
    const auto px = [&](float x) { return kernels::snap(static_cast<double>(x / p.w) * 512, 8); };
    if (p.w > 0) corners.insert({px(p.x), px(p.y)});
  }
  return corners;
}

Ring clipped_by(const ClipTriangle& t, const std::array<kernels::ClipPlane, 6>& planes) {
  const auto ring = kernels::clip_triangle<float>(planes, 0x3f, t[0], t[1], t[2]);
  Ring out;
  for (std::size_t i = 0; i < ring.size; ++i) out.push_back(ring.vertex[i].p);
  return out;
}

void order_of_planes(Trial& t) {
  for (std::size_t n = t.samples(30, 2000); n-- > 0;) {
    ClipTriangle triangle;
    for (auto& p : triangle) {
      p = point(t, 3);
      p.w = static_cast<float>(std::exp2(t.random.uniform(-10, 10)));
      for (int i = 0; i < 3; ++i) p[i] *= p.w;
    }
    const Ring corners(triangle.begin(), triangle.end());
    const Snapped naive_first = snapped(textbook_clip(corners, volume)),
                  first = snapped(clipped_by(triangle, volume));
    bool naive_differs = false, differs = false;
    std::array<std::size_t, 6> order{0, 1, 2, 3, 4, 5};
    while (std::next_permutation(order.begin(), order.end())) {
      std::array<kernels::ClipPlane, 6> planes = volume;
      for (std::size_t i = 0; i < 6; ++i) planes[i] = volume[order[i]];
      naive_differs = naive_differs || snapped(textbook_clip(corners, planes)) != naive_first;
      differs = differs || snapped(clipped_by(triangle, planes)) != first;
    }
    t.tally(naive_differs, differs, {triangle[0].x, triangle[0].y, triangle[0].z, triangle[0].w});
  }
}

void at_infinity(Trial& t) {
  std::vector<ClipTriangle> inputs;
  for (std::size_t n = t.samples(12, 1000); n-- > 0;) {
    ClipTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = point(t);
      triangle[k].z *= 0.2F;
      triangle[k].w = k == 0 ? 0 : 1 + std::fabs(triangle[k].w);
    }
    inputs.push_back(triangle);
  }
  inputs.push_back({vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(-1, -1, 1, 0)});
  for (const auto& triangle : inputs) {
    const auto want = seen(triangle, 64, 64);
    t.measure(static_cast<double>(wrong_pixels(drawn_without_clipping({&triangle, 1}, 64, 64), want)),
              static_cast<double>(wrong_pixels(drawn({&triangle, 1}, 64, 64), want)),
              {triangle[0].x, triangle[0].y, triangle[0].z});
    ClipTriangle limit = triangle;
    for (auto& p : limit) p.w = p.w == 0 ? 1e-30F : p.w;
    t.require(wrong_pixels(drawn({&limit, 1}, 64, 64), want) == 0, "as in the limit w = 1e-30",
              {triangle[0].x});
  }
  t.price(
      [&] {
        for (const auto& x : inputs) keep(drawn_without_clipping({&x, 1}, 64, 64).id[0]);
      },
      [&] {
        for (const auto& x : inputs) keep(drawn({&x, 1}, 64, 64).id[0]);
      });
}

// ----- segments against the unit square

using Segment2 = std::array<double, 4>;  // x0 y0 x1 y1

struct ExactInterval {
  Rational from = 0, to = 1;
};
std::optional<ExactInterval> exact_interval(const Segment2& s) {
  ExactInterval t;
  const Rational x0(s[0]), y0(s[1]), dx = Rational(s[2]) - x0, dy = Rational(s[3]) - y0;
  const std::array<std::array<Rational, 2>, 4> sides{
      {{-dx, x0}, {dx, Rational(1 - x0)}, {-dy, y0}, {dy, Rational(1 - y0)}}};
  for (const auto& [p, q] : sides) {
    if (p == 0 && q < 0) return std::nullopt;
    if (p == 0) continue;
    const Rational r = q / p;
    if (p < 0 && r > t.from) t.from = r;
    if (p > 0 && r < t.to) t.to = r;
  }
  return t.from <= t.to ? std::optional(t) : std::nullopt;
}

// Liang and Barsky without a branch for p = 0: what is parallel to a side divides by it.
bool textbook_leaves_something(const Segment2& s) {
  const double dx = s[2] - s[0], dy = s[3] - s[1];
  double from = 0, to = 1;
  for (const auto& [p, q] : {std::pair{-dx, s[0]}, {dx, 1 - s[0]}, {-dy, s[1]}, {dy, 1 - s[1]}}) {
    const double r = q / p;
    if (p < 0)
      from = std::max(from, r);
    else
      to = std::min(r, to);
  }
  return from <= to;
}

const auto unit_square = frustum::clip::rectangle_planes({0, 0}, {1, 1});

std::optional<frustum::clip::Part> robust_part(const Segment2& s) {
  return frustum::clip::clip_segment({s[0], s[1], 0, 1}, {s[2], s[3], 0, 1}, unit_square,
                                     [](const frustum::clip::Crossing&) {});
}

void parallel_segments(Trial& t) {
  std::vector<Segment2> inputs;
  const double denormal = std::numeric_limits<double>::denorm_min(), places[] = {-1, -0.0, 0.0, 0.5, 1, 2};
  for (const double x : places)
    for (const double y : places)
      for (const double d : {0.0, -0.0, 0x1p-60, -0x1p-60})
        for (const double e : {0.0, -0.0, 0.25, -3.0})
          inputs.push_back({x, y, x + d, y + e}), inputs.push_back({x, y, x + e, y - d});
  inputs.push_back({0, 0, 0x1p-200, 1}), inputs.push_back({0.5, 1 + 0x1p-52, 3, 1 + 0x1p-52});
  inputs.push_back({denormal, 0, denormal, 1});
  for (std::size_t n = t.samples(2000, 200000); n-- > 0;) {
    // Through a corner, to the last place.
    const double a = t.random.uniform(0.1, 5), b = t.random.uniform(0.1, 5), s = t.random.uniform(0.1, 5);
    inputs.push_back({1 - a, 1 + b, 1 + a * s, 1 - b * s});
  }
  for (const Segment2& s : inputs) {
    const auto want = exact_interval(s);
    const auto got = robust_part(s);
    bool wrong = got.has_value() != want.has_value();
    if (got && want)
      wrong = distance(got->t_from, want->from) > 0x1p-51 || distance(got->t_to, want->to) > 0x1p-51;
    t.tally(textbook_leaves_something(s) != want.has_value(), wrong, {s[0], s[1], s[2], s[3]});
  }
  t.price_over(inputs, textbook_leaves_something,
               [](const Segment2& s) { return robust_part(s).has_value(); });
}

// Cohen and Sutherland in float: (x, y) of both ends; an outcode of 0 is taken.
std::array<float, 4> textbook_ends(std::array<float, 4> s) {
  const auto outcode = [](float x, float y) {
    return (x < 0 ? 1 : x > 1 ? 2 : 0) | (y < 0 ? 4 : y > 1 ? 8 : 0);
  };
  for (int step = 0; step < 8; ++step) {
    const int one = outcode(s[0], s[1]), two = outcode(s[2], s[3]);
    if ((one | two) == 0 || (one & two) != 0) break;
    const int out = one != 0 ? one : two;
    float x = 0, y = 0;
    if ((out & 12) != 0) {
      y = (out & 8) != 0 ? 1.0F : 0.0F;
      x = s[0] + (s[2] - s[0]) * (y - s[1]) / (s[3] - s[1]);
    } else {
      x = (out & 2) != 0 ? 1.0F : 0.0F;
      y = s[1] + (s[3] - s[1]) * (x - s[0]) / (s[2] - s[0]);
    }
    (one != 0 ? s[0] : s[2]) = x, (one != 0 ? s[1] : s[3]) = y;
  }
  return s;
}

void segments_of_the_largest_floats(Trial& t) {
  std::vector<std::array<float, 4>> inputs{{-1e25F, -1e25F, 1e25F, 2e25F},
                                           {-3e38F, 0.25F, 3e38F, 0.5F},
                                           {-3e38F, -3e38F, 3e38F, 3e38F},
                                           {0.5F, -3e38F, 0.25F, 3e38F}};
  for (std::size_t n = t.samples(500, 50000); n-- > 0;) {
    const float size = std::ldexp(1.0F, 80 + static_cast<int>(t.random.below(47)));
    const auto inside = [&] { return static_cast<float>(t.random.uniform(0.01, 0.99)); };
    // Nearly level, through the square.
    inputs.push_back({-size * inside(), inside(), size * inside(), inside()});
  }
  for (const auto& s : inputs) {
    const Segment2 wide{s[0], s[1], s[2], s[3]};
    const auto want = exact_interval(wide);
    const auto got = robust_part(wide);
    const auto textbook = textbook_ends(s);
    t.require(got.has_value() == want.has_value(), "kept where the exact segment meets the square",
              {s[0], s[1], s[2], s[3]});
    if (!want || !got) continue;
    double naive_error = 0, error = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Rational& at = i < 2 ? want->from : want->to;
      const Rational exact = Rational(wide[i % 2]) + at * (Rational(wide[2 + i % 2]) - Rational(wide[i % 2]));
      const auto k = static_cast<glm::length_t>(i % 2);
      const double ours = i < 2 ? got->from[k] : got->to[k];
      naive_error = std::max(naive_error, distance(textbook[i], exact, Rational(u32)));
      error = std::max(error, distance(static_cast<float>(ours), exact, Rational(u32)));
    }
    t.measure(std::isfinite(naive_error) ? naive_error : double{largest}, error, {s[0], s[1], s[2], s[3]});
  }
  t.price_over(inputs, textbook_ends, [](const std::array<float, 4>& s) {
    return robust_part({s[0], s[1], s[2], s[3]}).has_value();
  });
}

}  // namespace

std::vector<HardCase> clipping() {
  return {
      {"CLP-01", "100000 edges across x = w, walked from either end",
       "a + t (b - a) from the edge's first end, float", "kernels::clip_halfspace", "comparison of bits",
       "both neighbours get the same vertex, bit for bit", "edges that crack", 0, shared_edge},
      {"CLP-02", "triangles with 0 to 3 corners on the plane, -0 among them",
       "inside where the distance is >= 0", "kernels::clip_halfspace", "rationals",
       "number of corners and area exact", "wrong polygons", 0, corners_on_the_plane},
      {"CLP-03", "edges within ulps of the plane, and edges of the largest floats",
       "t = d0 / (d0 - d1) in float", "kernels::clip_crossing", "rationals",
       "in the edge's box; within 4 u of its size", "u scale", 4, edge_along_the_plane},
      {"CLP-04", "triangles across w = 0 whose corners all divide into view",
       "divide by w, accept what is in view", "clip, viewport and fill kernels",
       "rays through pixels, 113 bits", "the pixels of the rays, but for those on an edge", "wrong pixels", 0,
       straddling_the_eye},
      {"CLP-06", "100000 edges across x = w, clipped twice", "a + t (b - a) in float",
       "kernels::clip_halfspace", "comparison of bits",
       "the second clip changes nothing; no new vertex is outside", "vertices outside", 0, clipping_twice},
      {"CLP-07", "triangles with w from 2^-10 to 2^10, planes in 720 orders", "a + t (b - a) in float",
       "kernels::clip_triangle", "comparison of snapped corners", "one set of corners, in 1/256 px",
       "triangles that depend on the order", 0, order_of_planes},
      {"CLP-08", "triangles with one or three corners at w = 0", "divide by w, rasterize",
       "clip, viewport and fill kernels", "rays through pixels, 113 bits",
       "finite; the pixels of the rays and of w = 1e-30", "wrong pixels", 0, at_infinity},
      {"CLP-12", "segments along sides, on sides, of no length, by +-0 and 2^-60; through corners",
       "Liang-Barsky, q / p whatever p is", "clip::clip_segment", "rationals",
       "kept exactly where the rationals say, and as far", "wrong segments", 0, parallel_segments},
      {"CLP-13", "segments from -3e38 to 3e38 through the unit square", "Cohen-Sutherland in float",
       "clip::clip_segment", "rationals", "ends within 2 u of the square's side", "u", 2,
       segments_of_the_largest_floats},
  };
}

}  // namespace frustum::hard
