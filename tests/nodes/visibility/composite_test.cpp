#include "nodes/visibility/composite.h"

#include "nodes/visibility.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/pattern.h"
#include "tests/support/simd_targets.h"
#include "tests/support/tiles.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

using test::Random;

Ref<SamplePattern> pattern_of(int samples, int layers = 1) {
  SamplePattern p{samples * layers, 1, {}, {}};
  for (int l = 0; l < layers; ++l)
    for (int s = 0; s < samples; ++s) {
      p.x.push_back(static_cast<std::uint16_t>(s * 4096 / samples));
      p.y.push_back(static_cast<std::uint16_t>((s * 7 % samples) * 4096 / samples));
    }
  return std::make_shared<const SamplePattern>(std::move(p));
}

// Premultiplied layers: value(layer, sample, x, y) gives red, green, blue, alpha.
template <class R, class Value>
Ref<Image> picture(int size, int samples, int layers, Value&& value) {
  Frame f{.window = {0, 0, size, size}, .pattern = pattern_of(samples, layers)};
  for (const char* name : {"R", "G", "B", "A"}) f.planes.push_back({name, plane_kind_of<R>});
  f.alpha = Alpha::premultiplied;
  Raster r(f);
  for (int l = 0; l < layers; ++l)
    for (int s = 0; s < samples; ++s)
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          const auto rgba = value(l, s, x, y);
          for (int c = 0; c < 4; ++c)
            r.view().row<R>(c, l * samples + s, y)[x] = rgba[static_cast<std::size_t>(c)];
        }
  return std::make_shared<const Image>(Image{std::move(r)});
}

test::PixelRun run_of(const Ref<Image>& image, int samples, Precision precision = Precision::single) {
  return test::PixelRun(nodes::visibility_composite(), "{}",
                        {{"image", {image}}, {"pattern", {Buffer(pattern_of(samples))}}}, precision);
}

// The picture from the back to the front, to = top + (1 - alpha) to, in more digits than any precision has here.
template <class R>
std::array<long double, 4> from_the_back(const Raster& r, int layers, int sample, int samples, int x, int y) {
  std::array<long double, 4> to{};
  for (int l = layers; l-- > 0;) {
    const int k = l * samples + sample;
    const long double through = 1 - static_cast<long double>(r.at<R>(3, k, x, y));
    for (int c = 0; c < 4; ++c)
      to[static_cast<std::size_t>(c)] =
          static_cast<long double>(r.at<R>(c, k, x, y)) + through * to[static_cast<std::size_t>(c)];
  }
  return to;
}

template <class R>
void expect_the_chain(Precision precision, int layers, double most_alpha) {
  Random random(static_cast<std::uint64_t>(layers));
  const auto image = picture<R>(9, 2, layers, [&](int, int, int, int) {
    // Alphas of 0 and 1 among the others.
    const std::uint64_t kind = random.below(12);
    const R a = kind == 0                   ? R(0)
                : kind == 1 && layers < 100 ? R(1)
                                            : static_cast<R>(random.uniform(0, most_alpha));
    const auto shade = [&] { return a * static_cast<R>(random.uniform(0, 2)); };
    return std::array<R, 4>{shade(), shade(), shade(), a};
  });
  const Raster got = run_of(image, 2, precision).whole();
  EXPECT_EQ(got.frame().samples(), 2);
  // Half an ulp of the result, and for binary64, which has no digits to spare, 2 n + 1 roundings more.
  const long double unit = std::numeric_limits<R>::epsilon();
  const long double bound =
      sizeof(R) == 4 ? unit * 0.5001L : unit * (0.5L + static_cast<long double>(layers));
  for (int s = 0; s < 2; ++s)
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 9; ++x) {
        const auto exact = from_the_back<R>(image->raster, layers, s, 2, x, y);
        for (int c = 0; c < 4; ++c) {
          const auto want = exact[static_cast<std::size_t>(c)];
          ASSERT_LE(std::abs(static_cast<long double>(got.at<R>(c, s, x, y)) - want), bound * want) << layers;
        }
      }
}

TEST(VisibilityComposite, IsTheChainOfOverToHalfAnUlp) {
  for (const int layers : {2, 3, 16, 64}) {
    expect_the_chain<float>(Precision::single, layers, 1);
    expect_the_chain<double>(Precision::real_double, layers, 1);
  }
  expect_the_chain<float>(Precision::single, 1000, 2e-3);
}

TEST(VisibilityComposite, TwoHalvesOverAThirdByHand) {
  // Red 0.5 over green 0.5 over opaque blue: 0.5, 0.25, 0.25.
  const std::array<std::array<float, 4>, 3> layer{{{0.5F, 0, 0, 0.5F}, {0, 0.5F, 0, 0.5F}, {0, 0, 1, 1}}};
  const auto image =
      picture<float>(1, 1, 3, [&](int l, int, int, int) { return layer[static_cast<std::size_t>(l)]; });
  const Raster got = run_of(image, 1).whole();
  const float want[4] = {0.5F, 0.25F, 0.25F, 1};
  for (int c = 0; c < 4; ++c) EXPECT_EQ(got.at<float>(c, 0, 0, 0), want[c]);
}

TEST(VisibilityComposite, AnOpaqueLayerEndsTheListAndKeepsItsBits) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const auto image = picture<float>(37, 1, 3, [&](int l, int, int x, int) {
    const auto v = static_cast<float>(x) / 7;
    return l == 0 ? std::array{v, v / 3, v * v, 1.0F} : std::array{nan, nan, nan, nan};
  });
  const Raster got = run_of(image, 1).whole();
  for (int x = 0; x < 37; ++x)
    for (int c = 0; c < 4; ++c) ASSERT_EQ(got.at<float>(c, 0, x, 5), image->raster.at<float>(c, 0, x, 5));
}

TEST(VisibilityComposite, LayersOfAlphaZeroChangeNoBit) {
  Random random(4);
  std::array<float, 4> shown{};
  for (float& v : shown) v = static_cast<float>(random.uniform(0, 1));
  const auto image =
      picture<float>(3, 1, 5, [&](int l, int, int, int) { return l == 2 ? shown : std::array<float, 4>{}; });
  const Raster got = run_of(image, 1).whole();
  for (int c = 0; c < 4; ++c) EXPECT_EQ(got.at<float>(c, 0, 1, 1), shown[static_cast<std::size_t>(c)]);
}

TEST(VisibilityComposite, OneLayerIsPassedOn) {
  Random random(4);
  const auto image = picture<float>(11, 4, 1, [&](int, int, int, int) {
    return std::array<float, 4>{static_cast<float>(random.uniform()), 0.25F, 1e-42F,
                                static_cast<float>(random.uniform())};
  });
  EXPECT_EQ(test::first_difference(run_of(image, 4).whole(), image->raster), "");
}

TEST(VisibilityComposite, PatternsThatAreNotRepeatedAreRefused) {
  const auto image = picture<float>(2, 4, 3, [](int, int, int, int) { return std::array<float, 4>{}; });
  for (const int samples : {5, 2, 1}) {
    try {
      run_of(image, samples);
      ADD_FAILURE() << samples << " samples are not those of the layers";
    } catch (const NodeError& e) {
      EXPECT_EQ(e.code, "wrong_pattern");
    }
  }
}

TEST(VisibilityComposite, KeepsTheLawOfTiles) {
  Random random(8);
  const auto image = picture<float>(43, 2, 5, [&](int, int, int, int) {
    const auto a = static_cast<float>(random.below(3)) / 2;
    return std::array<float, 4>{a / 3, a / 2, a, a};
  });
  EXPECT_EQ(test::break_of_tile_law(run_of(image, 2)), "");
}

class CompositeSimd : public test::EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, CompositeSimd, test::every_target(), test::target_name);

TEST_P(CompositeSimd, HasTheBytesOfItsTwin) {
  Random random(6);
  for (const std::size_t n : {1U, 2U, 3U, 7U, 8U, 15U, 16U, 64U, 99U})
    for (const int layers : {1, 2, 6}) {
      std::array<std::vector<float>, 4> in, want, got;
      kernels::LayerRows<float> rows{.first = {}, .stride = {}, .layers = layers};
      std::array<float*, 4> to_want{}, to_got{};
      for (std::size_t c = 0; c < 4; ++c) {
        const std::size_t stride = n + c;
        for (std::size_t i = 0; i < stride * static_cast<std::size_t>(layers); ++i)
          in[c].push_back(random.below(5) == 0 ? static_cast<float>(random.below(2))
                                               : static_cast<float>(random.uniform(0, 1)));
        want[c].assign(n, 7), got[c].assign(n, 7);
        rows.first[c] = in[c].data(), rows.stride[c] = static_cast<std::ptrdiff_t>(stride);
        if (c == 1 && n == 3) continue;  // nobody reads green
        to_want[c] = want[c].data(), to_got[c] = got[c].data();
      }
      kernels::composite_layers<float>(rows, n, to_want);
      kernels::simd::composite_layers(rows, n, to_got);
      EXPECT_EQ(got, want) << n << " samples of " << layers << " layers";
    }
}

// A pixel's colour does not depend on what else is in its row, NaN and infinity behind what is opaque included.
TEST_P(CompositeSimd, LooksAtNothingBehindWhatIsOpaque) {
  constexpr std::size_t n = 37;
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> layers(2 * n, 0.25F), alpha(2 * n, 0.5F), got(n);
  for (std::size_t x = 0; x < n; x += 3) alpha[x] = 1, layers[n + x] = nan, alpha[n + x] = nan;
  const float* color = layers.data();
  const kernels::LayerRows<float> rows{{color, color, color, alpha.data()}, {n, n, n, n}, 2};
  kernels::simd::composite_layers(rows, n, {got.data(), nullptr, nullptr, nullptr});
  for (std::size_t x = 0; x < n; ++x) EXPECT_EQ(got[x], x % 3 == 0 ? 0.25F : 0.375F) << x;
}

}  // namespace
}  // namespace frustum
