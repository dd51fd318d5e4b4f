// Curves.
#include "nodes/curve/b_spline.h"
#include "nodes/curve/nurbs.h"
#include "nodes/curve/polyline.h"
#include "nodes/curve/supercircle.h"
#include "nodes/kernels/bezier.h"
#include "tests/hard/exact.h"
#include "tests/hard/stages.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

// sum binomial(n, i) t^i (1 - t)^(n - i) c_i, term by term.
Rational bernstein_sum(const std::vector<double>& c, const Rational& t) {
  const std::size_t n = c.size() - 1;
  std::vector<Rational> away{Rational(1)};
  for (std::size_t i = 0; i < n; ++i) away.emplace_back(away.back() * (1 - t));
  Rational sum = 0, choose = 1, power = 1;
  for (std::size_t i = 0; i <= n; ++i) {
    sum += choose * power * away[n - i] * Rational(c[i]);
    power *= t;
    choose = choose * static_cast<unsigned long>(n - i) / static_cast<unsigned long>(i + 1);
  }
  return sum;
}

// Bernstein coefficients of (t - 3/4)^7 (t - 1)^10, each rounded once: the oracle takes the rounded ones.
std::vector<double> seven_fold_root() {
  std::vector<Rational> a{Rational(1)};
  for (int factor = 0; factor < 17; ++factor) {
    const Rational root = factor < 7 ? Rational(3, 4) : Rational(1);
    a.emplace_back(0);
    for (std::size_t i = a.size(); i-- > 0;) a[i] = (i > 0 ? a[i - 1] : Rational(0)) - root * a[i];
  }
  std::vector<double> c;
  for (const Rational& b : kernels::bezier_of_power(std::span<const Rational>(a))) c.push_back(b.get_d());
  return c;
}

void multiple_root(Trial& t) {
  const std::vector<double> c = seven_fold_root();
  const auto plain = [&c](double at) {
    auto d = c;
    return kernels::casteljau(std::span(d), at);
  };
  const auto twice = [&c](double at) {
    return kernels::casteljau_compensated(std::span<const double>(c), at);
  };
  std::vector<double> places;
  for (int k = -200; k <= 200; ++k) places.push_back(0.75 + k * 0x1p-13);
  for (const double at : places) {
    const Rational want = bernstein_sum(c, Rational(at));
    t.measure(distance(plain(at), want, abs(want)), distance(twice(at), want, abs(want)), {at});
  }
  t.price_over(places, plain, twice);
}

void binomial_overflow(Trial& t) {
  for (const std::size_t n : {100U, 126U, 1030U, 2000U})
    for (const double at : {0.125, 0.5, 0.9}) {
      const auto choose = kernels::binomials<double>(n);
      double naive = 0, robust = 0;
      for (std::size_t i = 0; i <= n; ++i)
        naive +=
            choose[i] * std::pow(at, static_cast<double>(i)) * std::pow(1 - at, static_cast<double>(n - i));
      for (const double b : kernels::bernstein(n, at)) robust += b;
      t.measure(std::fabs(naive - 1) / (2 * double(n) * u64), std::fabs(robust - 1) / (2 * double(n) * u64),
                {double(n), at});
    }
}

void ends(Trial& t) {
  for (std::size_t k = t.samples(10000, 1000000); k-- > 0;) {
    const double a = t.random.magnitude(-8, 8), b = t.random.magnitude(-8, 8);
    t.tally(a + (b - a) * 1.0 != b,
            kernels::mixed(a, b, 0.0, 1.0) != b || kernels::mixed(a, b, 1.0, 0.0) != a, {a, b});
  }
}

void one_place(Trial& t) {
  for (std::size_t k = t.samples(10000, 1000000); k-- > 0;) {
    const double c = t.random.magnitude(-8, 8), at = t.random.uniform();
    std::array<double, 4> d{c, c, c, c};
    t.tally((1 - at) * c + at * c != c, kernels::casteljau(std::span<double>(d), at) != c, {c, at});
  }
}

// Cox's recurrence as it is printed, with what 0 / 0 gives.
double cox(const std::vector<double>& u, std::size_t i, std::size_t p, double t) {
  if (p == 0) return u[i] <= t && t < u[i + 1] ? 1 : 0;
  return (t - u[i]) / (u[i + p] - u[i]) * cox(u, i, p - 1, t) +
         (u[i + p + 1] - t) / (u[i + p + 1] - u[i + 1]) * cox(u, i + 1, p - 1, t);
}

void repeated_knots(Trial& t) {
  const std::vector<std::vector<double>> all = {{0, 0, 0, 0, .5, 1, 1, 1, 1},
                                                {0, 0, 0, 0, .5, .5, .5, 1, 1, 1, 1}};
  for (const auto& u : all) {
    const std::size_t n = u.size() - 4;
    const std::vector<glm::dvec3> points(n);
    const kernels::Spline s{3, points, {}, u};
    for (int k = 0; k <= 64; ++k) {
      const double at = k / 64.0;
      double naive = 0, robust = 0;
      for (std::size_t i = 0; i < n; ++i) naive += cox(u, i, 3, at);
      bool below = false;
      for (const double b : b_spline::basis(s.knots_of(s.span_at(at)), at))
        robust += b, below = below || b < 0;
      t.require(!below, "no basis function below 0", {at});
      t.measure(std::fabs(naive - 1) / u64, std::fabs(robust - 1) / u64, {at});
    }
  }
}

void extreme_weights(Trial& t) {
  const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 2, 0}, {2, 0, 0}};
  const std::vector<double> knots{0, 0, 0, 1, 1, 1};
  const std::vector<std::array<double, 3>> all = {
      {1, 1e8, 1}, {1, 1e-300, 1}, {1, 1e300, 1}, {0, 1, 0}, {0, 0, 3}};
  for (const auto& w : all)
    for (int k = 0; k <= 64; ++k) {
      const double at = k / 64.0, away = 1 - at;
      const std::vector<double> weights(w.begin(), w.end());
      const double b[] = {away * away, 2 * at * away, at * at};
      const double naive = (b[1] * w[1] * 2) / (b[0] * w[0] + b[1] * w[1] + b[2] * w[2]);
      const double robust = kernels::SplinePoints<double>({2, p, weights, knots}).at(at).y;
      // At an end without a weight the limit: the first point, or the last, that has one.
      const Rational x(at), side = (1 - x) * (1 - x) * Rational(w[0]) + x * x * Rational(w[2]);
      const Rational middle = 2 * x * (1 - x) * Rational(w[1]), whole = side + middle;
      const Rational want = whole == 0 ? Rational(w[1] != 0 ? 2 : 0) : Rational(2 * middle / whole);
      t.measure(distance(naive, want, 2) / u64, distance(robust, want, 2) / u64, {w[0], w[1], w[2], at});
    }
}

void supercircle_axes(Trial& t) {
  for (const double n : {2.0 / 3, 1.0, 2.0, 4.0, 100.0, 1e6})
    for (int k = 0; k < 64; ++k) {
      const double degrees = 360 * (k / 64.0);
      const double pi_half = 1.5707963267948966, angle = degrees / 90 * pi_half;
      const double c = std::cos(angle), s = std::sin(angle), e = 2 / n - 1;
      const glm::dvec2 naive{c * std::pow(std::fabs(c), e), s * std::pow(std::fabs(s), e)};
      const glm::dvec2 robust = supercircle::by_parameter(glm::dvec2(1), n, degrees);
      const auto off = [&](const glm::dvec2& p) {
        if (k % 16 == 0)  // on an axis one coordinate is 0 and the other 1
          return std::max(std::min(std::fabs(p.x), std::fabs(p.y)),
                          std::fabs(std::fabs(p.x) + std::fabs(p.y) - 1)) /
                 u64;
        const Real left = exact([&] {
          const Real x = pow(abs(Real(p.x)), Real(n)), y = pow(abs(Real(p.y)), Real(n));
          return x + y - Real(1);
        });
        return std::fabs(left.to_double()) / u64 / std::max(n, 1.0);
      };
      t.measure(off(naive), off(robust), {n, degrees});
    }
}

void circle(Trial& t) {
  const std::vector<double> knots{0, 0, 0, 1, 1, 1};
  for (const double radius : {1e-6, 1.0, 1e7}) {
    const std::vector<glm::dvec3> p{{radius, 0, 0}, {radius, radius, 0}, {0, radius, 0}};
    const std::vector<double> wide{1, std::sqrt(0.5), 1}, narrow{1, static_cast<double>(std::sqrt(0.5F)), 1};
    for (int k = 0; k <= 64; ++k) {
      const auto off = [&](const std::vector<double>& w) {
        const glm::dvec3 at = kernels::SplinePoints<double>({2, p, w, knots}).at(k / 64.0);
        const Real r = sqrt(Real(at.x) * Real(at.x) + Real(at.y) * Real(at.y));
        return distance(radius, r, Real(radius)) / u64;
      };
      t.measure(off(narrow), off(wide), {radius, k / 64.0});
    }
  }
}

// The denominator (1 - t)^2 + 2 w t (1 - t) + t^2 vanishes somewhere in [0, 1] where w <= -1, and nowhere
// else.
void poles(Trial& t) {
  for (int k = 1; k <= 40; ++k)
    for (const double sign : {-1.0, 0.0, 1.0}) {
      const double w = -1 + sign * std::ldexp(1, -k);
      const double c[] = {1, w, 1};
      bool changes = false;
      for (int i = 0; i <= 63; ++i) {
        const double at = i / 63.0, away = 1 - at;
        changes = changes || away * away + 2 * w * at * away + at * at <= 0;
      }
      const auto found = nurbs::root_inside(c, 0, 1);
      t.tally(changes != (w <= -1), found.has_value() != (w <= -1), {w});
      t.require(!found || found->second - found->first <= 1e-12, "a pole within 1e-12", {w});
    }
}

void standing_still(Trial& t) {
  const std::vector<double> knots{0, 0, 0, 0, 1, 1, 1, 1};
  for (const double size : {1e-150, 1.0, 1e150})
    for (int repeated = 1; repeated <= 3; ++repeated) {
      std::vector<glm::dvec3> p(4, glm::dvec3(0));
      for (int i = repeated; i < 4; ++i)
        p[std::size_t(i)] = glm::dvec3(3, 4, 0) * (size * (i - repeated + 1));
      std::array<glm::dvec3, 4> d;
      kernels::SplinePoints<double>({3, p, {}, knots}).at(0, d);
      const auto off = [](const glm::dvec3& unit) {
        return !(kernels::norm(unit - glm::dvec3(0.6, 0.8, 0)) <= 4 * u64);
      };
      t.tally(off(d[1] / std::sqrt(kernels::dot(d[1], d[1]))),
              off(polyline::tangent(std::span(d).subspan(1), kernels::KnotSide::after)),
              {size, double(repeated)});
    }
}

// Whether a cubic is told to be nearer to its chord than it is, or not told at all.
void flatness(Trial& t) {
  const std::vector<std::array<glm::dvec3, 4>> shapes = {{{{0, 0, 0}, {3, 4, 0}, {-3, 4, 0}, {0, 0, 0}}},
                                                         {{{0, 0, 0}, {4, 0, 0}, {-3, 0, 0}, {1, 0, 0}}},
                                                         {{{0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}}},
                                                         {{{2, 2, 0}, {2, 2, 0}, {2, 2, 0}, {2, 2, 0}}}};
  for (const auto& shape : shapes)
    for (const double size : {1e-30, 1.0, 1e7}) {
      std::vector<glm::dvec4> h;
      std::vector<glm::dvec3> p;
      for (const glm::dvec3& q : shape) p.push_back(q * size), h.emplace_back(q * size, 1);
      double deviation = 0;
      for (int k = 0; k <= 256; ++k) {
        const double at = k / 256.0;
        auto d = p;
        const glm::dvec3 q = kernels::casteljau(std::span(d), at);
        deviation = std::max(deviation, kernels::norm(q - (p[0] * (1 - at) + p[3] * at)));
      }
      const glm::dvec3 chord = p[3] - p[0];
      const double length = std::sqrt(kernels::dot(chord, chord));
      const auto from_line = [&](const glm::dvec3& q) {
        return std::fabs(chord.x * (q.y - p[0].y) - chord.y * (q.x - p[0].x)) / length;
      };
      const double naive = std::max(from_line(p[1]), from_line(p[2]));
      const double robust = polyline::deviation_bound(h, false);
      t.tally(!(naive >= deviation), !(robust >= deviation), {p[1].x, p[1].y, size});
    }
}

void midpoints(Trial& t) {
  for (std::size_t k = t.samples(1000, 100000); k-- > 0;) {
    std::vector<glm::dvec4> h;
    for (int i = 0; i < 4; ++i)
      h.emplace_back(t.random.uniform(-1, 1) * 1.7e308, t.random.magnitude(-8, 8), 0, 1);
    const auto [left, right] = polyline::halves(h);
    const bool whole = left.back() == right.front() && left.front() == h.front() &&
                       right.back() == h.back() && std::isfinite(left.back().x);
    const double naive = (h[1].x + h[2].x) / 2;
    t.tally(!std::isfinite(naive), !whole, {h[0].x, h[1].x, h[2].x, h[3].x});
  }
}

}  // namespace

std::vector<HardCase> curves() {
  return {
      {"CRV-02", "(t - 3/4)^7 (t - 1)^10 about 3/4", "de Casteljau's algorithm in double",
       "kernels::casteljau_compensated", "rationals, on the rounded coefficients", "an ulp of the value",
       "relative error", 0x1p-52, multiple_root},
      {"CRV-03", "degree 100 to 2000", "binomials and powers", "kernels::bernstein", "their sum is 1",
       "2 n u", "|sum - 1| / (2 n u)", 1, binomial_overflow},
      {"CRV-04", "random ends, t = 0 and 1", "a + (b - a) t", "kernels::mixed", "the ends themselves",
       "bit for bit", "wrong ends", 0, ends},
      {"CRV-05", "four control points at one place", "(1 - t) c + t c", "kernels::casteljau",
       "the place itself", "bit for bit", "wrong points", 0, one_place},
      {"CRV-06", "clamped cubics with knots that stand one and three times inside",
       "Cox's recurrence as printed", "b_spline::basis", "the functions add up to 1",
       "4 u per level, at the last knot, too", "|sum - 1| / u", 12, repeated_knots},
      {"CRV-09", "weights 1e8, 1e-300, 1e300, and 0 at the ends", "the quotient of both sums",
       "kernels::SplinePoints", "rationals, and the limit at ends without weight", "4 n u of the points",
       "error in u", 8, extreme_weights},
      {"CRV-10", "a quarter of a circle, radius 1e-6 to 1e7", "its weight in single precision",
       "kernels::SplinePoints", "MPFR: the distance from the centre", "8 u", "|r - R| / (u R)", 8, circle},
      {"CRV-11", "weights 1, w, 1 with w within 2^-40 of -1", "the sign of 64 samples", "nurbs::root_inside",
       "w <= -1, by its discriminant", "every pole, within 1e-12, and no other", "wrong answers", 0, poles},
      {"CRV-14", "cubics whose first two to four points are one, of size 1e-150 to 1e150", "P' / |P'|",
       "polyline::tangent", "the direction to the next point", "unit within 4 u", "wrong tangents", 0,
       standing_still},
      {"CRV-15", "n = 2/3 to 1e6, the axes among the points", "cos t |cos t|^(2 / n - 1) with libm's cosine",
       "supercircle::by_parameter", "MPFR: the implicit form", "8 n u, exact on the axes", "residual / (n u)",
       8, supercircle_axes},
      {"CRV-16", "a loop, a line there and back, a cusp and a point, of size 1e-30 to 1e7",
       "distances of control points from the chord's line", "polyline::deviation_bound",
       "256 points of the curve against its chord", "never less than the deviation", "wrong bounds", 0,
       flatness},
      {"CRV-17", "cubics as large as doubles are", "(a + b) / 2", "polyline::halves",
       "the joint is finite and one", "bit for bit", "broken joints", 0, midpoints},
  };
}

}  // namespace frustum::hard
