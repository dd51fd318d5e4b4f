// Texture.
#include "nodes/kernels/quad_map.h"
#include "nodes/kernels/simd/interpolate_attributes.h"
#include "nodes/kernels/simd/texture_lookup.h"
#include "nodes/kernels/texture_lookup.h"
#include "tests/hard/exact.h"
#include "tests/hard/screen.h"
#include "tests/hard/stages.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

using glm::vec2, glm::vec4;
using kernels::EdgeRule;
constexpr float infinity = std::numeric_limits<float>::infinity(),
                nan = std::numeric_limits<float>::quiet_NaN();

// A strip of the screen, w0 at its left end and w1 at its right, u from 0 to 1.
struct Strip {
  ScreenTriangles mesh;
  std::vector<float> u;
  float w0, w1;
  int width;

  Strip(float left_w, float right_w, int size) : w0(left_w), w1(right_w), width(size) {
    const auto right = static_cast<float>(size);
    const vec4 a(0, 0, 0.5F, 1 / w0), b(right, 0, 0.5F, 1 / w1), c(right, 8, 0.5F, 1 / w1),
        d(0, 8, 0.5F, 1 / w0);
    mesh.add(a, b, c, 0), mesh.add(a, c, d, 1);
    u = {0, 1, 1, 0, 1, 0};
  }
  Rational exact_u(int x) const {
    const Rational s = Rational(2 * x + 1, 2 * width), q0(1 / w0), q1(1 / w1);
    return Rational(s * q1 / ((1 - s) * q0 + s * q1));
  }
  std::vector<float> row() const {
    const Picture picture = filled(mesh.mesh(), width, 8);
    const auto all = interpolated(mesh.mesh(), picture, u);
    return {all.begin() + 4 * width, all.begin() + 5 * width};
  }
};

void large_w_ratio(Trial& t) {
  for (const float w : {1e-7F, 1e-3F, 0.3F, 7.0F, 1e4F}) {
    const Strip strip(w, 1, 512);
    const auto got = strip.row();
    for (int x = 0; x < strip.width; ++x) {
      const Real want = Real(strip.exact_u(x));
      const float affine = (static_cast<float>(x) + 0.5F) / static_cast<float>(strip.width);
      t.measure(ulps(affine, want), ulps(got[static_cast<std::size_t>(x)], want),
                {w, static_cast<double>(x)});
    }
  }
  // The price of the division: the same strip, hyperbolic and affine, by the same kernel.
  const Strip strip(0.3F, 1, 512);
  const Picture picture = filled(strip.mesh.mesh(), 512, 8);
  std::vector<float> out(picture.id.size());
  const auto by = [&](kernels::Interpolation kind) {
    kernels::Attribute<float> u{strip.u.data(), 1, kernels::AttributeDomain::vertex};
    u.value[0] = {out.data(), 512, 0};
    kernels::simd::interpolate_attributes({strip.mesh.mesh(), kernels::centre_sample(), kind}, {0, 0, 512, 8},
                                          {picture.id.data(), 512, 0}, {{&u, 1}});
    keep(out[0]);
  };
  t.price([&] { by(kernels::Interpolation::affine); }, [&] { by(kernels::Interpolation::hyperbolic); });
}

void w_changes_sign(Trial& t) {
  // u = x of the corner, so that the right u at a pixel is where its ray meets the triangle.
  const auto judge = [&](const ClipTriangle& triangle) {
    const auto want = seen(triangle, 32, 32);
    t.measure(static_cast<double>(wrong_pixels(drawn_without_clipping({&triangle, 1}, 32, 32), want)),
              static_cast<double>(wrong_pixels(drawn({&triangle, 1}, 32, 32), want)),
              {triangle[0].w, triangle[1].w, triangle[2].w});
  };
  judge({vec4(-0.5F, -0.5F, 0, 1), vec4(0.5F, -0.5F, 0, -1), vec4(0, 0.7F, 0, 1)});
  for (std::size_t n = t.samples(20, 1000); n-- > 0;) {
    ClipTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto number = [&](double size) { return static_cast<float>(t.random.uniform(-size, size)); };
      triangle[k] = {number(1), number(1), number(0.2), k == 0 ? -1.0F : 1.0F};
    }
    judge(triangle);
  }
}

void wrapping(Trial& t) {
  constexpr int size = 256;
  // What is sampled must be a texel: rows of R G B A whose red is the column.
  std::vector<float> texels(size * 4);
  for (int x = 0; x < size; ++x) texels[static_cast<std::size_t>(x) * 4] = static_cast<float>(x);
  std::vector<float> coordinates{-1e-9F, -1e-30F, 1e6F + 0.3F, 16777215.5F, infinity, -infinity,
                                 nan,    1,       -1,          0,           -0.0F};
  for (std::size_t n = t.samples(20000, 1000000); n-- > 0;)
    coordinates.push_back(static_cast<float>(t.random.magnitude(-40, 24)));
  for (const auto rule : {EdgeRule::repeat, EdgeRule::clamp, EdgeRule::mirror}) {
    const kernels::TexelLevel level{size, 1, texels.data()};
    const kernels::TexelPyramid pyramid{{&level, 1}, rule, EdgeRule::clamp};
    std::vector<float> red(coordinates.size()), zero(coordinates.size());
    const kernels::UvRows<float> uv{coordinates.data(), zero.data()};
    const kernels::RgbaRows<float> out{{red.data(), nullptr, nullptr, nullptr}};
    kernels::simd::look_up(pyramid, kernels::Lookup::nearest, uv, coordinates.size(), out);
    for (std::size_t i = 0; i < coordinates.size(); ++i) {
      const float s = coordinates[i], fraction = s - std::floor(s);
      const float textbook = fraction * size;  // the index is its whole part
      const bool inside = red[i] >= 0 && red[i] < size;
      t.tally(rule == EdgeRule::repeat && !(textbook >= 0 && textbook < size), !inside, {s});
      if (!std::isfinite(s) || rule != EdgeRule::repeat) continue;
      Rational folded(s);
      mpz_class whole;
      mpz_fdiv_q(whole.get_mpz_t(), folded.get_num_mpz_t(), folded.get_den_mpz_t());
      folded = (folded - whole) * size;
      const double off = distance(red[i] + 0.5, folded), around = std::min(off, size - off);
      const double ulp = static_cast<double>(std::nextafter(std::fabs(s), infinity) - std::fabs(s));
      t.require(around <= 0.5 + ulp * size, "the texel of the exact coordinate, to ulp(s) N", {s});
    }
  }
  std::vector<float> red(coordinates.size()), zero(coordinates.size());
  const kernels::TexelLevel level{size, 1, texels.data()};
  const kernels::TexelPyramid pyramid{{&level, 1}, EdgeRule::repeat, EdgeRule::clamp};
  for (float& s : coordinates) s = std::isfinite(s) ? std::fabs(s) : 0;
  t.price(
      [&] {
        for (std::size_t i = 0; i < coordinates.size(); ++i) {
          const float f = coordinates[i] - std::floor(coordinates[i]);
          red[i] = texels[static_cast<std::size_t>(std::min(static_cast<int>(f * size), size - 1)) * 4];
        }
        keep(red[0]);
      },
      [&] {
        kernels::simd::look_up(pyramid, kernels::Lookup::nearest, {coordinates.data(), zero.data()},
                               coordinates.size(), {{red.data(), nullptr, nullptr, nullptr}});
        keep(red[0]);
      });
}

void far_apart_texels(Trial& t) {
  const auto textbook = [](float a, float b, float f) { return a + (b - a) * f; };
  const auto judge = [&](float a, float b, float f) {
    const auto between = kernels::between<float>({a, a, a, a}, {b, b, b, b}, f)[0];
    const auto wrong = [&](float v) {
      return !(v >= std::min(a, b) && v <= std::max(a, b)) || (f == 0 && v != a) || (f == 1 && v != b) ||
             (a == b && v != a);
    };
    t.tally(wrong(textbook(a, b, f)), wrong(between), {a, b, f});
  };
  judge(1e8F, 1, 1), judge(1e8F, 100, 1), judge(0.7F, 0.7F, 0.3F);
  for (std::size_t n = t.samples(100000, 10000000); n-- > 0;) {
    const auto a = static_cast<float>(t.random.magnitude(-30, 30)),
               b = static_cast<float>(t.random.magnitude(-30, 30));
    judge(a, b,
          n % 3 == 0 ? 1.0F : (n % 3 == 1 ? 0.0F : 1 - static_cast<float>(t.random.below(8)) * 0x1p-24F));
  }
  // Through the vector twin: a fraction of 1 does come up, just left of the first texel's middle.
  const std::vector<float> texels{1, 1, 1, 1, 1e8F, 1e8F, 1e8F, 1e8F};
  const kernels::TexelLevel level{2, 1, texels.data()};
  const kernels::TexelPyramid pyramid{{&level, 1}, EdgeRule::repeat, EdgeRule::clamp};
  const std::vector<float> u{std::nextafter(0.25F, 0.0F), 0.25F, 0.5F, 0.75F, std::nextafter(0.75F, 1.0F)},
      v(5, 0.5F);
  std::vector<float> red(5);
  kernels::simd::look_up(pyramid, kernels::Lookup::bilinear, {u.data(), v.data()}, 5,
                         {{red.data(), nullptr, nullptr, nullptr}});
  for (std::size_t i = 0; i < 5; ++i)
    t.require(red[i] >= 1 && red[i] <= 1e8F, "lookups stay between the texels", {u[i]});
  // The price where it is paid: a row of look-ups between the texels of a picture.
  constexpr int size = 64;
  std::vector<float> picture(size * size * 4), us(4096), vs(4096), out(4 * 4096);
  for (float& c : picture) c = static_cast<float>(t.random.uniform(0, 1));
  for (std::size_t i = 0; i < us.size(); ++i) {
    us[i] = static_cast<float>(t.random.uniform(0.1, 0.9)),
    vs[i] = static_cast<float>(t.random.uniform(0.1, 0.9));
  }
  const kernels::TexelLevel whole{size, size, picture.data()};
  const kernels::TexelPyramid one_level{{&whole, 1}};
  t.price(
      [&] {
        for (std::size_t i = 0; i < us.size(); ++i) {
          const float x = us[i] * size - 0.5F, y = (1 - vs[i]) * size - 0.5F;
          const auto low_x = static_cast<int>(x), low_y = static_cast<int>(y);
          const float fx = x - static_cast<float>(low_x), fy = y - static_cast<float>(low_y);
          const float* at = picture.data() + (low_y * size + low_x) * 4;
          for (std::size_t k = 0; k < 4; ++k)
            out[k * us.size() + i] = textbook(textbook(at[k], at[4 + k], fx),
                                              textbook(at[4 * size + k], at[4 * size + 4 + k], fx), fy);
        }
        keep(out[0]);
      },
      [&] {
        const auto plane = [&](std::size_t k) { return out.data() + k * us.size(); };
        kernels::simd::look_up(one_level, kernels::Lookup::bilinear, {us.data(), vs.data()}, us.size(),
                               {{plane(0), plane(1), plane(2), plane(3)}});
        keep(out[0]);
      });
}

void midpoint_law(Trial& t) {
  for (const int width : {9, 129, 1025}) {
    const Strip strip(1, 3, width);
    const int middle = width / 2;
    const auto got = strip.row();
    // The corners hold 1/w, and 1/3 is rounded: what is exact is the law for the stored numbers.
    const Real want = Real(strip.exact_u(middle));
    t.measure(ulps(0.5F, want), ulps(got[static_cast<std::size_t>(middle)], want),
              {static_cast<double>(width)});
    t.require(std::fabs(got[static_cast<std::size_t>(middle)] - 0.25F) <= 0x1p-24F, "a quarter",
              {static_cast<double>(width)});
  }
}

void long_scanline(Trial& t) {
  constexpr int width = 16384, texels = 4096;
  for (const auto& [w0, w1] : {std::pair{1.0F, 40.0F}, {3.0F, 0.02F}, {1.0F, 1.0F}, {0.7F, 11.0F}}) {
    const Strip strip(w0, w1, width);
    const auto got = strip.row();
    const float q_step = (1 / w1 - 1 / w0) / width, u_step = 1 / w1 / width;
    float q = 1 / w0 + 0.5F * q_step, u = 0.5F * u_step;
    for (int x = 0; x < width; ++x) {
      if (x % 64 == 0 || x == width - 1) {
        const Rational want = strip.exact_u(x), texel(1, texels);
        t.measure(distance(u / q, want, texel), distance(got[static_cast<std::size_t>(x)], want, texel),
                  {w0, w1, static_cast<double>(x)});
      }
      u += u_step, q += q_step;
    }
  }
}

void one_texel_a_pixel(Trial& t) {
  constexpr int size = 64;
  std::vector<float> texels(size * size * 4);
  for (float& c : texels) c = static_cast<float>(t.random.uniform(0, 1));
  const kernels::TexelLevel level{size, size, texels.data()};
  const kernels::TexelPyramid pyramid{{&level, 1}};
  // Corners of the picture in the order of a picture turned by quarters; u and v go along.
  const std::array<vec2, 4> corner{vec2(0, 1), vec2(1, 1), vec2(1, 0), vec2(0, 0)};
  for (std::size_t turn = 0; turn < 4; ++turn)
    for (const auto filter : {kernels::Lookup::nearest, kernels::Lookup::bilinear}) {
      ScreenTriangles mesh;
      const std::array<vec4, 4> p{vec4(0, 0, 0.5F, 1), vec4(size, 0, 0.5F, 1), vec4(size, size, 0.5F, 1),
                                  vec4(0, size, 0.5F, 1)};
      std::vector<float> u, v;
      for (const std::array<std::size_t, 3>& k : {std::array<std::size_t, 3>{0, 1, 2}, {0, 2, 3}}) {
        mesh.add(p[k[0]], p[k[1]], p[k[2]], 0);
        for (const std::size_t i : k)
          u.push_back(corner[(i + turn) % 4].x), v.push_back(corner[(i + turn) % 4].y);
      }
      const Picture picture = filled(mesh.mesh(), size, size);
      const auto pu = interpolated(mesh.mesh(), picture, u), pv = interpolated(mesh.mesh(), picture, v);
      std::vector<float> red(pu.size());
      kernels::simd::look_up(pyramid, filter, {pu.data(), pv.data()}, pu.size(),
                             {{red.data(), nullptr, nullptr, nullptr}});
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          const std::array<std::array<int, 2>, 4> source{
              {{x, y}, {size - 1 - y, x}, {size - 1 - x, size - 1 - y}, {y, size - 1 - x}}};
          const auto at = [&](int sx, int sy) {
            return texels[static_cast<std::size_t>(sy * size + sx) * 4];
          };
          const float want = at(source[turn][0], source[turn][1]);
          // The textbook: pixel x lies at x / (N - 1), so that pixels fall between texels.
          const float sx = static_cast<float>(x) / (size - 1) * size - 0.5F;
          const int low = std::clamp(static_cast<int>(std::floor(sx)), 0, size - 2);
          const float f = sx - static_cast<float>(low),
                      blurred = at(low, y) + f * (at(low + 1, y) - at(low, y));
          t.tally(blurred != at(x, y), red[static_cast<std::size_t>(y * size + x)] != want,
                  {static_cast<double>(x), static_cast<double>(y), static_cast<double>(turn)});
        }
    }
}

// ----- the homography

using Corners = std::array<glm::dvec2, 4>;
using Exact2 = std::array<Rational, 2>;

// x = (a u + b v + c) / (g u + h v + 1) from the eight equations of the corners, by elimination with pivots.
std::array<double, 8> textbook_homography(const Corners& p) {
  constexpr std::array<std::array<int, 2>, 4> uv{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  std::array<std::array<double, 9>, 8> m{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const double u = uv[i][0], v = uv[i][1], at = p[i][static_cast<glm::length_t>(k)];
      auto& row = m[2 * i + k];
      row[3 * k] = u, row[3 * k + 1] = v, row[3 * k + 2] = 1;
      row[6] = -u * at, row[7] = -v * at, row[8] = at;
    }
  for (std::size_t c = 0; c < 8; ++c) {
    std::size_t best = c;
    for (std::size_t r = c; r < 8; ++r)
      if (std::fabs(m[r][c]) > std::fabs(m[best][c])) best = r;
    std::swap(m[c], m[best]);
    for (std::size_t r = 0; r < 8; ++r) {
      if (r == c) continue;
      const double f = m[r][c] / m[c][c];
      for (std::size_t k = c; k < 9; ++k) m[r][k] -= f * m[c][k];
    }
  }
  std::array<double, 8> h;
  for (std::size_t i = 0; i < 8; ++i) h[i] = m[i][8] / m[i][i];
  return h;
}
glm::dvec2 textbook_pixel(const Corners& p, const glm::dvec2& at) {
  const auto h = textbook_homography(p);
  const double w = h[6] * at.x + h[7] * at.y + 1;
  return {(h[0] * at.x + h[1] * at.y + h[2]) / w, (h[3] * at.x + h[4] * at.y + h[5]) / w};
}
// Heckbert's closed form, exactly.
Exact2 exact_pixel(const Corners& p, const glm::dvec2& at) {
  const auto x = [&](std::size_t i) { return Rational(p[i].x); };
  const auto y = [&](std::size_t i) { return Rational(p[i].y); };
  const Rational dx1 = x(1) - x(2), dx2 = x(3) - x(2), sx = x(0) - x(1) + x(2) - x(3), dy1 = y(1) - y(2),
                 dy2 = y(3) - y(2), sy = y(0) - y(1) + y(2) - y(3), det = dx1 * dy2 - dx2 * dy1;
  const Rational g = (sx * dy2 - dx2 * sy) / det, h = (dx1 * sy - sx * dy1) / det, u(at.x), v(at.y);
  const Rational w = g * u + h * v + 1;
  return {Rational(((x(1) - x(0) + g * x(1)) * u + (x(3) - x(0) + h * x(3)) * v + x(0)) / w),
          Rational(((y(1) - y(0) + g * y(1)) * u + (y(3) - y(0) + h * y(3)) * v + y(0)) / w)};
}

void nearly_collinear_corners(Trial& t) {
  std::vector<std::pair<Corners, glm::dvec2>> inputs;
  const Corners given{glm::dvec2{0, 0}, {1, 0}, {2, 1e-9}, {0, 1}};
  for (const double offset : {0.0, 1e5})
    for (std::size_t n = t.samples(200, 5000); n-- > 0;) {
      Corners c = given;
      c[2].y = std::fabs(t.random.magnitude(-40, -8));
      for (auto& p : c) p += glm::dvec2(offset, offset);
      c[2].y = std::max(c[2].y, std::nextafter(offset, 1e9));  // convex still
      inputs.emplace_back(c, glm::dvec2(t.random.uniform(0, 1), t.random.uniform(0, 1)));
    }
  const auto ours = [](const std::pair<Corners, glm::dvec2>& in) {
    return kernels::QuadMap::of(in.first, kernels::QuadMapKind::projective)->pixel_of(in.second);
  };
  const auto theirs = [](const std::pair<Corners, glm::dvec2>& in) {
    return textbook_pixel(in.first, in.second);
  };
  for (const auto& in : inputs) {
    const Exact2 want = exact_pixel(in.first, in.second);
    // In units of 2^-53 of the coordinates, which the corners themselves are given to.
    const Rational unit = Rational(0x1p-53) * Rational(std::max(1.0, std::fabs(in.first[0].x)));
    const auto error = [&](const glm::dvec2& px) {
      const double e = std::max(distance(px.x, want[0], unit), distance(px.y, want[1], unit));
      return std::isfinite(e) ? e : 1e300;
    };
    t.measure(error(theirs(in)), error(ours(in)), {in.first[2].x, in.first[2].y, in.second.x, in.second.y});
  }
  t.price_over(inputs, theirs, ours);
}

// ----- needles

// Heckbert's ellipse from the derivatives alone: A x^2 + B x y + C y^2 < F over its box. How many texels that
// looks at; 0 where a coefficient is not finite.
double textbook_texels(double sx, double tx, double sy, double ty) {
  const double a = tx * tx + ty * ty, b = -2 * (sx * tx + sy * ty), c = sx * sx + sy * sy,
               f = sx * ty - sy * tx, f2 = f * f, det = 4 * a * c - b * b;
  const double width = 2 * std::sqrt(4 * c * f2 / det), height = 2 * std::sqrt(4 * a * f2 / det);
  return std::isfinite(a / f2 + b / f2 + c / f2 + width + height) ? (width + 1) * (height + 1) : 0;
}

void needles(Trial& t) {
  constexpr double most = 16;
  constexpr int size = 1024, last = 10;
  struct Needle {
    double du_dx, dv_dx, du_dy, dv_dy;
  };
  std::vector<Needle> inputs{{1, 0, 0, 0}, {0, 0, 0, 0}, {0.1, 0.1, 0.1, 0.1}, {1, 0, 0, 1e-6}};
  for (std::size_t n = t.samples(400, 20000); n-- > 0;) {
    const double length = std::fabs(t.random.magnitude(-6, 4)), thin = length * 1e-6,
                 turn = t.random.uniform(0, 6.28);
    inputs.push_back(
        {length * std::cos(turn), length * std::sin(turn), -thin * std::sin(turn), thin * std::cos(turn)});
  }
  std::vector<std::vector<float>> texels;
  std::vector<kernels::TexelLevel> levels;
  for (int side = size; side > 0; side /= 2) {
    auto& level = texels.emplace_back(static_cast<std::size_t>(side * side) * 4);
    for (float& c : level) c = static_cast<float>(t.random.uniform(0, 1));
    levels.push_back({side, side, level.data()});
  }
  const kernels::TexelPyramid pyramid{levels};
  const auto rows = [](const Needle& n, const double& zero) {
    return kernels::UvRows<double>{&zero, &zero, &n.du_dx, &n.dv_dx, &n.du_dy, &n.dv_dy, nullptr};
  };
  const double zero = 0.3;
  for (const Needle& n : inputs) {
    const auto f = kernels::widened(kernels::footprint<double>(rows(n, zero), 0, size, size), most);
    const double level = kernels::ewa_level(f, last);
    std::size_t read = 0;
    for (const double l : {std::floor(level), std::floor(level) + 1}) {
      if (l > last) continue;
      const double shrink = std::min(1.0, 4096 / f.minor), s = std::exp2(-2 * l) * shrink * shrink * 2 / 3;
      kernels::visit_ellipse(0.1, 0.2, f.ss * s + 4.0 / 3, f.st * s, f.tt * s + 4.0 / 3,
                             [&](const kernels::EllipseRow<double>& row) {
                               for (int i = row.first; i <= row.last; ++i) read += row.weight(i) > 0 ? 1 : 0;
                             });
    }
    const auto c = kernels::elliptical<kernels::ColorSum<double>>(pyramid, rows(n, zero), 0, most);
    bool robust = read > 0 && static_cast<double>(read) <= 50 * most;
    for (const double x : c) robust = robust && x >= 0 && x <= 1;
    const double naive = textbook_texels(n.du_dx * size, n.dv_dx * size, n.du_dy * size, n.dv_dy * size);
    t.tally(!(naive >= 1 && naive <= 50 * most), !robust, {n.du_dx, n.dv_dx, n.du_dy, n.dv_dy});
  }
}

}  // namespace

std::vector<HardCase> texture() {
  return {
      {"TEX-01", "strips whose ends differ in w by up to 1e7", "u linear on the screen",
       "kernels::simd::interpolate_attributes", "rationals", "within 6 ulp", "ulp", 6, large_w_ratio},
      {"TEX-03", "triangles with w = (-1, 1, 1), not clipped before", "divide by w, rasterize",
       "clip, viewport and fill kernels", "rays through pixels, 113 bits",
       "the pixels of the clipped triangle", "wrong pixels", 0, w_changes_sign},
      {"TEX-05", "coordinates -1e-9, -1e-30, 1e6 + 0.3, infinite, NaN, random up to 2^24",
       "(s - floor(s)) N in float", "kernels::simd::look_up, fold", "rationals",
       "an index in [0, N) always; the right texel to ulp(s) N", "indices outside", 0, wrapping},
      {"TEX-06", "texels 2^-30 to 2^30 apart, fractions 0, 1 and 1 - k 2^-24", "a + (b - a) f in float",
       "kernels::between, simd::look_up", "comparison", "ends exact; between the texels; equal texels stay",
       "colours outside", 0, far_apart_texels},
      {"TEX-07", "a strip from w = 1 to w = 3", "half way on the screen is half way in u",
       "kernels::simd::interpolate_attributes", "rationals", "u = 1/4 within 2 ulp", "ulp", 2, midpoint_law},
      {"TEX-08", "rows of 16384 px over 4096 texels", "u / w and 1 / w stepped in float",
       "kernels::simd::interpolate_attributes", "rationals", "within 1/256 texel at every pixel", "texels",
       1.0 / 256, long_scanline},
      {"TEX-09", "corners (0,0), (1,0), (2, 2^-8 to 2^-40), (0,1), also at 1e5",
       "eight equations, eliminated with pivots", "kernels::QuadMap", "rationals",
       "within 8 u of the coordinates", "u", 8, nearly_collinear_corners},
      {"TEX-11", "footprints of 1 : 1e6 and of no area, 2^-6 to 2^4 textures long",
       "the ellipse of the derivatives", "kernels::elliptical", "counting",
       "a colour of the texels from at most 50 max_anisotropy of them", "footprints without a colour", 0,
       needles},
      {"TEX-12", "a texture of 64 x 64 on as many pixels, in four quarter turns", "u = x / (N - 1)",
       "fill, interpolate and look-up kernels", "comparison of bits",
       "the texels themselves, nearest and bilinear", "changed pixels", 0, one_texel_a_pixel},
  };
}

}  // namespace frustum::hard
