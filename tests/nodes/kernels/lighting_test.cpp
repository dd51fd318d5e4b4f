// Light on surfaces: closed forms of Lambert, Phong and Blinn, and the vector kernels against their scalar twins.
#include "nodes/kernels/lighting.h"
#include "nodes/kernels/simd/lighting.h"
#include "nodes/kernels/vector.h"
#include "runtime/buffers/image.h"
#include "tests/support/tiles.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

namespace frustum {
namespace {

using kernels::Highlight;
using kernels::Triple;

kernels::LightSetup<double> one_light(const kernels::LightSource<double>& light, Highlight h, double e) {
  return {{&light, 1}, {0, 0, 10}, h, kernels::Exponent<double>(e)};
}

const kernels::LightSource<double> head_light{false, {1, 1, 1}, {0, 0, 1}, {}};

TEST(Lighting, AHeadLitSphereHasAMeanOfTwoThirdsOverItsDisc) {
  const auto setup = one_light(head_light, Highlight::none, 1);
  double sum = 0, count = 0;
  const int n = 1000;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = (2 * i + 1.0) / n - 1, y = (2 * j + 1.0) / n - 1, zz = 1 - x * x - y * y;
      if (zz < 0) continue;
      sum += kernels::receive(setup, {3 * x, 3 * y, 3 * std::sqrt(zz)}, {x, y, std::sqrt(zz)})
                 .diffuse[0];  // any length
      ++count;
    }
  EXPECT_NEAR(sum / count, 2.0 / 3,
              1e-4);  // 2 pi n / 2 pixels of the rim count wholly or not: some n^-3/2 of the disc
}

TEST(Lighting, PhongPeaksWhereTheEyeIsInTheMirrorDirection) {
  const Triple<double> p{0, 0, 0};
  const kernels::LightSource<double> light{false, {0.5, 1, 2}, {0.6, 0, 0.8}, {}};
  kernels::LightSetup<double> s{{&light, 1}, {-6, 0, 8}, Highlight::phong, kernels::Exponent<double>(60)};
  const auto peak = kernels::receive(s, {0, 0, 1}, p);
  EXPECT_NEAR(peak.specular[0], 0.5, 1e-13);
  EXPECT_NEAR(peak.specular[2], 2, 1e-13);
  EXPECT_NEAR(peak.diffuse[1], 0.8, 1e-15);
  for (const double off : {-0.5, 0.5}) {
    s.eye = {-6 + off, 0, 8};
    EXPECT_LT(kernels::receive(s, {0, 0, 1}, p).specular[1], 0.99);
  }
}

TEST(Lighting, BlinnPeaksWhereTheNormalIsHalfWay) {
  const kernels::LightSource<double> light{false, {1, 1, 1}, {0.6, 0, 0.8}, {}};
  kernels::LightSetup<double> s{{&light, 1}, {0, 0, 10}, Highlight::blinn, kernels::Exponent<double>(200)};
  const Triple<double> h = kernels::unit3<double>({0.6, 0, 1.8});
  EXPECT_NEAR(kernels::receive(s, h, {0, 0, 0}).specular[0], 1, 1e-13);
  // H.V, the printed form (errata E35), would not fall when the normal turns away from H.
  EXPECT_LT(kernels::receive(s, {0, 0.3, 1}, {0, 0, 0}).specular[0], 0.2);
}

TEST(Lighting, TheIntegralOfThePhongLobeIsItsClosedForm) {
  // Over the hemisphere around r = n (light along n): integral of cos^e = 2 pi / (e + 1).
  for (const double e : {1.0, 8.0, 60.0, 33.5}) {
    kernels::LightSetup<double> s{{&head_light, 1}, {}, Highlight::phong, kernels::Exponent<double>(e)};
    double sum = 0;
    const int n = 4000;
    for (int i = 0; i < n; ++i) {
      const double z = (i + 0.5) / n, r = std::sqrt(1 - z * z);
      s.eye = {r, 0, z};
      sum += kernels::receive(s, {0, 0, 1}, {0, 0, 0}).specular[0] / n;
    }
    EXPECT_NEAR(sum * (e + 1), 1, 1e-4) << e;  // midpoint rule: (e + 1) e / (24 n^2)
  }
}

TEST(Lighting, NothingIsLitFromBehindAndNothingIsEverNegative) {
  test::Random random(3);
  for (const Highlight h : {Highlight::none, Highlight::phong, Highlight::blinn})
    for (int i = 0; i < 5000; ++i) {
      const auto v = [&] {
        return Triple<double>{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      };
      const Triple<double> l = kernels::unit3(v()), n = v();
      const kernels::LightSource<double> light{false, {1, 1, 1}, l, {}};
      kernels::LightSetup<double> s{{&light, 1}, v(), h, kernels::Exponent<double>(random.uniform(0, 90))};
      const auto r = kernels::receive(s, n, v());
      const bool behind = kernels::dot3(n, l) <= 0;
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_GE(r.diffuse[k], 0);
        EXPECT_GE(r.specular[k], 0);
        EXPECT_LE(r.specular[k], 1);
        if (behind) {
          EXPECT_EQ(r.diffuse[k] + r.specular[k], 0);
        }
      }
    }
}

TEST(Lighting, ChannelsDoNotMix) {
  for (std::size_t k = 0; k < 3; ++k) {
    kernels::LightSource<double> light = head_light;
    light.color = {0.3, 0.6, 0.9};
    const auto all = kernels::receive(one_light(light, Highlight::blinn, 20), {0.2, 0.1, 1}, {0, 0, 0});
    light.color[k] = 0;
    const auto less = kernels::receive(one_light(light, Highlight::blinn, 20), {0.2, 0.1, 1}, {0, 0, 0});
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(less.diffuse[c], c == k ? 0 : all.diffuse[c]);
  }
}

TEST(Lighting, PointLightsFallOffWithTheSquareOfDistance) {
  const kernels::LightSource<double> light{true, {12, 12, 12}, {0, 0, 2}, {0, 0, 1}};
  const auto s = one_light(light, Highlight::none, 1);
  EXPECT_DOUBLE_EQ(kernels::receive(s, {0, 0, 1}, {0, 0, 0}).diffuse[0], 3);
  EXPECT_DOUBLE_EQ(kernels::receive(s, {0, 0, 1}, {0, 0, -2}).diffuse[0], 0.75);
  EXPECT_EQ(kernels::receive(s, {0, 0, 1}, {0, 0, 2}).diffuse[0], 0) << "on the light itself";
}

TEST(Lighting, ASpotFadesLikeTheSquareOfARampInTheCosine) {
  constexpr double inner = 0.3, outer = 0.7;
  const kernels::Cone cone(inner, outer);
  const kernels::LightSource<double> light{true,  {1, 1, 1},  {0, 0, 1},  {1, 0, 0},  true,
                                           false, {0, 0, -1}, cone.scale, cone.offset};
  // Points on the plane z = 0 at an angle from the axis; their normals look at the light.
  const auto at = [&](double angle) {
    const double x = std::tan(angle);
    return kernels::receive(one_light(light, Highlight::none, 1), {-x, 0, 1}, {x, 0, 0}).diffuse[0];
  };
  EXPECT_DOUBLE_EQ(at(0), 1);
  EXPECT_NEAR(at(inner), 1, 1e-12);
  for (const double angle : {0.4, 0.5, 0.6}) {
    const double ramp = (std::cos(angle) - std::cos(outer)) / (std::cos(inner) - std::cos(outer));
    EXPECT_NEAR(at(angle), ramp * ramp, 1e-12) << angle;
    EXPECT_NEAR(at(-angle), ramp * ramp, 1e-12) << angle;
  }
  EXPECT_NEAR(at(outer), 0, 1e-24);
  EXPECT_EQ(at(0.9), 0);
  EXPECT_EQ(kernels::receive(one_light(light, Highlight::none, 1), {0, 0, -1}, {0, 0, 2}).diffuse[0], 0)
      << "behind the light";
}

TEST(Lighting, AConeWithoutAFadeHasAnEdgeThatRoundingDoesNotMove) {
  const kernels::Cone cone(0.5, 0.5);
  EXPECT_EQ(cone.scale, 4096);
  EXPECT_NEAR(std::cos(0.5) * cone.scale + cone.offset, 0, 1e-9);
}

TEST(Lighting, DegenerateVectorsGiveNoLightAndNoNan) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   inf = std::numeric_limits<double>::infinity();
  for (const Highlight h : {Highlight::phong, Highlight::blinn})
    for (const Triple<double>& n : {Triple<double>{0, 0, 0}, {nan, 0, 1}, {inf, 0, 1}, {1e-200, 0, 0}}) {
      const auto r = kernels::receive(one_light(head_light, h, 5), n, {0, 0, 0});
      EXPECT_EQ(r.diffuse[0] + r.specular[0], 0);
    }
  // The eye opposite to the light: h has no length.
  kernels::LightSetup<double> s{{&head_light, 1}, {0, 0, -5}, Highlight::blinn, kernels::Exponent<double>(5)};
  EXPECT_EQ(kernels::receive(s, {0, 0, 1}, {0, 0, 0}).specular[0], 0);
}

TEST(Lighting, PowersBySquaringMeetTheirBound) {
  for (const double e : {0.0, 1.0, 2.0, 60.0, 1023.0, 1024.0})
    for (const float x : {0.0F, 0.5F, 0.99F, 0.9999F, 1.0F}) {
      const double exact = std::pow(static_cast<double>(x), e);
      EXPECT_NEAR(kernels::Exponent<float>(e)(x), exact, exact * (e + 1) * 0x1p-23 + 0x1p-149)
          << x << "^" << e;
    }
  EXPECT_EQ(kernels::Exponent<float>(0.5).whole, -1);
  EXPECT_EQ(kernels::Exponent<float>(0.5)(0.25F), 0.5F);
  EXPECT_EQ(kernels::Exponent<float>(1e5)(0.9F), 0);
}

// What reaches a point of each light scales all that light, and 1 changes no bit.
TEST(Lighting, LightIsScaledByWhatOfItReachesThePoint) {
  const kernels::LightSource<double> lights[] = {{false, {1, 2, 3}, {0.6, 0, 0.8}, {}},
                                                 {true, {3, 2, 1}, {0.5, 1, 2}, {0.1, 0.2, 1}}};
  const Triple<double> n{0.1, 0.2, 1}, p{0.3, 0, 0};
  const auto by = [&](std::span<const kernels::LightSource<double>> some,
                      const std::array<double, 2>& share) {
    const kernels::LightSetup<double> s{some, {1, 2, 3}, Highlight::blinn, kernels::Exponent<double>(9)};
    return kernels::receive(s, n, p, [&](std::size_t i) { return share[i]; });
  };
  const std::span all(lights);
  const auto first = by(all.first(1), {1, 1}), second = by(all.last(1), {1, 1}), some = by(all, {0.25, 0.5});
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(some.diffuse[k], 0.25 * first.diffuse[k] + 0.5 * second.diffuse[k], 1e-15);
    EXPECT_NEAR(some.specular[k], 0.25 * first.specular[k] + 0.5 * second.specular[k], 1e-15);
  }
  const kernels::LightSetup<double> s{all, {1, 2, 3}, Highlight::blinn, kernels::Exponent<double>(9)};
  EXPECT_EQ(by(all, {1, 1}).diffuse, kernels::receive(s, n, p).diffuse);
  EXPECT_EQ(by(all, {0, 0}).diffuse, (Triple<double>{0, 0, 0}));
}

struct RandomRows {
  std::vector<std::vector<float>> row;
  std::vector<std::uint32_t> tag;
  RandomRows(std::size_t rows, std::size_t n, unsigned seed) {
    test::Random random(seed);
    constexpr float odd[] = {0,
                             -0.0F,
                             1e-30F,
                             1e30F,
                             std::numeric_limits<float>::infinity(),
                             std::numeric_limits<float>::quiet_NaN()};
    for (std::size_t r = 0; r < rows; ++r) {
      auto& v = row.emplace_back();
      for (std::size_t i = 0; i < n; ++i)
        v.push_back(random.below(40) == 0 ? odd[random.below(6)] : static_cast<float>(random.uniform(-2, 2)));
    }
    for (std::size_t i = 0; i < n; ++i)
      tag.push_back(random.below(6) == 0 ? no_face : static_cast<std::uint32_t>(random.below(3)));
  }
  std::array<const float*, 3> three(std::size_t at) const {
    return {row[at].data(), row[at + 1].data(), row[at + 2].data()};
  }
};

std::string difference(const std::vector<float>& a, const std::vector<float>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]))
      return "element " + std::to_string(i) + ": " + std::to_string(a[i]) + ", not " + std::to_string(b[i]);
  return "";
}

TEST(LightingSimd, EveryTargetHasTheBitsOfTheScalarTwin) {
  constexpr std::size_t n = 517;
  const RandomRows in(10, n, 9);
  const kernels::LightSource<float> lights[] = {
      {false, {1, 0.5F, 0.2F}, {0.6F, 0, 0.8F}, {}},
      {true, {3, 2, 1}, {0.5F, 1, 2}, {0.1F, 0.2F, 1}},
      {true, {1, 1, 1}, {-1, 0, 0}, {0, 0, 1}},
      {true, {2, 1, 1}, {1, 1, 1}, {1, 0, 0.1F}, true, false, {-0.6F, 0, -0.8F}, 3.0F, -1.5F},
      {true, {4, 3, 1}, {0, 1, 1}, {0, 0, 1}, false, true, {0, -0.6F, -0.8F}}};
  std::vector<float> some(n + 3);
  test::Random random(11);
  for (float& share : some) share = random.below(3) == 0 ? 0.0F : static_cast<float>(random.uniform(0, 1));
  const std::array<const float*, 5> shares{some.data(), nullptr, some.data() + 3, nullptr, some.data() + 1};
  for (const Highlight h : {Highlight::none, Highlight::phong, Highlight::blinn})
    for (const double e : {0.0, 1.0, 60.0, 33.3})
      for (const std::uint32_t wanted : {kernels::nothing_there, 1u})
        for (const bool turned : {false, true}) {
          const kernels::LightSetup<float> setup{lights, {1, 2, 3}, h, kernels::Exponent<float>(e)};
          const kernels::PointRows<float> points{
              in.three(0), in.three(3), turned ? in.row[6].data() : nullptr,
              turned ? std::span<const float* const>(shares) : std::span<const float* const>()};
          const kernels::Selection which{in.tag.data(), wanted};
          std::vector<std::vector<float>> truth(10, std::vector<float>(n, 7)), simd = truth;
          const auto run = [&](auto receive, auto reflect, std::vector<std::vector<float>>& out) {
            const kernels::LightRows<float> light{{out[0].data(), out[1].data(), out[2].data()},
                                                  {out[3].data(), out[4].data(), out[5].data()}};
            receive(setup, points, which, n, light);
            for (std::size_t x = 0; x < n; ++x)
              if (!which.has(x))
                for (std::size_t k = 0; k < 6; ++k) out[k][x] = 0;
            const kernels::SurfaceColors<float> colors{
                {0.1F, 0.2F, 0.3F}, {1, 0.5F, 0.25F}, {0.4F, 0.4F, 0.4F}, {0.7F, 0, 1e-3F}};
            reflect(colors, light, turned ? std::array<const float*, 3>{} : in.three(7),
                    e == 1 ? some.data() : nullptr, which, turned, n,
                    kernels::ColorRows<float>{{out[6].data(), out[7].data(), out[8].data(), out[9].data()}});
          };
          run([](auto&&... a) { kernels::receive_light<float>(a...); },
              [](auto&&... a) { kernels::reflect_light<float>(a...); }, truth);
          test::for_each_simd_target([&](const char* target) {
            run([](auto&&... a) { kernels::simd::receive_light(a...); },
                [](auto&&... a) { kernels::simd::reflect_light(a...); }, simd);
            for (std::size_t k = 0; k < 10; ++k)
              ASSERT_EQ(difference(simd[k], truth[k]), "") << target << " row " << k;
          });
        }
}

// By hand: 0.5 (0.25 (0.5 0.25 + 0.5) + 1 0.5 + 0) with alpha 0.25.
TEST(Lighting, OpacityScalesColourAndAlphaOfWhatIsSeen) {
  const float light = 0.5F, shine = 0.5F, albedo = 0.25F, opacity = 0.25F;
  for (const bool seen : {true, false}) {
    const std::uint32_t tag = seen ? 3 : kernels::nothing_there;
    std::array<float, 4> got{7, 7, 7, 7};
    kernels::reflect_light<float>(
        {{0.25F, 0, 0}, {0.5F, 0, 0}, {1, 1, 1}, {}}, {{&light, &light, &light}, {&shine, &shine, &shine}},
        {&albedo, &albedo, &albedo}, &opacity, {&tag}, false, 1, {{&got[0], &got[1], &got[2], &got[3]}});
    EXPECT_EQ(got, (seen ? std::array{0.25F * (0.25F * 0.5F + 0.5F), 0.125F, 0.125F, 0.25F}
                         : std::array<float, 4>{}));
  }
}

TEST(LightingSimd, NumbersOfFacesAreLookedUpAlikeOnEveryTarget) {
  const std::vector<float> table{0.5F, -1, 2, std::numeric_limits<float>::quiet_NaN()};
  test::Random random(3);
  std::vector<std::uint32_t> id(203);
  for (std::size_t i = 0; i < id.size(); ++i)
    id[i] = random.below(9) != 0 && i > 0 ? id[i - 1]
            : random.below(4) == 0        ? no_face
                                          : static_cast<std::uint32_t>(random.below(6));
  for (const std::size_t n : {std::size_t{1}, std::size_t{16}, std::size_t{37}, id.size()}) {
    std::vector<float> want(n), got(n);
    for (std::size_t i = 0; i < n; ++i) want[i] = id[i] < 4 ? table[id[i]] : 1;
    kernels::numbers_of_faces<float>(table, id.data(), n, got.data());
    EXPECT_EQ(difference(got, want), "");
    test::for_each_simd_target([&](const char* target) {
      std::vector<float> out(n + 1, 7);
      kernels::simd::numbers_of_faces(table, id.data(), n, out.data());
      EXPECT_EQ(out.back(), 7);
      out.pop_back();
      EXPECT_EQ(difference(out, want), "") << target;
    });
  }
}

TEST(LightingSimd, FacesAreTakenAlikeOnEveryTarget) {
  constexpr std::size_t n = 77, samples = 8, planes = 5;
  test::Random random(4);
  std::vector<std::uint32_t> ids(samples * n);
  for (auto& id : ids) id = random.below(4) == 0 ? no_face : static_cast<std::uint32_t>(random.below(3));
  const RandomRows in(samples * planes, n, 5);
  std::vector<const float*> rows;
  for (const auto& r : in.row) rows.push_back(r.data());
  using Taken = std::vector<std::pair<std::vector<std::uint32_t>, std::vector<std::vector<float>>>>;
  const auto all_of = [&](auto take) {
    Taken all;
    auto left = ids;
    std::vector<std::uint32_t> face(n);
    for (;;) {
      std::vector<std::vector<float>> mean(planes, std::vector<float>(n, 0));
      std::vector<float*> to;
      for (auto& m : mean) to.push_back(m.data());
      if (!take(left.data(), rows, face.data(), to)) break;
      for (std::size_t x = 0; x < n; ++x)
        if (face[x] == no_face)
          for (auto& m : mean) m[x] = 0;
      all.emplace_back(face, mean);
    }
    return all;
  };
  const Taken truth = all_of([&](auto* left, auto& from, auto* face, auto& to) {
    return kernels::take_face<float>(left, samples, n, 0, n, from, face, to);
  });
  EXPECT_EQ(truth.size(), 3u);
  test::for_each_simd_target([&](const char* target) {
    const Taken simd = all_of([&](auto* left, auto& from, auto* face, auto& to) {
      return kernels::simd::take_face(left, samples, n, from, face, to);
    });
    ASSERT_EQ(simd.size(), truth.size()) << target;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_EQ(simd[i].first, truth[i].first) << target;
      for (std::size_t p = 0; p < planes; ++p)
        EXPECT_EQ(difference(simd[i].second[p], truth[i].second[p]), "") << target;
    }
  });
}

}  // namespace
}  // namespace frustum
