// Transforms: rotations, inverses, normals, frames.
#include "nodes/kernels/affine.h"
#include "nodes/kernels/camera.h"
#include "nodes/kernels/matrix.h"
#include "nodes/project/view.h"
#include "tests/hard/exact.h"
#include "tests/hard/naive.h"
#include "tests/hard/stages.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

using glm::dmat3, glm::dmat4, glm::dvec3, glm::mat3, glm::mat4, glm::vec3;
using Quad = __float128;  // products of doubles are exact in it

constexpr double infinity = std::numeric_limits<double>::infinity();

// The largest entry of |M' M - I|; infinite for NaN.
template <class R>
double off_orthonormal(const glm::mat<3, 3, R>& m) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      Quad sum = i == j ? -1 : 0;
      for (int k = 0; k < 3; ++k) sum += static_cast<Quad>(m[i][k]) * static_cast<Quad>(m[j][k]);
      const double off = std::fabs(static_cast<double>(sum));
      if (!(off <= worst)) worst = off == off ? off : infinity;
    }
  return worst;
}

dvec3 direction(Trial& t) {
  for (;;) {
    const dvec3 v(t.random.uniform(-1, 1), t.random.uniform(-1, 1), t.random.uniform(-1, 1));
    const double square = naive::dot(v, v);
    if (square > 0.01 && square < 1) return v / std::sqrt(square);
  }
}

// What setting a transform up costs in the work that it is for: one set-up, a thousand points moved.
template <class Naive, class Robust>
void price_of_set_up(Trial& t, Naive&& naive_map, Robust&& robust_map) {
  std::vector<dvec3> points(1000), moved(1000);
  for (dvec3& p : points) p = direction(t);
  const auto move = [&](const dmat3& m) {
    for (std::size_t i = 0; i < points.size(); ++i) moved[i] = m * points[i];
    keep(moved[0]);
  };
  int i = 0;
  t.price([&] { move(naive_map(++i)); }, [&] { move(robust_map(++i)); });
}

void a_million_rotations(Trial& t) {
  constexpr int steps = 1000000;
  const vec3 axis(1, 2, 3);
  const auto step = naive::rotation(axis, static_cast<float>(2 * M_PI / steps));
  const auto turned = [](int i) { return kernels::rotation(dvec3(1, 2, 3), 360.0 * i / steps)->linear; };
  mat3 product(1);
  for (int i = 1; i <= steps; ++i) {
    product = step * product;
    if (i % 997 != 0 && i != steps) continue;
    t.measure(off_orthonormal(product) / u32, off_orthonormal(turned(i)) / u64, {static_cast<double>(i)});
  }
  t.require(turned(steps) == dmat3(1), "a whole turn is the identity, bit for bit");
  dmat3 running(1);
  price_of_set_up(
      t, [&](int) { return running = dmat3(step) * running; }, [&](int i) { return turned(i % steps); });
}

void inverse_far_away(Trial& t) {
  using kernels::composed, kernels::inverse;
  const dvec3 far(1e7, 2e7, -3e7), p(0.25, 0.5, 0.75);
  const auto rigid = [&](double degrees) {
    return composed(kernels::translation(far), *kernels::rotation(dvec3(1, 2, 3), degrees));
  };
  const auto naive_trip = [&](const kernels::Affine& a) {
    const mat4 m(kernels::matrix_of(a));
    return vec3(glm::inverse(m) * (m * glm::vec4(vec3(p), 1)));
  };
  const auto trip = [&](const kernels::Affine& a) {
    return kernels::PointMap<double>(inverse(a))(kernels::PointMap<double>(a)(p));
  };
  for (int i = 0; i < 360; ++i) {
    const auto a = rigid(i + 0.1);
    t.measure(kernels::norm(dvec3(naive_trip(a)) - p), kernels::norm(trip(a) - p), {i + 0.1});
  }
  // The same for buffers of floats: subtracting the eye first keeps every digit of what is near it.
  const std::vector<vec3> world{vec3(far) + vec3(4, -8, 16)};
  std::vector<vec3> eye(1);
  const auto view = inverse(rigid(40));
  project::world_to_eye<float>(view, world, eye);
  const dvec3 want = view.linear * (dvec3(world[0]) - dvec3(vec3(far)));
  t.require(kernels::norm(dvec3(eye[0]) - want) <= 8 * u32 * kernels::norm(want),
            "8 u of the distance to the eye");
  const auto a = rigid(40);
  t.price(
      [&] {
        for (int i = 0; i < 1000; ++i) keep(naive_trip(a));
      },
      [&] {
        for (int i = 0; i < 1000; ++i) keep(trip(a));
      });
}

// Cramer's rule in the same double precision.
dmat4 naive_inverse(const dmat4& m) { return glm::inverse(m); }

void inverse_of_scale(Trial& t) {
  const auto judge = [&](const dvec3& s) {
    dmat4 m(1.0);
    for (int i = 0; i < 3; ++i) m[i][i] = s[i];
    const auto got = kernels::inverse<4>(m);
    const dmat4 naive_result = naive_inverse(m);
    double naive_error = 0, error = got ? 0 : infinity;
    for (int i = 0; i < 3; ++i) {
      const Real want = Real(1.0) / Real(s[i]);
      naive_error = std::max(naive_error, ulps(naive_result[i][i], want));
      if (got) error = std::max(error, ulps(got->matrix[i][i], want));
    }
    t.measure(naive_error, error, {s.x, s.y, s.z});
    const auto structured = kernels::scaling(s);
    t.require(structured && structured->inverse_linear[0][0] == 1 / s.x, "from the structure",
              {s.x, s.y, s.z});
  };
  for (const double s : {1e-20, 1e-12, 1e12, 1e-120, 1e120}) judge(dvec3(s));
  judge({1e12, 1, 1e-12});
  for (std::size_t n = t.samples(200, 20000); n-- > 0;)
    judge({t.random.magnitude(-400, 400), t.random.magnitude(-400, 400), t.random.magnitude(-400, 400)});
  t.require(!kernels::inverse<4>(dmat4(0.0)), "a matrix of rank 0 has no inverse");
  const auto some = [](int i) { return kernels::rotation(dvec3(1, 2, 3), i)->linear * 3.0; };
  price_of_set_up(
      t, [&](int i) { return dmat3(naive_inverse(dmat4(some(i)))); },
      [&](int i) { return dmat3(kernels::inverse<4>(dmat4(some(i)))->matrix); });
}

using RealMatrix = std::array<std::array<Real, 3>, 3>;  // [row][column]

RealMatrix product(const RealMatrix& a, const RealMatrix& b) {
  RealMatrix c;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  return c;
}

// About z, by `degrees`.
RealMatrix exact_turn(double degrees) {
  const Real angle = Real(degrees) * pi() / 180.0, c = cos(angle), s = sin(angle);
  return {{{c, -s, 0.0}, {s, c, 0.0}, {0.0, 0.0, 1.0}}};
}

void inverse_of_shear(Trial& t) {
  using kernels::composed;
  for (const double amount : {1e4, 1e8, -1e8, 1e12})
    for (const double degrees : {57.29577951308232, 10.0, 33.3}) {
      const auto turn = *kernels::rotation(dvec3(0, 0, 1), degrees);
      const auto map = composed(turn, composed(kernels::shearing(0, 1, amount), inverse(turn)));
      const dmat3 naive_result = naive::inverse(map.linear);
      double naive_error = 0, error = 0, largest = 0;
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) {
          const Real want = exact([&] {
            const RealMatrix back{{{1.0, -amount, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
            return product(product(exact_turn(degrees), back), exact_turn(-degrees))[r][c];
          });
          const auto ci = static_cast<int>(c), ri = static_cast<int>(r);
          naive_error = std::max(naive_error, distance(naive_result[ci][ri], want));
          error = std::max(error, distance(map.inverse_linear[ci][ri], want));
          largest = std::max(largest, std::fabs(want.to_double()));
        }
      t.measure(naive_error / (u64 * largest), error / (u64 * largest), {amount, degrees});
    }
  const auto shear = kernels::shearing(0, 1, 1e8);
  t.require(shear.inverse_linear[1][0] == -1e8, "the inverse of a shear is exact");
  const dmat3 m = shear.linear;
  t.price(
      [&] {
        for (int i = 0; i < 1000; ++i) keep(naive::inverse(m));
      },
      [&] {
        for (int i = 0; i < 1000; ++i) keep(kernels::inverse(shear));
      });
}

void rotation_by_a_small_angle(Trial& t) {
  const auto judge = [&](const dvec3& axis, double degrees) {
    const auto naive_result = naive::rotation(axis, degrees * M_PI / 180);
    const dmat3 got = kernels::rotation(axis, degrees)->linear;
    double naive_error = 0, error = 0;
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) {
        const Real want = exact([&] {
          const Real x = axis.x, y = axis.y, z = axis.z, length = sqrt(x * x + y * y + z * z);
          const std::array<Real, 3> k{x / length, y / length, z / length};
          const Real half = Real(degrees) * pi() / 360.0, s = sin(half), sine = Real(2.0) * s * cos(half);
          const auto i = static_cast<std::size_t>(r), j = static_cast<std::size_t>(c);
          const Real versine = Real(2.0) * s * s;
          if (i == j) return Real(1.0) - versine * (Real(1.0) - k[i] * k[i]);
          const Real turn = k[3 - i - j] * sine;
          return versine * k[i] * k[j] + ((j + 1) % 3 == i ? turn : -turn);
        });
        naive_error = std::max(naive_error, ulps(naive_result[c][r], want));
        error = std::max(error, ulps(got[c][r], want));
      }
    t.measure(naive_error, error, {axis.x, axis.y, axis.z, degrees});
  };
  for (int k = -1; k <= 40; ++k) {
    judge({1, 1, 0}, 57.3 * std::pow(10, -k));
    judge({1, 2, 3}, 57.3 * std::pow(10, -k));
  }
  t.require(kernels::rotation(dvec3(1, 2, 3), 0)->linear == dmat3(1),
            "no angle is the identity, bit for bit");
  price_of_set_up(
      t, [](int i) { return naive::rotation(dvec3(1, 2, 3), i * 0.01); },
      [](int i) { return kernels::rotation(dvec3(1, 2, 3), i * 0.5)->linear; });
}

void quarter_turns(Trial& t) {
  const auto whole = [](auto x) { return x == -1 || x == 0 || x == 1; };
  const auto wrong = [&](const auto& m) {
    bool any = false;
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) any = any || !whole(m[c][r]);
    return any;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 1; k <= 8; ++k) {
      dvec3 unit(0);
      unit[axis] = 1;
      t.tally(wrong(naive::rotation(vec3(unit), static_cast<float>(k * M_PI / 2))),
              wrong(kernels::rotation(unit, 90.0 * k)->linear), {static_cast<double>(axis), 90.0 * k});
    }
  kernels::Affine all;
  const auto turn = *kernels::rotation(dvec3(0, 0, 1), 90);
  for (int i = 0; i < 400000; ++i) all = composed(turn, all);
  t.require(all.linear == dmat3(1), "100000 whole turns in quarters are the identity");
  price_of_set_up(
      t, [](int i) { return naive::rotation(dvec3(0, 0, 1), i * M_PI / 2); },
      [](int i) { return kernels::rotation(dvec3(0, 0, 1), 90.0 * i)->linear; });
}

// n.(M e), relative to u |n| |M e|, for a normal moved by some matrix; the map is given as it is stored.
template <class Normal>
double off_perpendicular(const Normal& n, const dmat3& m, const dvec3& edge, double u) {
  std::array<Quad, 3> moved{};
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      moved[static_cast<std::size_t>(r)] += static_cast<Quad>(m[c][r]) * static_cast<Quad>(edge[c]);
  Quad dot = 0, nn = 0, ee = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Quad x = static_cast<Quad>(n[static_cast<int>(i)]);
    dot += x * moved[i], nn += x * x, ee += moved[i] * moved[i];
  }
  const Real scale = sqrt(Real(static_cast<double>(nn)) * Real(static_cast<double>(ee)));
  const double off = std::fabs(static_cast<double>(dot)) / (u * scale.to_double());
  return off == off ? off : infinity;
}

void normals_under_scale(Trial& t) {
  using kernels::composed;
  const dvec3 normal(0.6, 0, 0.8), along(0.8, 0, -0.6), across(0, 1, 0);
  const std::array maps{composed(*kernels::scaling({1e8, 1, 1e-8}), kernels::shearing(0, 1, 0.5)),
                        *kernels::scaling(dvec3(1e-13)), *kernels::scaling({-1, 1, 1}),
                        composed(kernels::shearing(2, 0, -3), *kernels::scaling({1e-13, 1e8, 2}))};
  for (const auto& map : maps) {
    const dvec3 got = kernels::normal_matrix(map) * normal;
    const vec3 textbook = glm::transpose(glm::inverse(mat3(map.linear))) * vec3(normal);
    for (const dvec3& edge : {along, across})
      t.measure(off_perpendicular(textbook, map.linear, edge, u32),
                off_perpendicular(got, map.linear, edge, u64),
                {map.linear[0].x, map.linear[1].y, map.linear[2].z});
  }
  t.require(mirrors(maps[2]) && !mirrors(maps[0]) && !mirrors(maps[1]), "handedness is exact");
  const auto& map = maps[0];
  t.price(
      [&] {
        for (int i = 0; i < 1000; ++i) keep(glm::transpose(glm::inverse(mat3(map.linear))) * vec3(normal));
      },
      [&] {
        for (int i = 0; i < 1000; ++i) keep(kernels::normal_matrix(map) * normal);
      });
}

void looking_along_up(Trial& t) {
  const auto judge = [&](const dvec3& eye, const dvec3& target, const dvec3& up) {
    const auto got = kernels::look_at(eye, target, up).eye_from_world.linear;
    t.measure(off_orthonormal(dmat3(glm::lookAt(eye, target, up))) / u64, off_orthonormal(got) / u64,
              {target.x, target.y, target.z});
  };
  const dvec3 origin(0), y(0, 1, 0);
  for (const double sign : {1.0, -1.0}) judge(origin, {0, 5 * sign, 0}, y), judge(origin, {1e-9, sign, 0}, y);
  judge(origin, {1e-30, 1, 0}, y), judge(origin, {0, 1, 1e-200}, y);
  for (std::size_t n = t.samples(20000, 1000000); n-- > 0;) judge(origin, direction(t) * 3.0, y);
  const auto target = [](int i) { return dvec3(i, 2, 3); };
  price_of_set_up(
      t, [&](int i) { return dmat3(glm::lookAt(origin, target(i), y)); },
      [&](int i) { return kernels::look_at(origin, target(i), y).eye_from_world.linear; });
}

void frame_near_the_pole(Trial& t) {
  const auto frisvad = [](const vec3& n) {
    const float a = 1 / (1 + n.z), b = -n.x * n.y * a;
    return mat3({1 - n.x * n.x * a, b, -n.x}, {b, 1 - n.y * n.y * a, -n.y}, n);
  };
  const auto ours = [](const vec3& n) {
    const auto f = kernels::orthonormal_frame(n);
    return mat3(f.tangent, f.bitangent, n);
  };
  const auto judge = [&](const vec3& n) {
    t.measure(off_orthonormal(frisvad(n)) / u32, off_orthonormal(ours(n)) / u32, {n.x, n.y, n.z});
  };
  judge({1e-4F, 1e-4F, static_cast<float>(-std::sqrt(1 - 2e-8))}), judge({0, 0, -1}), judge({0, 0, 1});
  std::vector<vec3> inputs;
  for (std::size_t n = t.samples(50000, 1000000); n-- > 0;) {
    const auto v = vec3(direction(t));
    judge(v);
    if (inputs.size() < 1000) inputs.push_back(v);
  }
  t.price_over(inputs, frisvad, ours);
}

using Exact3 = std::array<std::array<Rational, 3>, 3>;

Exact3 exact_inverse(const dmat3& m) {
  const auto at = [&](std::size_t r, std::size_t c) {
    return Rational(m[static_cast<int>(c % 3)][static_cast<int>(r % 3)]);
  };
  const auto minor = [&](std::size_t r, std::size_t c) {
    return Rational(at(r + 1, c + 1) * at(r + 2, c + 2) - at(r + 1, c + 2) * at(r + 2, c + 1));
  };
  const Rational det = at(0, 0) * minor(0, 0) + at(0, 1) * minor(0, 1) + at(0, 2) * minor(0, 2);
  Exact3 x;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) x[r][c] = minor(c, r) / det;
  return x;
}

// Gauss-Jordan elimination that divides by whatever stands on the diagonal.
dmat3 without_pivoting(dmat3 a) {
  dmat3 x(1.0);
  for (int k = 0; k < 3; ++k) {
    const double d = a[k][k];
    for (int c = 0; c < 3; ++c) a[c][k] /= d, x[c][k] /= d;
    for (int r = 0; r < 3; ++r) {
      if (r == k) continue;
      const double f = a[k][r];
      for (int c = 0; c < 3; ++c) a[c][r] -= f * a[c][k], x[c][r] -= f * x[c][k];
    }
  }
  return x;
}

double one_norm(const Exact3& a) {
  Rational largest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const Rational sum = ::abs(a[0][c]) + ::abs(a[1][c]) + ::abs(a[2][c]);
    if (sum > largest) largest = sum;
  }
  return largest.get_d();
}

void elimination_without_pivots(Trial& t) {
  dmat3 hilbert;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) hilbert[c][r] = 1.0 / (r + c + 1);
  const dmat3 small_pivot({1e-20, 1, 0}, {1, 1, 0}, {0, 0, 1});
  const auto judge = [&](const dmat3& m, bool compare_rcond) {
    const Exact3 want = exact_inverse(m);
    Exact3 given;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) given[r][c] = m[static_cast<int>(c)][static_cast<int>(r)];
    const double condition = one_norm(given) * one_norm(want);
    const auto got = kernels::inverse<3>(m);
    t.require(got.has_value(), "regular matrices have inverses", {m[0][0], m[1][1], m[2][2]});
    if (!got) return;
    const dmat3 naive_result = without_pivoting(m);
    const auto error = [&](const dmat3& x) {
      double worst = 0;
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c)
          worst = std::max(worst, distance(x[static_cast<int>(c)][static_cast<int>(r)], want[r][c]));
      return worst / (one_norm(want) * u64 * condition);
    };
    t.measure(error(naive_result), error(got->matrix),
              {m[0][0], m[0][1], m[0][2], m[1][0], m[1][1], m[1][2], m[2][0], m[2][1], m[2][2]});
    if (compare_rcond)
      t.require(got->rcond <= 10 / condition && got->rcond >= 0.1 / condition, "rcond within a factor of 10");
  };
  judge(small_pivot, true), judge(hilbert, true);
  for (int k = 0; k <= 16; ++k) {
    dmat3 graded = kernels::rotation(dvec3(1, 2, 3), 10.0 * k + 1)->linear;
    for (int c = 0; c < 3; ++c) graded[c][0] *= std::pow(10, k), graded[c][2] *= std::pow(10, -k);
    judge(graded, false);
  }
  for (std::size_t n = t.samples(300, 30000); n-- > 0;) {
    dmat3 m;
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) m[c][r] = t.random.magnitude(-30, 30);
    judge(m, false);
  }
  const auto some = [](int i) { return kernels::rotation(dvec3(1, 2, 3), i)->linear * 3.0; };
  price_of_set_up(
      t, [&](int i) { return without_pivoting(some(i)); },
      [&](int i) { return kernels::inverse<3>(some(i))->matrix; });
}

void handedness(Trial& t) {
  const auto naive_sign = [](const dvec3& a, const dvec3& b, const dvec3& c) {
    const double det =
        a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
    return (det > 0) - (det < 0);
  };
  std::vector<dmat3> inputs;
  for (std::size_t n = t.samples(5000, 500000); n-- > 0;) {
    // Integers of about 2^20 whose determinant is 1, -1 or 0: row operations keep it.
    dmat3 m(1.0);
    const int want = static_cast<int>(t.random.below(3)) - 1;
    m[2][2] = want;
    while (kernels::largest_component(m[0]) < 0x1p18) {
      const auto i = static_cast<int>(t.random.below(3)),
                 j = (i + 1 + static_cast<int>(t.random.below(2))) % 3;
      m[i] += m[j] * static_cast<double>(static_cast<int>(t.random.below(7)) - 3);
      if (kernels::largest_component(m[i]) > 0x1p21) m = dmat3(1.0), m[2][2] = want;
    }
    m *= 0x1p-20;
    const int got = kernels::determinant_sign(m[0], m[1], m[2]);
    t.tally(naive_sign(m[0], m[1], m[2]) != want, got != want,
            {m[0].x, m[0].y, m[0].z, m[1].x, m[1].y, m[1].z, m[2].x, m[2].y, m[2].z});
    if (want == 0) t.require(!kernels::inverse<3>(m), "rank 2 has no inverse", {m[0].x, m[1].y, m[2].z});
    if (inputs.size() < 1000) inputs.push_back({direction(t), direction(t), direction(t)});
  }
  t.price_over(
      inputs, [&](const dmat3& m) { return naive_sign(m[0], m[1], m[2]); },
      [](const dmat3& m) { return kernels::determinant_sign(m[0], m[1], m[2]); });
}

}  // namespace

std::vector<HardCase> transforms() {
  return {
      {"XFM-01", "a turn in a million steps about (1, 2, 3)", "R multiplied a million times, float",
       "kernels::rotation of the step's own angle", "products in 113 bits",
       "|M'M - I| <= 4 u at every step; M = I at the end", "u", 4, a_million_rotations},
      {"XFM-02",
       "rotation about (1, 2, 3), then translation by (1e7, 2e7, -3e7); (0.25, 0.5, 0.75) there and back",
       "glm::inverse of the 4x4 matrix, float", "kernels::inverse(Affine), project::world_to_eye",
       "the point itself", "|M^-1 M p - p| <= 8 u64 (|t| + |p|)", "world units", 8 * u64 * 3.75e7,
       inverse_far_away},
      {"XFM-03", "scales 1e-20 to 1e12, 1e+-120, (1e12, 1, 1e-12), random ones", "glm::inverse, double",
       "kernels::inverse<4>, kernels::scaling", "MPFR",
       "within 4 ulp an entry; singular only where the rank is below 4", "ulp", 4, inverse_of_scale},
      {"XFM-04", "shears by 1e4 to 1e12 between a rotation and its inverse", "adjugate / determinant, double",
       "kernels::composed: the inverse is carried along", "MPFR", "within 16 u of the largest entry", "u", 16,
       inverse_of_shear},
      {"XFM-07", "angles 10^-k rad, k from -1 to 40, about (1, 1, 0) and (1, 2, 3)",
       "Rodrigues' formula, double", "kernels::rotation", "MPFR", "within 4 ulp an entry; no angle gives I",
       "ulp", 4, rotation_by_a_small_angle},
      {"XFM-09", "multiples of 90 degrees about each axis", "cos and sin of k pi / 2, float",
       "kernels::rotation", "integers", "entries are -1, 0 and 1; 400000 quarters compose to I",
       "inexact matrices", 0, quarter_turns},
      {"XFM-10", "scales (1e8, 1, 1e-8), 1e-13 and a mirror, with shears", "glm: inverse transpose, float",
       "kernels::normal_matrix, mirrors", "products in 113 bits",
       "n.(M e) <= 4 u |n| |M e|; handedness exact", "u |n| |M e|", 4, normals_under_scale},
      {"XFM-12", "looking along up, 1e-9 and less off it, and in 20000 directions", "glm::lookAt, double",
       "kernels::look_at", "products in 113 bits", "orthonormal to 4 u in every direction", "u", 4,
       looking_along_up},
      {"XFM-13", "(1e-4, 1e-4, -1 + 1e-8), the poles, 50000 directions, float", "Frisvad: 1 / (1 + n.z)",
       "kernels::orthonormal_frame", "products in 113 bits", "orthonormal to 4 u everywhere", "u", 4,
       frame_near_the_pole},
      {"XFM-15", "a pivot of 1e-20, Hilbert's matrix, graded and random ones",
       "elimination without pivoting, double", "kernels::inverse<3>", "rationals",
       "forward error <= 24 u cond; rcond within a factor of 10", "u cond |A^-1|", 24,
       elimination_without_pivots},
      {"XFM-16", "matrices of entries about 1 whose determinant is +-2^-60 or 0",
       "sign of the determinant, double", "kernels::determinant_sign, inverse<3>", "integers",
       "the sign is exact; rank 2 has no inverse", "wrong signs", 0, handedness},
  };
}

}  // namespace frustum::hard
