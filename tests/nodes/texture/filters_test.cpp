// The filters of texture.sample: cubics, ellipses, borders; against sums over every texel and against
// supersampling.
#include "nodes/kernels/simd/texture_lookup.h"
#include "tests/support/tiles.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace frustum {
namespace {

using kernels::EdgeRule, kernels::Filtering, kernels::Lookup, kernels::TexelLevel, kernels::TexelPyramid;
constexpr std::array all_filters{Lookup::nearest,  Lookup::bilinear, Lookup::trilinear, Lookup::catmull_rom,
                                 Lookup::mitchell, Lookup::b_spline, Lookup::ewa};
constexpr std::array all_rules{EdgeRule::repeat, EdgeRule::clamp, EdgeRule::mirror, EdgeRule::border};
constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();

// A pyramid of averages over whole blocks; sides are powers of two.
class Pyramid {
 public:
  Pyramid(int width, int height, const std::function<float(int x, int y, int channel)>& texel) {
    std::vector<float> rgba(static_cast<std::size_t>(width * height) * 4);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int k = 0; k < 4; ++k) rgba[static_cast<std::size_t>((y * width + x) * 4 + k)] = texel(x, y, k);
    for (;;) {
      texels_.push_back(std::move(rgba)), sizes_.push_back({width, height});
      if (width == 1 && height == 1) break;
      const int w = std::max(1, width / 2), h = std::max(1, height / 2), fx = width / w, fy = height / h;
      rgba.assign(static_cast<std::size_t>(w * h) * 4, 0);
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
          for (int k = 0; k < 4; ++k) {
            double sum = 0;
            for (int j = 0; j < fy; ++j)
              for (int i = 0; i < fx; ++i)
                sum += texels_.back()[static_cast<std::size_t>(((y * fy + j) * width + x * fx + i) * 4 + k)];
            rgba[static_cast<std::size_t>((y * w + x) * 4 + k)] = static_cast<float>(sum / (fx * fy));
          }
      width = w, height = h;
    }
    for (std::size_t l = 0; l < texels_.size(); ++l)
      levels_.push_back({sizes_[l][0], sizes_[l][1], texels_[l].data()});
  }
  TexelPyramid with(EdgeRule u, EdgeRule v) const { return {levels_, u, v}; }

 private:
  std::vector<std::vector<float>> texels_;
  std::vector<std::array<int, 2>> sizes_;
  std::vector<TexelLevel> levels_;
};

Pyramid noise(int width, int height) {
  test::Random random(9);
  return {width, height,
          [&](int, int, int) { return static_cast<float>(random.below(1 << 20)) / (1 << 20); }};
}

// One point, in double.
struct Point {
  double u = 0, v = 0, du_dx = 0, dv_dx = 0, du_dy = 0, dv_dy = 0;
  kernels::UvRows<double> rows() const { return {&u, &v, &du_dx, &dv_dx, &du_dy, &dv_dy, nullptr}; }
};
std::array<double, 4> look(const TexelPyramid& p, const Filtering& filter, const Point& at) {
  std::array<double, 4> c{};
  kernels::look_up(p, filter, at.rows(), 1, {{&c[0], &c[1], &c[2], &c[3]}});
  return c;
}

Point random_point(std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(-2, 3), turn(0, 6.28), log_size(-9, 1), slant(0, 5);
  const double size = std::exp2(log_size(random)), thin = size * std::exp2(-slant(random)), a = turn(random);
  const double b = turn(random);  // the pixel's own axes
  const auto mix = [&](double x, double y) {
    return std::array{size * std::cos(a) * x - thin * std::sin(a) * y,
                      size * std::sin(a) * x + thin * std::cos(a) * y};
  };
  const auto x = mix(std::cos(b), std::sin(b)), y = mix(-std::sin(b), std::cos(b));
  return {place(random), place(random), x[0], x[1], y[0], y[1]};
}

TEST(TextureFilters, EqualTexelsGiveTheirBits) {
  const Pyramid flat(16, 8, [](int, int, int k) {
    return std::array{0.1F, 0.7F, 0.33F, 1.0F}[static_cast<std::size_t>(k)];
  });
  std::mt19937_64 random(1);
  for (const Lookup filter : all_filters)
    for (const EdgeRule rule : {EdgeRule::repeat, EdgeRule::clamp, EdgeRule::mirror})
      for (int i = 0; i < 200; ++i) {
        const auto c = look(flat.with(rule, EdgeRule::repeat), filter, random_point(random));
        ASSERT_EQ(c, (std::array<double, 4>{0.1F, 0.7F, 0.33F, 1.0F})) << static_cast<int>(filter);
      }
}

TEST(TextureFilters, TexelNumbersAreWrappedAsSteppingThroughThemWould) {
  for (const int size : {1, 2, 5})
    for (const EdgeRule rule : all_rules) {
      int at = 0, step = 1;  // walks up from 0 as the rule says
      for (int i = 0; i < 40; ++i) {
        if (rule == EdgeRule::repeat) {
          EXPECT_EQ(kernels::wrapped(i, size, rule), at);
          at = at + 1 == size ? 0 : at + 1;
        } else if (rule == EdgeRule::mirror) {
          EXPECT_EQ(kernels::wrapped(i, size, rule), at);
          EXPECT_EQ(kernels::wrapped(-1 - i, size, rule), at);
          if (at + step < 0 || at + step >= size)
            step = -step;
          else
            at += step;
        } else {
          const bool inside = i < size;
          EXPECT_EQ(kernels::wrapped(i, size, rule), inside ? i : (rule == EdgeRule::clamp ? size - 1 : -1));
          EXPECT_EQ(kernels::wrapped(-1 - i, size, rule), rule == EdgeRule::clamp ? 0 : -1);
        }
      }
      if (rule == EdgeRule::repeat) {
        EXPECT_EQ(kernels::wrapped(-1, size, rule), size - 1);
      }
    }
}

// A border is what a frame of transparent black around the picture would be.
TEST(TextureFilters, ABorderIsAPictureWithAnEmptyFrame) {
  constexpr int size = 8, frame = 32;
  const Pyramid inner = noise(size, size);
  const auto source = inner.with(EdgeRule::border, EdgeRule::border);
  const Pyramid padded(64, 64, [&](int x, int y, int k) {
    const int i = x - frame + size / 2, j = y - frame + size / 2;
    return i < 0 || j < 0 || i >= size || j >= size ? 0.0F : source.levels[0].rgba[(j * size + i) * 4 + k];
  });
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-1, 2);
  int beyond = 0;
  for (int i = 0; i < 3000; ++i) {
    Point p{place(random), place(random)};
    for (double* d : {&p.du_dx, &p.dv_dy}) *d = 0.3 / size;  // of level 0 in both
    Point q = p;
    q.u = 0.5 + (p.u - 0.5) / 8, q.v = 0.5 + (p.v - 0.5) / 8, q.du_dx /= 8, q.dv_dy /= 8;
    for (const Lookup filter : all_filters) {
      const auto a = look(source, filter, p),
                 b = look(padded.with(EdgeRule::clamp, EdgeRule::clamp), filter, q);
      for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(a[k], b[k], 1e-11) << static_cast<int>(filter);
      beyond += a == std::array<double, 4>{} ? 1 : 0;
    }
  }
  EXPECT_GT(beyond, 1000);
}

// ----- cubics

TEST(TextureFilters, CatmullRomPassesThroughTheTexelsAndKeepsParabolas) {
  const Pyramid p = noise(16, 16);
  const auto pyramid = p.with(EdgeRule::repeat, EdgeRule::repeat);
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 16; ++i)
      EXPECT_EQ(look(pyramid, Lookup::catmull_rom, {(i + 0.5) / 16, 1 - (j + 0.5) / 16})[1],
                pyramid.levels[0].rgba[(j * 16 + i) * 4 + 1]);
  const Pyramid parabola(16, 16,
                         [](int x, int y, int) { return static_cast<float>(x * x - 3 * x * y + 2 * y); });
  const Pyramid ramp(16, 16, [](int x, int y, int) { return static_cast<float>(3 * x - 5 * y); });
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> inside(2, 13);  // in texels: sixteen around it
  for (int i = 0; i < 500; ++i) {
    const double x = inside(random), y = inside(random);
    const Point at{(x + 0.5) / 16, 1 - (y + 0.5) / 16};
    EXPECT_NEAR(look(parabola.with(EdgeRule::clamp, EdgeRule::clamp), Lookup::catmull_rom, at)[0],
                x * x - 3 * x * y + 2 * y, 1e-11);
    for (const Lookup cubic : {Lookup::catmull_rom, Lookup::mitchell, Lookup::b_spline})
      EXPECT_NEAR(look(ramp.with(EdgeRule::clamp, EdgeRule::clamp), cubic, at)[0], 3 * x - 5 * y, 1e-11);
  }
}

TEST(TextureFilters, TheSplineStaysWithinItsTexelsAndMitchellDoesNot) {
  const Pyramid step(16, 16, [](int x, int, int) { return x < 8 ? 0.0F : 1.0F; });
  double spline_least = 0, mitchell_least = 0;
  for (int i = 0; i < 1000; ++i) {
    const Point at{i / 1000.0, 0.5};
    spline_least =
        std::min(spline_least, look(step.with(EdgeRule::clamp, EdgeRule::clamp), Lookup::b_spline, at)[0]);
    mitchell_least =
        std::min(mitchell_least, look(step.with(EdgeRule::clamp, EdgeRule::clamp), Lookup::mitchell, at)[0]);
  }
  EXPECT_GE(spline_least, 0);
  EXPECT_LT(mitchell_least, -0.02);
}

// ----- footprints

TEST(TextureFootprint, HasTheAxesOfTheEllipse) {
  // 8 texels along (3, 4) / 5 and 2 across it; the pixel's own axes do not matter.
  const double s = 0.6, t = 0.8;
  for (const double turn : {0.0, 0.3, 1.2}) {
    const double c = std::cos(turn), d = std::sin(turn);
    const Point p{0,
                  0,
                  (8 * s * c - 2 * t * d) / 64,
                  -(8 * t * c + 2 * s * d) / 32,
                  (-8 * s * d - 2 * t * c) / 64,
                  -(-8 * t * d + 2 * s * c) / 32};
    const auto f = kernels::footprint(p.rows(), 0, 64.0, 32.0);
    EXPECT_NEAR(f.major, 8, 1e-13);
    EXPECT_NEAR(f.minor, 2, 1e-13);
    EXPECT_NEAR(f.area, 16, 1e-13);
    EXPECT_NEAR(std::abs(f.major_axis()[0] * s + f.major_axis()[1] * t), 8, 1e-12);
    const auto w = kernels::widened(f, 2.0);
    EXPECT_NEAR(w.minor, 4, 1e-13);
    EXPECT_NEAR(w.ss * w.tt - w.st * w.st, 8 * 8 * 4 * 4, 1e-9) << "the major axis stays";
    EXPECT_NEAR(w.ss + w.tt, 64 + 16, 1e-11);
    EXPECT_EQ(kernels::widened(f, 16.0).st, f.st) << "already wide enough";
  }
}

TEST(TextureFootprint, KeepsTheDigitsOfANeedlesMinorAxis) {
  // 1 : 1e8 along a slanted direction. The difference of eigenvalues has no digit left of the smaller one.
  const double major = 0.9, minor = 0.9e-8;
  const Point p{0, 0, 0.6 * major, -0.8 * major, -0.8 * minor, -0.6 * minor};
  const auto f = kernels::footprint(p.rows(), 0, 1.0, 1.0);
  EXPECT_NEAR(f.minor / minor, 1, 1e-9);
  const double mean = (f.ss + f.tt) / 2, half = (f.ss - f.tt) / 2;
  const double textbook = std::sqrt(std::max(0.0, mean - std::sqrt(half * half + f.st * f.st)));
  EXPECT_GT(std::abs(textbook / minor - 1), 1e-3);
}

// ----- ellipses

// Every texel of a level about the place, by the definition of the weights.
std::array<double, 4> by_definition(const TexelPyramid& p, const TexelLevel& level, double x, double y,
                                    double ss, double st, double tt) {
  const double det = ss * tt - st * st;
  std::array<double, 4> sum{};
  double weights = 0;
  const int reach = static_cast<int>(std::sqrt(std::max(ss, tt))) + 2;
  for (int j = static_cast<int>(std::floor(y)) - reach; j <= y + reach; ++j)
    for (int i = static_cast<int>(std::floor(x)) - reach; i <= x + reach; ++i) {
      const double dx = i - x, dy = j - y, q = (tt * dx * dx - 2 * st * dx * dy + ss * dy * dy) / det;
      if (q >= 1) continue;
      const auto t = kernels::texel<double>(level, kernels::wrapped(i, level.width, p.wrap_u),
                                            kernels::wrapped(j, level.height, p.wrap_v));
      for (std::size_t k = 0; k < 4; ++k) sum[k] += (1 - q) * (1 - q) * t[k];
      weights += (1 - q) * (1 - q);
    }
  for (double& c : sum) c /= weights;
  return sum;
}

TEST(TextureEllipse, IsTheWeightedSumOverEveryTexel) {
  const Pyramid texels = noise(32, 32);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-5, 37), axis(1.2, 9), turn(0, 3.2);
  for (const EdgeRule rule : all_rules)
    for (int i = 0; i < 300; ++i) {
      const auto p = texels.with(rule, EdgeRule::mirror);
      const double a = axis(random), b = axis(random), w = turn(random), c = std::cos(w), s = std::sin(w);
      const double ss = a * a * c * c + b * b * s * s, st = (a * a - b * b) * c * s,
                   tt = a * a * s * s + b * b * c * c;
      const double x = place(random), y = place(random);
      const auto got = kernels::ellipse_mean<kernels::ColorSum<double>>(p, p.levels[0], x, y, ss, st, tt),
                 want = by_definition(p, p.levels[0], x, y, ss, st, tt);
      for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(got[k], want[k], 1e-12);
    }
}

// The variance of the weights is an eighth of the ellipse, which is what the pixel's square and the tent add
// up to.
TEST(TextureEllipse, HasTheVarianceOfThePixelAndTheTent) {
  const double ss = 2.0 / 3 * 900 + 4.0 / 3, tt = 2.0 / 3 * 100 + 4.0 / 3,
               st = 0;  // a pixel of 30 x 10 texels
  double sum = 0, xx = 0, yy = 0;
  kernels::visit_ellipse(0.3, -0.4, ss, st, tt, [&](const kernels::EllipseRow<double>& row) {
    for (int i = row.first; i <= row.last; ++i) {
      const double w = row.weight(i);
      sum += w, xx += w * (i - 0.3) * (i - 0.3), yy += w * (row.row + 0.4) * (row.row + 0.4);
    }
  });
  EXPECT_NEAR(xx / sum, 900.0 / 12 + 1.0 / 6, 0.01 * 75);
  EXPECT_NEAR(yy / sum, 100.0 / 12 + 1.0 / 6, 0.01 * 8.5);
}

TEST(TextureEllipse, FollowsMirroredDirections) {
  const Pyramid texels = noise(16, 16);
  // The same picture, drawn four times, two of them mirrored.
  const auto once = texels.with(EdgeRule::mirror, EdgeRule::mirror);
  const Pyramid whole(32, 32, [&](int x, int y, int k) {
    return once.levels[0].rgba[((y < 16 ? y : 31 - y) * 16 + (x < 16 ? x : 31 - x)) * 4 + k];
  });
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> place(0, 2), slope(-0.1, 0.1);
  for (int i = 0; i < 300; ++i) {
    const Point p{place(random), place(random), slope(random), slope(random), slope(random), slope(random)};
    Point q = p;
    // Row 0 is on top, so the 16 rows that are not mirrored are the upper half of the large picture.
    q.u = p.u / 2, q.v = (p.v + 1) / 2;
    for (double* d : {&q.du_dx, &q.dv_dx, &q.du_dy, &q.dv_dy}) *d /= 2;
    const auto a = look(once, Lookup::ewa, p),
               b = look(whole.with(EdgeRule::repeat, EdgeRule::repeat), Lookup::ewa, q);
    for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(a[k], b[k], 1e-12);
  }
}

TEST(TextureEllipse, ReadsABoundedNumberOfTexelsWhateverTheDerivatives) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-12, 12), turn(0, 6.28);
  for (const double most : {1.0, 4.0, 16.0, 64.0})
    for (int i = 0; i < 500; ++i) {
      const double a = std::pow(10, exponent(random)), b = std::pow(10, exponent(random)), w = turn(random);
      const Point p{0, 0, a * std::cos(w), a * std::sin(w), -b * std::sin(w), b * std::cos(w)};
      auto f = kernels::widened(kernels::footprint(p.rows(), 0, 1024.0, 1024.0), most);
      const double level = kernels::ewa_level(f, 10);
      if (level >= 10) continue;  // shrunk to the last level
      std::size_t texels = 0;
      for (const double l : {std::floor(level), std::floor(level) + 1}) {
        const double s = std::exp2(-2 * l);
        kernels::visit_ellipse(0.1, 0.2, f.ss * s * 2 / 3 + 4.0 / 3, f.st * s * 2 / 3,
                               f.tt * s * 2 / 3 + 4.0 / 3, [&](const kernels::EllipseRow<double>& row) {
                                 for (int i = row.first; i <= row.last; ++i)
                                   texels += row.weight(i) > 0 ? 1 : 0;
                               });
      }
      ASSERT_LE(static_cast<double>(texels), 50 * most + 30) << a << " " << b;
    }
}

TEST(TextureEllipse, HasFiniteColoursForHostilePoints) {
  for (const auto& [w, h] : {std::pair{64, 64}, {256, 1}, {1, 1}}) {
    const Pyramid texels = noise(w, h);
    for (const EdgeRule rule : all_rules)
      for (const float u : {0.0F, -0.0F, 1.0F, 1e30F, -1e30F, inf, -inf, nan})
        for (const float d : {0.0F, 1e-40F, 1e-3F, 1.0F, 1e6F, 1e20F, inf, nan})
          for (const float e : {0.0F, 1e-9F, 1.0F, 1e20F, nan}) {
            std::array<float, 4> c{nan, nan, nan, nan};
            kernels::look_up<float>(texels.with(rule, rule), Lookup::ewa, {&u, &u, &d, &e, &e, &d, nullptr},
                                    1, {{&c[0], &c[1], &c[2], &c[3]}});
            for (const float x : c) ASSERT_TRUE(x >= 0 && x <= 1) << u << " " << d << " " << e;
          }
  }
}

// A floor that recedes, seen through every filter: error against 64 x 64 bilinear samples a pixel.
struct FloorErrors {
  double nearest, bilinear, trilinear, ewa1, ewa4, ewa16;
};
FloorErrors floor_errors() {
  constexpr int size = 256;
  const Pyramid board(size, size, [](int x, int y, int) { return (x / 8 + y / 8) % 2 == 0 ? 1.0F : 0.0F; });
  const auto p = board.with(EdgeRule::repeat, EdgeRule::repeat);
  const auto place = [](double x, double y) {  // z = 24 / (y - horizon): u across, v away
    const double z = 24 / (y + 4);
    return Point{(x - 32) / 64 * z, z, z / 64, 0, -(x - 32) / 64 * z / (y + 4), -z / (y + 4)};
  };
  std::array<double, 6> sum{};
  int pixels = 0;
  for (int y = 0; y < 48; y += 2)
    for (int x = 1; x < 64; x += 5, ++pixels) {
      double truth = 0;
      constexpr int n = 64;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          truth += look(p, Lookup::bilinear, place(x + (i + 0.5) / n, y + (j + 0.5) / n))[0] / (n * n);
      const Filtering filters[] = {Lookup::nearest,  Lookup::bilinear, Lookup::trilinear,
                                   {Lookup::ewa, 1}, {Lookup::ewa, 4}, {Lookup::ewa, 16}};
      for (std::size_t k = 0; k < 6; ++k) {
        const double e = look(p, filters[k], place(x + 0.5, y + 0.5))[0] - truth;
        sum[k] += e * e;
      }
    }
  for (double& s : sum) s = std::sqrt(s / pixels);
  return {sum[0], sum[1], sum[2], sum[3], sum[4], sum[5]};
}

TEST(TextureEllipse, IsClosestToTheSupersampledFloor) {
  const FloorErrors e = floor_errors();
  RecordProperty("rmse", ::testing::PrintToString(
                             std::array{e.nearest, e.bilinear, e.trilinear, e.ewa1, e.ewa4, e.ewa16}));
  EXPECT_LT(e.trilinear, e.bilinear);
  EXPECT_LT(e.ewa16, e.trilinear / 2.5);
  EXPECT_LT(e.ewa16, e.ewa4);
  EXPECT_LT(e.ewa4, e.ewa1);
  EXPECT_GT(e.nearest, 0.25);
  EXPECT_LT(e.ewa16, 0.03);
}

}  // namespace
}  // namespace frustum
