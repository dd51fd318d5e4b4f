// The metrics that look at colours, against published data and against their papers' formulas written out.
#include "runtime/app/metrics/delta_e.h"
#include "runtime/app/metrics/flip.h"
#include "runtime/app/metrics/ssim.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace frustum {
namespace {

// Sharma, Wu and Dalal 2005, table 1: the pairs that tell right implementations from wrong ones.
struct Pair {
  glm::dvec3 a, b;
  double difference;
};
const std::vector<Pair>& sharma() {
  static const std::vector<Pair> pairs{
      {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
      {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
      {{50, 2.8361, -74.0200}, {50, 0, -82.7485}, 3.4412},
      {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
      {{50, -1.1848, -84.8006}, {50, 0, -82.7485}, 1.0000},
      {{50, -0.9009, -85.5211}, {50, 0, -82.7485}, 1.0000},
      {{50, 0, 0}, {50, -1, 2}, 2.3669},
      {{50, -1, 2}, {50, 0, 0}, 2.3669},
      {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0009}, 7.1792},
      {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0010}, 7.1792},
      {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0011}, 7.2195},
      {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0012}, 7.2195},
      {{50, -0.0010, 2.4900}, {50, 0.0009, -2.4900}, 4.8045},
      {{50, -0.0010, 2.4900}, {50, 0.0010, -2.4900}, 4.8045},
      {{50, -0.0010, 2.4900}, {50, 0.0011, -2.4900}, 4.7461},
      {{50, 2.5, 0}, {50, 0, -2.5}, 4.3065},
      {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
      {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
      {{50, 2.5, 0}, {56, -27, -3}, 31.9030},
      {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
      {{50, 2.5, 0}, {50, 3.1736, 0.5854}, 1.0000},
      {{50, 2.5, 0}, {50, 3.2972, 0}, 1.0000},
      {{50, 2.5, 0}, {50, 1.8634, 0.5757}, 1.0000},
      {{50, 2.5, 0}, {50, 3.2592, 0.3350}, 1.0000},
      {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
      {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.2630},
      {{61.2901, 3.7196, -5.3901}, {61.4292, 2.2480, -4.9620}, 1.8731},
      {{35.0831, -44.1164, 3.7933}, {35.0232, -40.0716, 1.5901}, 1.8645},
      {{22.7233, 20.0904, -46.6940}, {23.0331, 14.9730, -42.5619}, 2.0373},
      {{36.4612, 47.8580, 18.3852}, {36.2715, 50.5065, 21.2231}, 1.4146},
      {{90.8027, -2.0831, 1.4410}, {91.1528, -1.6435, 0.0447}, 1.4441},
      {{90.9257, -0.5406, -0.9208}, {88.6381, -0.8985, -0.7239}, 1.5381},
      {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
      {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082},
  };
  return pairs;
}

TEST(DeltaE2000, AgreesWithSharmasPairsBothWays) {
  ASSERT_EQ(sharma().size(), 34u);
  for (const Pair& p : sharma()) {
    EXPECT_NEAR(delta_e_2000(p.a, p.b), p.difference, 5e-5) << p.a.y << " " << p.b.y;
    EXPECT_NEAR(delta_e_2000(p.b, p.a), p.difference, 5e-5) << p.a.y << " " << p.b.y;
  }
}

// The twin: the plain Euclidean distance of 1976 must not pass the same table.
TEST(DeltaE2000, TheEuclideanDistanceFailsSharmasPairs) {
  const auto euclidean = [](const Pair& p) {
    return std::hypot(p.a.x - p.b.x, p.a.y - p.b.y, p.a.z - p.b.z);
  };
  EXPECT_GT(std::count_if(sharma().begin(), sharma().end(),
                          [&](const Pair& p) { return std::abs(euclidean(p) - p.difference) > 5e-5; }),
            30);
}

TEST(DeltaE2000, LabOfWhiteGreyAndRed) {
  const glm::dvec3 white = lab_of_xyz(xyz_of_rec709({1, 1, 1}));
  EXPECT_NEAR(white.x, 100, 1e-4);
  EXPECT_NEAR(white.y, 0, 0.01);
  EXPECT_NEAR(white.z, 0, 0.01);
  EXPECT_NEAR(lab_of_xyz(xyz_of_rec709({0.18, 0.18, 0.18})).x, 49.4961, 1e-3);
  const glm::dvec3 red = lab_of_xyz(xyz_of_rec709({1, 0, 0}));
  EXPECT_NEAR(red.x, 53.24, 0.01);
  EXPECT_NEAR(red.y, 80.09, 0.02);
  EXPECT_NEAR(red.z, 67.20, 0.02);
}

Picture uniform(double r, double g, double b, int width = 40, int height = 30) {
  Picture p;
  p.rgb.fill(Grid(width, height));
  const double c[3]{r, g, b};
  for (std::size_t i = 0; i < 3; ++i) std::fill(p.rgb[i].values.begin(), p.rgb[i].values.end(), c[i]);
  return p;
}

Picture noise(unsigned seed) {
  Picture p = uniform(0, 0, 0);
  std::mt19937 random(seed);
  for (Grid& g : p.rgb)
    for (double& v : g.values) v = static_cast<double>(random()) / 4294967296.0;
  return p;
}

TEST(Flip, SamePicturesAreZero) { EXPECT_EQ(mean(flip_map(noise(1), noise(1))), 0); }

// Without structure, what is left is the redistributed distance of two colours; black and white are 100 apart
// in lightness, the farthest colours green and blue: 0.95 + (100^0.7 - 0.4 m) / (0.6 m) * 0.05 with m =
// 41.27.
TEST(Flip, BlackAndWhiteByHand) {
  const Grid map = flip_map(uniform(0, 0, 0), uniform(1, 1, 1));
  const auto [low, high] = std::minmax_element(map.values.begin(), map.values.end());
  EXPECT_NEAR(*low, 0.9674, 2e-4);
  EXPECT_NEAR(*high, 0.9674, 2e-4);
}

TEST(Flip, LiesBetweenZeroAndOneAndIsSymmetric) {
  const Grid ab = flip_map(noise(1), noise(2)), ba = flip_map(noise(2), noise(1));
  for (std::size_t i = 0; i < ab.values.size(); ++i) {
    EXPECT_GE(ab.values[i], 0);
    EXPECT_LE(ab.values[i], 1);
    EXPECT_DOUBLE_EQ(ab.values[i], ba.values[i]);
  }
}

// The paper's pipeline for one pixel, with its two-dimensional kernels summed as they stand.
class FlipByThePaper {
 public:
  FlipByThePaper(const Picture& a, const Picture& b, double ppd) : a_(a), b_(b), ppd_(ppd) {}

  double at(int x, int y) const {
    const double max = std::pow(hyab({0, 1, 0}, {0, 0, 1}), 0.7);
    const double e = std::pow(hyab(filtered(a_, x, y), filtered(b_, x, y)), 0.7);
    const double color = e < 0.4 * max ? 0.95 / (0.4 * max) * e : 0.95 + (e - 0.4 * max) / (0.6 * max) * 0.05;
    double feature = 0;
    for (const bool edge : {true, false})
      feature = std::max(feature, std::abs(detected(a_, x, y, edge) - detected(b_, x, y, edge)));
    return std::pow(color, 1 - std::sqrt(feature / std::numbers::sqrt2));
  }

 private:
  static double pixel(const Grid& g, int x, int y) {
    return g.at(std::clamp(x, 0, g.width - 1), std::clamp(y, 0, g.height - 1));
  }
  static glm::dvec3 ycxcz(const Picture& p, int x, int y) {
    const glm::dvec3 v =
        xyz_of_rec709({pixel(p.rgb[0], x, y), pixel(p.rgb[1], x, y), pixel(p.rgb[2], x, y)}) /
        glm::dvec3{0.95047, 1.0, 1.08883};
    return {116 * v.y - 16, 500 * (v.x - v.y), 200 * (v.y - v.z)};
  }
  static double hyab(const glm::dvec3& rgb1, const glm::dvec3& rgb2) {
    glm::dvec3 a = lab_of_xyz(xyz_of_rec709(rgb1)), b = lab_of_xyz(xyz_of_rec709(rgb2));
    for (glm::dvec3* c : {&a, &b}) c->y *= 0.01 * c->x, c->z *= 0.01 * c->x;
    return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
  }
  glm::dvec3 filtered(const Picture& p, int x, int y) const {
    const double pi = std::numbers::pi;
    const int r = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * ppd_));
    const double csf[3][4]{{1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};
    glm::dvec3 sum{0}, weights{0};
    for (int dy = -r; dy <= r; ++dy)
      for (int dx = -r; dx <= r; ++dx) {
        const glm::dvec3 c = ycxcz(p, x + dx, y + dy);
        const double d2 = (dx * dx + dy * dy) / (ppd_ * ppd_);
        for (int k = 0; k < 3; ++k) {
          const auto* s = csf[k];
          const double w = s[0] * std::sqrt(pi / s[1]) * std::exp(-pi * pi * d2 / s[1]) +
                           s[2] * std::sqrt(pi / s[3]) * std::exp(-pi * pi * d2 / s[3]);
          sum[k] += w * c[k], weights[k] += w;
        }
      }
    const glm::dvec3 c = sum / weights;
    const double v = (c.x + 16) / 116;
    const glm::dvec3 rgb =
        rec709_of_xyz(glm::dvec3{v + c.y / 500, v, v - c.z / 200} * glm::dvec3{0.95047, 1.0, 1.08883});
    return {std::clamp(rgb.r, 0.0, 1.0), std::clamp(rgb.g, 0.0, 1.0), std::clamp(rgb.b, 0.0, 1.0)};
  }
  double detected(const Picture& p, int x, int y, bool edge) const {
    const double sd = 0.5 * 0.082 * ppd_;
    const int r = static_cast<int>(std::ceil(3 * sd));
    double answer[2]{}, positive = 0, negative = 0;
    double parts[2][2]{};  // [direction][sign]
    for (int dy = -r; dy <= r; ++dy)
      for (int dx = -r; dx <= r; ++dx) {
        const double g = std::exp(-(dx * dx + dy * dy) / (2 * sd * sd));
        const double w = g * (edge ? -dx : dx * dx / (sd * sd) - 1);
        (w > 0 ? positive : negative) += std::abs(w);
        parts[0][w > 0] += w * (ycxcz(p, x + dx, y + dy).x + 16) / 116;
        parts[1][w > 0] += w * (ycxcz(p, x + dy, y + dx).x + 16) / 116;
      }
    for (int k = 0; k < 2; ++k) answer[k] = parts[k][1] / positive + parts[k][0] / negative;
    return std::hypot(answer[0], answer[1]);
  }
  const Picture& a_;
  const Picture& b_;
  double ppd_;
};

TEST(Flip, IsThePapersSumOverTwoDimensionalKernels) {
  const Picture a = noise(3);
  Picture b = noise(3);
  for (int x = 12; x < 20; ++x) b.rgb[0].at(x, 9) = 1, b.rgb[2].at(x, 9) = 0;
  const FlipByThePaper paper(a, b, 30);
  const Grid map = flip_map(a, b, 30);
  for (const auto& [x, y] : {std::pair{0, 0}, {12, 9}, {19, 8}, {39, 29}, {25, 12}})
    EXPECT_NEAR(map.at(x, y), paper.at(x, y), 1e-9) << x << "," << y;
}

TEST(Flip, AShiftedEdgeIsSeenMoreThanItsColorAlone) {
  Picture a = uniform(0.2, 0.2, 0.2), b = a, flat = a;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        if (x >= 20) a.rgb[c].at(x, y) = 0.6;
        if (x >= 24) b.rgb[c].at(x, y) = 0.6;
        flat.rgb[c].at(x, y) = 0.6;
      }
  EXPECT_GT(flip_map(a, b).at(22, 15), flip_map(uniform(0.2, 0.2, 0.2), flat).at(22, 15) * 0.8);
  EXPECT_LT(flip_map(a, b).at(2, 15), 0.05);
}

Grid grid(const std::function<double(int, int)>& f, int width = 32, int height = 32) {
  Grid g(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) g.at(x, y) = f(x, y);
  return g;
}

TEST(Ssim, SameIsOneAndConstantsFollowTheFormula) {
  const Grid ramp = grid([](int x, int y) { return (x + y) / 64.0; });
  EXPECT_NEAR(ssim(ramp, ramp), 1, 1e-12);
  // Without variance only the luminance term is left: (2 a b + C1) / (a^2 + b^2 + C1).
  const double a = 0.2, b = 0.6, c1 = 1e-4;
  EXPECT_NEAR(ssim(grid([&](int, int) { return a; }), grid([&](int, int) { return b; })),
              (2 * a * b + c1) / (a * a + b * b + c1), 1e-9);
}

TEST(Ssim, ANegativePictureIsWorseThanAnotherBrightness) {
  const auto waves = [](int x, int y) { return 0.5 + 0.3 * std::sin(x * 0.8) * std::cos(y * 0.7); };
  const Grid a = grid(waves);
  EXPECT_LT(ssim(a, grid([&](int x, int y) { return 1 - waves(x, y); })), 0);
  EXPECT_GT(ssim(a, grid([&](int x, int y) { return waves(x, y) + 0.05; })), 0.95);
}

TEST(Ssim, IsTheWindowedFormulaAtOnePixel) {
  const Grid a = grid([](int x, int y) { return 0.5 + 0.4 * std::sin(0.3 * x * y); });
  const Grid b = grid([](int x, int y) { return 0.45 + 0.4 * std::sin(0.31 * x * y); });
  double w = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
  for (int dy = -5; dy <= 5; ++dy)
    for (int dx = -5; dx <= 5; ++dx) {
      const double g = std::exp(-(dx * dx + dy * dy) / 4.5), p = a.at(16 + dx, 14 + dy),
                   q = b.at(16 + dx, 14 + dy);
      w += g, ma += g * p, mb += g * q, aa += g * p * p, bb += g * q * q, ab += g * p * q;
    }
  ma /= w, mb /= w;
  const double va = aa / w - ma * ma, vb = bb / w - mb * mb, cov = ab / w - ma * mb;
  EXPECT_NEAR(ssim_map(a, b).at(16, 14),
              (2 * ma * mb + 1e-4) * (2 * cov + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4)),
              1e-12);
}

TEST(Ssim, PicturesSmallerThanTheWindowHaveAValue) {
  const Grid a = grid([](int x, int) { return x * 0.2; }, 4, 3);
  EXPECT_NEAR(ssim(a, a), 1, 1e-12);
  EXPECT_EQ(ssim(Grid(), Grid()), 1);
}

}  // namespace
}  // namespace frustum
