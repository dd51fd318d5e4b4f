// Foundations: vectors, lines, planes.
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/stencil.h"
#include "nodes/kernels/vector.h"
#include "nodes/vector/line.h"
#include "nodes/vector/plane.h"
#include "tests/hard/exact.h"
#include "tests/hard/naive.h"
#include "tests/hard/stages.h"

#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

using glm::dvec2, glm::dvec3, glm::vec3;

// The largest error of a component of the unit vector along v, in ulp; infinite where there is none.
double unit_vector_error(const vec3& got, const vec3& v) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const Real want = exact([&] {
      const Real x = v.x, y = v.y, z = v.z;
      return Real(v[i]) / sqrt(x * x + y * y + z * z);
    });
    const double off = ulps(got[i], want);
    worst = off > worst || off != off ? off : worst;
  }
  return worst;
}

void judge_unit_vector(Trial& t, const vec3& v) {
  const auto unit = kernels::normalized(v);
  t.require(unit.has_value(), "a direction exists", {v.x, v.y, v.z});
  if (!unit) return;
  t.measure(unit_vector_error(naive::normalized(v), v), unit_vector_error(*unit, v), {v.x, v.y, v.z});
  const double length = kernels::norm(dvec3(*unit));
  t.require(std::fabs(length - 1) <= 2 * u32, "| |n| - 1 | <= 2 u", {v.x, v.y, v.z});
}

void price_of_normalizing(Trial& t, double lowest, double highest) {
  std::vector<vec3> inputs(1000);
  for (vec3& v : inputs)
    for (int i = 0; i < 3; ++i) v[i] = static_cast<float>(t.random.uniform(lowest, highest));
  t.price_over(
      inputs, [](const vec3& v) { return naive::normalized(v); },
      [](const vec3& v) { return kernels::normalized_or(v, vec3(0)); });
}

void normalize_large(Trial& t) {
  for (int k = -140; k <= 126; ++k) {
    const float x = std::ldexp(1e20F, k);
    if (!std::isfinite(x) || x == 0) continue;
    judge_unit_vector(t, vec3(x));
    judge_unit_vector(t, {x, 0.3F * x, -0.7F * x});
  }
  price_of_normalizing(t, -1, 1);
}

void normalize_small(Trial& t) {
  judge_unit_vector(t, {1e-23F, 1e-23F, 0});
  judge_unit_vector(t, {3e-22F, 4e-22F, 0});
  for (std::size_t n = t.samples(200, 20000); n-- > 0;) {
    vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = static_cast<float>(t.random.magnitude(-149, -60));
    judge_unit_vector(t, v);
  }
  // Libraries leave "flush to zero" switched on; squares in double do not care.
  const unsigned csr = _mm_getcsr();
  for (const vec3& v : {vec3(1e-23F, 1e-23F, 0), vec3(3e-22F, 4e-22F, 0)}) {
    _mm_setcsr(csr | 0x8040);
    const auto flushed = kernels::normalized(v);
    _mm_setcsr(csr);
    t.require(flushed == kernels::normalized(v), "same bits with FTZ and DAZ on", {v.x, v.y, v.z});
  }
  price_of_normalizing(t, -1e-20, 1e-20);
}

void normalize_nothing(Trial& t) {
  constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const auto has_nan = [](const vec3& v) { return v.x != v.x || v.y != v.y || v.z != v.z; };
  const vec3 axis(0, 0, 1);
  for (const vec3& v : {vec3(0), vec3(-0.0F, 0, 0), vec3(inf, 1, 0), vec3(nan, 0, 0), vec3(0, -inf, inf)}) {
    const auto unit = kernels::normalized(v);
    t.tally(has_nan(naive::normalized(v)), unit.has_value() || has_nan(kernels::normalized_or(v, axis)),
            {v.x, v.y, v.z});
    t.require(kernels::normalized_or(v, axis) == axis, "the fallback is given", {v.x, v.y, v.z});
  }
  price_of_normalizing(t, -1, 1);
}

void angle_of_nearly_parallel(Trial& t) {
  const auto naive_angle = [](const vec3& a, const vec3& b) { return std::acos(naive::dot(a, b)); };
  const vec3 a(1, 0, 0);
  std::vector<vec3> inputs;
  for (int k = 1; k <= 30; ++k)
    for (const double sign : {1.0, -1.0}) {
      const double angle = std::pow(10.0, -k);
      const vec3 b(static_cast<float>(sign * std::cos(angle)), static_cast<float>(std::sin(angle)), 0);
      inputs.push_back(b);
      const Real want = exact([&] { return atan2(Real(b.y), Real(b.x)); });
      const float got = kernels::angle_between(a, b);
      t.measure(ulps(naive_angle(a, b), want), ulps(got, want), {b.x, b.y});
      t.require(got == got, "never NaN", {b.x, b.y});
    }
  t.price_over(
      inputs, [&](const vec3& b) { return naive_angle(a, b); },
      [&](const vec3& b) { return kernels::angle_between(a, b); });
}

// Weights that sum to 1 but for rounding.
std::vector<double> random_weights(Trial& t, std::size_t n) {
  std::vector<double> w(n);
  double sum = 0;
  for (double& x : w) sum += x = t.random.uniform(0, 1);
  for (double& x : w) x /= sum;
  return w;
}

kernels::Stencils one_row(const std::vector<double>& weight) {
  kernels::Stencils rows;
  for (std::size_t i = 0; i < weight.size(); ++i) rows.pair(static_cast<std::uint32_t>(i), weight[i]);
  rows.end_row();
  return rows;
}

template <class T>
T combined(const kernels::Stencils& rows, const std::vector<T>& points) {
  std::vector<T> out(1);
  kernels::apply_affine<T>(rows, points, out);
  return out[0];
}

void affine_combination(Trial& t) {
  const auto naive_sum = [](const std::vector<double>& w, const std::vector<vec3>& p) {
    vec3 sum(0);
    for (std::size_t i = 0; i < p.size(); ++i) sum += static_cast<float>(w[i]) * p[i];
    return sum;
  };
  for (std::size_t n = 3; n <= t.samples(3000, 300000); n *= 3)
    for (int repeat = 0; repeat < 20; ++repeat) {
      const auto w = random_weights(t, n);
      const auto rows = one_row(w);
      const std::vector<vec3> same(n, vec3(1e7F + static_cast<float>(repeat)));
      t.tally(naive_sum(w, same) != same[0], combined(rows, same) != same[0],
              {static_cast<double>(n), same[0].x});

      // Offsets are multiples of 2^-20, so that moving by 2^23 rounds nothing.
      std::vector<double> here(n), there(n);
      for (std::size_t i = 0; i < n; ++i) {
        here[i] = static_cast<double>(t.random.below(1 << 20)) * 0x1p-20;
        there[i] = here[i] + 0x1p23;
      }
      const double moved = combined(rows, there), stayed = combined(rows, here);
      const double gamma_3 = 3 * u64 / (1 - 3 * u64), one_rounding = 0x1p23 * 2 * u64;
      t.require(distance(moved, Rational(stayed) + Rational(0x1p23)) <=
                    static_cast<double>(n) * gamma_3 + one_rounding,
                "moving by 2^23 commutes to n gamma_3 diam and one rounding", {static_cast<double>(n)});
    }
  const auto w = random_weights(t, 64);
  const auto rows = one_row(w);
  std::vector<vec3> points(64);
  for (vec3& p : points) p = vec3(1e7F + static_cast<float>(t.random.uniform(0, 100)));
  t.price(
      [&] {
        for (int i = 0; i < 100; ++i) keep(naive_sum(w, points));
      },
      [&] {
        for (int i = 0; i < 100; ++i) keep(combined(rows, points));
      });
}

int naive_orientation(const dvec2& p, const dvec2& q, const dvec2& r) {
  const double det = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  return (det > 0) - (det < 0);
}

void orientation_on_the_grid(Trial& t) {
  using Wide = __int128;
  const dvec2 q(12, 12), r(24, 24);
  const auto integer = [](double x) { return static_cast<Wide>(x * 0x1p53); };
  for (int i = 0; i < 256; ++i)
    for (int j = 0; j < 256; ++j) {
      const dvec2 p(0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53);
      const Wide det = (integer(q.x) - integer(p.x)) * (integer(r.y) - integer(p.y)) -
                       (integer(q.y) - integer(p.y)) * (integer(r.x) - integer(p.x));
      const int want = (det > 0) - (det < 0), got = kernels::orientation(p, q, r);
      t.tally(naive_orientation(p, q, r) != want, got != want, {p.x, p.y});
      t.require(got == kernels::orientation(q, r, p) && got == -kernels::orientation(q, p, r),
                "turning and swapping the points agree", {p.x, p.y});
    }
  struct Turn {
    dvec2 p, q, r;
  };
  std::vector<Turn> inputs(1000);
  const auto point = [&] { return dvec2(t.random.uniform(), t.random.uniform()); };
  for (Turn& turn : inputs) turn = {point(), point(), point()};
  t.price_over(
      inputs, [](const Turn& x) { return naive_orientation(x.p, x.q, x.r); },
      [](const Turn& x) { return kernels::orientation(x.p, x.q, x.r); });
}

using Four = std::array<dvec3, 4>;

int naive_orientation(const Four& p) {
  const dvec3 a = p[0] - p[3], b = p[1] - p[3], c = p[2] - p[3];
  const double det =
      a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  return (det > 0) - (det < 0);
}

int exact_orientation(const Four& p) {
  std::array<std::array<Rational, 3>, 3> d;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto c = static_cast<int>(k);
      d[i][k] = Rational(p[i][c]) - Rational(p[3][c]);
    }
  return sgn(Rational(d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) +
                      d[0][1] * (d[1][2] * d[2][0] - d[1][0] * d[2][2]) +
                      d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0])));
}

// Points of a random plane, their coordinates some 1e7, moved by 2^-45 of that.
Four nearly_coplanar(Trial& t) {
  const auto vector = [&] {
    return dvec3(t.random.uniform(-1, 1), t.random.uniform(-1, 1), t.random.uniform(-1, 1));
  };
  const dvec3 origin = vector() * 1e7, u = vector() * 1e7, v = vector() * 1e7;
  Four points;
  for (dvec3& p : points) {
    p = origin + u * t.random.uniform(-1, 1) + v * t.random.uniform(-1, 1);
    p += vector() * (1e7 * 0x1p-45);
  }
  return points;
}

void orientation_of_nearly_coplanar(Trial& t) {
  for (std::size_t n = t.samples(20000, 1000000); n-- > 0;) {
    const Four p = nearly_coplanar(t);
    const int want = exact_orientation(p), got = kernels::orientation(p[0], p[1], p[2], p[3]);
    t.tally(naive_orientation(p) != want, got != want,
            {p[0].x, p[0].y, p[0].z, p[1].x, p[1].y, p[1].z, p[2].x, p[2].y, p[2].z, p[3].x, p[3].y, p[3].z});
    t.require(got == -kernels::orientation(p[1], p[0], p[2], p[3]) &&
                  got == -kernels::orientation(p[0], p[1], p[3], p[2]),
              "swapping two points turns the sign", {p[0].x, p[0].y, p[0].z});
  }
  std::vector<Four> inputs(1000);
  for (Four& p : inputs)
    for (dvec3& q : p) q = {t.random.uniform(), t.random.uniform(), t.random.uniform()};
  t.price_over(
      inputs, [](const Four& p) { return naive_orientation(p); },
      [](const Four& p) { return kernels::orientation(p[0], p[1], p[2], p[3]); });
}

using Line = std::array<float, 3>;  // a, b, t

void point_of_a_line(Trial& t) {
  const auto naive_lerp = [](float a, float b, float s) { return a + s * (b - a); };
  const auto robust = [](float a, float b, float s) {
    return kernels::lerp(glm::vec<1, float>(a), glm::vec<1, float>(b), s).x;
  };
  std::vector<Line> inputs;
  for (std::size_t n = t.samples(50000, 5000000); n-- > 0;) {
    const auto a = static_cast<float>(t.random.uniform(-1e8, 1e8));
    const auto b = static_cast<float>(t.random.magnitude(-10, 27));
    t.tally(naive_lerp(a, b, 0) != a || naive_lerp(a, b, 1) != b,
            robust(a, b, 0) != a || robust(a, b, 1) != b, {a, b});
    const auto s = static_cast<float>(t.random.uniform(0, 1));
    const float at = robust(a, b, s), after = robust(a, b, std::nextafter(s, 2.0F));
    t.require(a <= b ? at <= after : at >= after, "monotonic", {a, b, s});
    if (inputs.size() == 1000) continue;
    inputs.push_back({a, b, s});
    const Rational want = Rational(a) + Rational(s) * (Rational(b) - Rational(a));
    const float larger = std::max(std::fabs(a), std::fabs(b));
    const float ulp = std::nextafter(larger, std::numeric_limits<float>::infinity()) - larger;
    t.require(distance(at, want, Rational(ulp)) <= 2, "within 2 ulp of the larger end", {a, b, s});
  }
  for (const double off : {-1e-9, 0.0, 1e-9}) {
    const dvec2 p = kernels::lerp(dvec2(-1e8, 0), dvec2(1e8, 1e-3), 0.5 + off);
    const Rational want = Rational(-1e8) + Rational(0.5 + off) * Rational(2e8);
    t.require(distance(p.x, want, Rational(1e8)) <= 4 * u64, "the middle of a long line", {off});
  }
  t.price_over(
      inputs, [&](const Line& l) { return naive_lerp(l[0], l[1], l[2]); },
      [&](const Line& l) { return robust(l[0], l[1], l[2]); });
}

using Polygon = std::vector<dvec3>;

// The angle to the exact area vector of the corners as they are stored.
double angle_to_area_vector(const dvec3& n, const Polygon& p) {
  std::array<Rational, 3> area;
  for (std::size_t i = 1; i + 1 < p.size(); ++i)
    for (glm::length_t c = 0; c < 3; ++c) {
      const glm::length_t x = (c + 1) % 3, y = (c + 2) % 3;
      const auto side = [&](std::size_t k, glm::length_t axis) -> Rational {
        return Rational(p[k][axis]) - Rational(p[0][axis]);
      };
      area[static_cast<std::size_t>(c)] += side(i, x) * side(i + 1, y) - side(i, y) * side(i + 1, x);
    }
  Real across, along;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t x = (c + 1) % 3, y = (c + 2) % 3;
    const auto component = [&](std::size_t k) { return Real(n[static_cast<glm::length_t>(k)]); };
    const Real cross = component(x) * Real(area[y]) - component(y) * Real(area[x]);
    across = across + cross * cross, along = along + component(c) * Real(area[c]);
  }
  return atan2(sqrt(across), along).to_double();
}

dvec3 by_three_corners(const Polygon& p) {
  return naive::normalized(dvec3(kernels::cross(p[1] - p[0], p[2] - p[1])));
}

void plane_of_a_polygon(Trial& t) {
  const auto judge = [&](const Polygon& p) {
    const auto plane = vector::plane_of(p);
    t.require(plane.has_value(), "the corners span a plane", {p[0].x, p[0].y, p[0].z});
    if (!plane) return;
    const double scale = u64 * plane->condition;
    t.measure(angle_to_area_vector(by_three_corners(p), p) / scale,
              angle_to_area_vector(plane->normal, p) / scale,
              {p[0].x, p[0].y, p[0].z, p[1].x, p[1].y, p[1].z});
  };
  judge({{0, 0, 0}, {1, 0, 0}, {1e6, 1e-6, 0}, {2e6, 0, 1e-9}});
  const auto ring = [&](const dvec3& centre, std::size_t corners) {
    Polygon p;
    const dvec3 u = dvec3(2, -1, 2) / 3.0, v = dvec3(-1, 2, 2) / 3.0;
    for (std::size_t i = 0; i < corners; ++i) {
      const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(corners);
      p.push_back(centre + u * std::cos(angle) + v * std::sin(angle));
    }
    return p;
  };
  judge(ring({1e7, -2e7, 3e7}, 1000));
  for (std::size_t n = t.samples(100, 5000); n-- > 0;)
    judge(ring({t.random.magnitude(0, 24), t.random.magnitude(0, 24), t.random.magnitude(0, 24)},
               3 + t.random.below(60)));
  for (const Polygon& line : {Polygon{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}},
                              {{0.1, 0.1, 0.3}, {0.2, 0.2, 0.6}, {0.3, 0.3, 0.9}},
                              {{0, 0, 0}, {1, 0, 0}, {1e6, 1e-12, 0}, {2e6, 0, 0}}})
    t.require(!vector::plane_of(line), "corners on a line are degenerate", {line[1].x, line[1].y, line[1].z});
  // Triangles: of larger polygons the naive method reads three corners and ours all.
  std::vector<Polygon> triangles;
  for (int i = 0; i < 1000; ++i) triangles.push_back(ring({t.random.uniform(), t.random.uniform(), 1}, 3));
  t.price_over(triangles, by_three_corners, [](const Polygon& p) { return vector::plane_of(p)->normal; });
}

// Cramer's rule for the lines' equations a x + b y = c: c is the size of the coordinates squared.
dvec2 by_cramer(const std::array<dvec2, 4>& p) {
  const auto line = [](const dvec2& from, const dvec2& to) {
    return dvec3(to.y - from.y, from.x - to.x, from.x * to.y - to.x * from.y);
  };
  const dvec3 l = line(p[0], p[1]), m = line(p[2], p[3]);
  const double det = l.x * m.y - m.x * l.y;
  if (det == 0) return dvec2(std::numeric_limits<double>::quiet_NaN());
  return {(l.z * m.y - m.z * l.y) / det, (l.x * m.z - m.x * l.z) / det};
}

// Errors in units of u * condition * the largest coordinate that takes part.
void judge_meeting(Trial& t, const std::array<dvec2, 4>& p) {
  const auto way = [&](std::size_t from, std::size_t to, glm::length_t axis) {
    return Rational(Rational(p[to][axis]) - Rational(p[from][axis]));
  };
  const Rational dx = way(0, 1, 0), dy = way(0, 1, 1), ex = way(2, 3, 0), ey = way(2, 3, 1);
  const Rational area = dx * ey - dy * ex;
  const auto got = vector::meeting_of(p[0], p[1], p[2], p[3]);
  const std::initializer_list<double> witness{p[0].x, p[0].y, p[1].x, p[1].y, p[2].x, p[2].y, p[3].x, p[3].y};
  if (sgn(area) == 0) return t.require(!got, "parallel lines do not meet", witness);
  t.require(got.has_value(), "lines that are not parallel meet", witness);
  if (!got) return;
  const Rational s = (way(0, 2, 0) * ey - way(0, 2, 1) * ex) / area;
  const Rational x = Rational(p[0].x) + s * dx, y = Rational(p[0].y) + s * dy;
  const double lengths =
      std::hypot(dx.get_d(), dy.get_d()) * std::hypot(ex.get_d(), ey.get_d()) / std::fabs(area.get_d());
  t.require(std::fabs(got->condition - lengths) <= 1e-12 * lengths, "the condition is 1 / |sin|", witness);
  double largest = std::max(std::fabs(x.get_d()), std::fabs(y.get_d()));
  for (const dvec2& q : p) largest = std::max({largest, std::fabs(q.x), std::fabs(q.y)});
  const Rational unit = Rational(largest) * Rational(lengths) * Rational(u64);
  const auto off = [&](const dvec2& at) {
    return std::max(distance(at.x, x, unit), distance(at.y, y, unit));
  };
  t.measure(off(by_cramer(p)), off(got->at), witness);
}

void nearly_parallel_lines(Trial& t) {
  judge_meeting(t, {{{0, 0}, {1000, 1000}, {0, -1e-12}, {1000, 1000 * (1 + 1e-12) - 1e-12}}});
  std::vector<std::array<dvec2, 4>> all;
  for (std::size_t n = t.samples(300, 20000); n-- > 0;) {
    const dvec2 from(t.random.magnitude(0, 27), t.random.magnitude(0, 27));
    const dvec2 along(t.random.uniform(-2, 2), t.random.uniform(-2, 2)), across(-along.y, along.x);
    const double turn = t.random.magnitude(-24, 0);
    const dvec2 start = from + across * (turn * t.random.uniform());
    all.push_back({from, from + along, start, start + along + across * turn});
    judge_meeting(t, all.back());
  }
  // Parallel: on the grid, a multiple of the way, from anywhere.
  for (std::size_t n = t.samples(100, 5000); n-- > 0;) {
    const auto whole = [&](int bits) { return std::floor(t.random.magnitude(0, bits)); };
    const dvec2 p(whole(40), whole(40)), q(whole(40), whole(40)), way(whole(20), whole(20));
    if (way != dvec2(0)) judge_meeting(t, {p, p + way, q, q + way * (1 + std::fabs(whole(8)))});
  }
  t.price_over(all, by_cramer,
               [](const std::array<dvec2, 4>& p) { return vector::meeting_of(p[0], p[1], p[2], p[3]); });
}

}  // namespace

std::vector<HardCase> foundations() {
  return {
      {"FND-01", "(1, 1, 1) and another direction times 1e20 2^k, every k from -140 to 126",
       "v / sqrt(v.v) in float", "kernels::normalized", "MPFR",
       "each component within 2 ulp; | |n| - 1 | <= 2 u", "ulp", 2, normalize_large},
      {"FND-02", "(1e-23, 1e-23, 0), (3e-22, 4e-22, 0), random directions down to 2^-149",
       "v / sqrt(v.v) in float", "kernels::normalized", "MPFR",
       "each component within 2 ulp; the same with FTZ and DAZ on", "ulp", 2, normalize_small},
      {"FND-03", "zero, -0, infinite and NaN vectors", "v / sqrt(v.v) in float",
       "kernels::normalized, normalized_or", "truth table",
       "no NaN; the caller is told that there is no direction", "NaN results", 0, normalize_nothing},
      {"FND-04", "(1, 0, 0) against (cos t, sin t, 0), t = 10^-k and pi - 10^-k, k from 1 to 30",
       "acos(a.b) in float", "kernels::angle_between", "MPFR", "within 4 ulp; never NaN", "ulp", 4,
       angle_of_nearly_parallel},
      {"FND-06", "3 to 3000 equal points at 1e7, weights whose sum rounds to 1", "sum w_i p_i in float",
       "kernels::apply_affine", "equality; rationals",
       "equal points come back bit for bit; translation commutes", "points moved", 0, affine_combination},
      {"FND-07", "p on the grid 0.5 + i 2^-53, q = (12, 12), r = (24, 24)", "the 2x2 determinant in double",
       "kernels::orientation (2-D)", "128-bit integers", "no wrong sign; cyclic and antisymmetric",
       "wrong signs", 0, orientation_on_the_grid},
      {"FND-08", "four points of a plane at 1e7, moved by 2^-45", "the 3x3 determinant in double",
       "kernels::orientation (3-D)", "rationals", "no wrong sign; antisymmetric", "wrong signs", 0,
       orientation_of_nearly_coplanar},
      {"FND-09",
       "(0,0,0), (1,0,0), (1e6,1e-6,0), (2e6,0,1e-9); rings of radius 1 and 3 to 1000 corners out to 4e7",
       "the cross product of the first two sides, double", "vector::plane_of",
       "the area vector in rationals, its angle by MPFR",
       "angle <= 8 u cond, cond = perimeter^2 / area; corners on a line are degenerate", "u cond", 8,
       plane_of_a_polygon},
      {"FND-10", "lines at 1e-12 rad; at 2^-24 rad and more, 2 long and up to 2^27 away; parallel ones",
       "Cramer's rule for a x + b y = c", "vector::meeting_of", "rationals",
       "within 8 u cond of the largest coordinate, cond = 1 / |sin|; parallel is decided exactly", "u cond",
       8, nearly_parallel_lines},
      {"FND-12", "lines from +-1e8 to +-2^27, t = 0, 1 and between", "a + t (b - a) in float",
       "kernels::lerp", "rationals", "ends bit for bit; monotonic; within 2 ulp of the larger end",
       "ends missed", 0, point_of_a_line},
  };
}

}  // namespace frustum::hard
