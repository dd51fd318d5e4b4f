// Sampling and reconstruction.
#include "nodes/kernels/area_coverage.h"
#include "nodes/kernels/filter.h"
#include "nodes/kernels/random.h"
#include "nodes/kernels/resolve.h"
#include "nodes/kernels/sample_pattern.h"
#include "nodes/kernels/simd/resolve.h"
#include "nodes/kernels/sum.h"
#include "tests/hard/exact.h"
#include "tests/hard/stages.h"
#include "tests/hard/threads.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

namespace frustum::hard {
namespace {

template <class T>
double plain_sum(const std::vector<T>& values) {
  T sum = 0;
  for (const T x : values) sum += x;
  return static_cast<double>(sum);
}

double compensated(const std::vector<float>& values) {
  kernels::CompensatedSum<double> sum;
  for (const float x : values) sum.add(static_cast<double>(x));
  return sum.value();
}

void stagnating_sum(Trial& t) {
  const auto judge = [&](float term, std::size_t n) {
    const std::vector<float> values(n, term);
    const Rational want = Rational(term) * Rational(n), unit = want * Rational(u64);
    t.measure(distance(plain_sum(values), want, unit), distance(compensated(values), want, unit),
              {term, static_cast<double>(n)});
  };
  judge(0.1F, 1000000), judge(1, t.samples(17000000, 20000000)), judge(1e-3F, 1000000);
  // A resolve of this many samples streams through memory: what is summed is read anyway.
  const std::vector<float> values(4000000, 0.1F);
  t.price([&] { keep(plain_sum(values)); }, [&] { keep(compensated(values)); });
}

void uniform_below_one(Trial& t) {
  for (std::uint32_t i = 0; i < t.samples(100000, 1000000); ++i) {
    const std::uint32_t top = 0xFFFFFFFFu - i;
    const float textbook = static_cast<float>(top) * 0x1p-32F;
    const double wide_textbook = static_cast<double>(std::uint64_t{top} << 32 | 0xFFFFFFFFu) * 0x1p-64;
    const float single = kernels::uniform_from<float>(top, 0xFFFFFFFFu);
    const double real = kernels::uniform_from<double>(top, 0xFFFFFFFFu);
    t.tally(textbook >= 1 || wide_textbook >= 1, single >= 1 || real >= 1 || single < 0 || real < 0,
            {static_cast<double>(top)});
  }
  std::vector<std::uint32_t> inputs(1000);
  for (auto& x : inputs) x = static_cast<std::uint32_t>(t.random.bits());
  t.price_over(
      inputs, [](std::uint32_t x) { return static_cast<float>(x) * 0x1p-32F; },
      [](std::uint32_t x) { return kernels::uniform_from<float>(x, 0); });
}

void variance_of_a_large_mean(Trial& t) {
  const std::size_t n = 100000;
  std::vector<float> values(n);
  for (float& v : values) v = static_cast<float>(1e4 + t.random.uniform(-0.17, 0.17));
  const auto textbook = [&] {
    float sum = 0, squares = 0;
    for (const float x : values) sum += x, squares += x * x;
    const float mean = sum / static_cast<float>(n);
    return squares / static_cast<float>(n) - mean * mean;
  };
  const auto welford = [&] {
    kernels::Moments m;
    for (const float x : values) m.add(static_cast<double>(x));
    return m;
  };
  const auto merged = [&](std::size_t part) {
    kernels::Moments all;
    for (std::size_t begin = 0; begin < n; begin += part) {
      kernels::Moments m;
      for (std::size_t i = begin; i < std::min(begin + part, n); ++i) m.add(static_cast<double>(values[i]));
      all = all.merged(m);
    }
    return all;
  };
  Rational sum = 0, squares = 0;
  for (const float x : values) sum += Rational(x), squares += Rational(x) * Rational(x);
  const Rational count(n), mean = sum / count, variance = squares / count - mean * mean;
  const double kappa = std::sqrt(1 + mean.get_d() * mean.get_d() / variance.get_d());
  const double bound = static_cast<double>(n) * u64 * kappa;
  const auto error = [&](double got) { return distance(got, variance, variance) / bound; };
  t.measure(
      error(static_cast<double>(textbook())),
      std::max({error(welford().variance()), error(merged(7).variance()), error(merged(4096).variance())}),
      {1e4, 0.1, static_cast<double>(n)});
  t.require(kernels::Moments{}.variance() == 0, "no values have no variance");
  for (const float x : {1e8F, -3.7F}) {
    kernels::Moments m;
    for (int i = 0; i < 1000; ++i) m.add(static_cast<double>(x));
    t.require(m.variance() >= 0 && m.variance() < 1e-9, "equal values have none", {x});
  }
  t.price([&] { keep(textbook()); }, [&] { keep(welford().variance()); });
}

void bartlett_sums_to_one(Trial& t) {
  for (const double radius : {1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 8.0})
    for (std::size_t n = t.samples(60, 6000); n-- > 0;) {
      const bool dyadic = n % 2 == 0;
      const double phase = dyadic ? static_cast<double>(t.random.below(16)) / 16 : t.random.uniform(0, 1);
      const kernels::FilterCurve<float> curve({.kind = kernels::FilterKind::bartlett, .radius = radius});
      std::vector<float> weights(kernels::filter_tap_count(radius)), plain(weights.size());
      const auto first = static_cast<float>(phase - std::ceil(radius));
      kernels::fill_filter_weights<float>(curve, first, weights);
      for (std::size_t i = 0; i < plain.size(); ++i) {
        const auto x = std::fabs(first + static_cast<float>(i));
        plain[i] = x < static_cast<float>(radius)
                       ? (1 - x / static_cast<float>(radius)) / static_cast<float>(radius)
                       : 0;
      }
      // The weights as numbers: their exact sum, not one that is rounded on the way.
      const auto off = [](const std::vector<float>& w) {
        Rational sum = -1;
        for (const float x : w) sum += Rational(x);
        return std::fabs(sum.get_d()) / u32;
      };
      t.measure(off(plain), off(weights), {radius, phase});
    }
  const kernels::FilterCurve<float> curve({.kind = kernels::FilterKind::bartlett, .radius = 3});
  std::vector<float> weights(kernels::filter_tap_count(3));
  // Weights are made once a row of the picture and used along it: 1920 pixels here.
  std::vector<float> row(1926, 0.5F), out(1920);
  const auto use = [&](const std::vector<float>& w) {
    for (std::size_t x = 0; x < out.size(); ++x) {
      float sum = 0;
      for (std::size_t i = 0; i + 1 < w.size(); ++i) sum += w[i] * row[x + i];
      out[x] = sum;
    }
    keep(out[0]);
  };
  t.price(
      [&] {
        for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = curve(static_cast<float>(i) - 3) / 3;
        use(weights);
      },
      [&] {
        kernels::fill_filter_weights<float>(curve, -3, weights);
        use(weights);
      });
}

void sum_in_any_order(Trial& t) {
  const std::size_t n = t.samples(100000, 1000000);
  std::vector<double> values(n);
  for (double& v : values) v = std::exp(t.random.uniform(-5, 20)) * (t.random.below(2) == 0 ? 1 : -1);
  const auto exact_sum = [](const std::vector<double>& v) {
    kernels::ExactSum sum;
    for (const double x : v) sum.add(x);
    return sum.value();
  };
  // Leaves in parallel, combined in a tree whose shape depends on n alone.
  const auto by_threads = [](const std::vector<double>& v, int threads) {
    const std::size_t runs = (v.size() + 63) / 64;
    std::vector<double> leaf(runs);
    on_threads(threads, [&] {
      tbb::parallel_for(std::size_t{0}, runs, [&](std::size_t i) {
        leaf[i] = kernels::pairwise_sum<double>(
            std::span(v).subspan(i * 64, std::min<std::size_t>(64, v.size() - i * 64)));
      });
    });
    return kernels::tree_reduce(
        std::size_t{0}, runs, [&](std::size_t i) { return leaf[i]; },
        [](double a, double b) { return a + b; });
  };
  const double tree = by_threads(values, 1);
  for (const int threads : {2, 3, 7, 16, 64})
    t.require(by_threads(values, threads) == tree, "any number of threads", {static_cast<double>(threads)});
  t.require(kernels::pairwise_sum<double>(values) == tree, "the same tree without threads");
  Rational sum = 0;
  for (const double v : values) sum += Rational(v);
  const Real want = Real(sum);
  for (int round = 0; round < 6; ++round) {
    t.measure(ulps(plain_sum(values), want), ulps(exact_sum(values), want), {static_cast<double>(round)});
    t.require(exact_sum(values) == exact([&] { return Real(sum); }).to_double(),
              "rounded once, in any order");
    for (std::size_t i = n; i-- > 1;) std::swap(values[i], values[t.random.below(i + 1)]);
  }
  t.price([&] { keep(plain_sum(values)); }, [&] { keep(kernels::pairwise_sum<double>(values)); });
}

void coverage_of_equal_samples(Trial& t) {
  for (const int samples : {3, 7, 10, 12, 49}) {
    const auto count = static_cast<std::size_t>(samples);
    std::vector<std::uint16_t> x(count), y(count);
    kernels::fill_sample_offsets(kernels::PatternKind::grid, 1, 0, 0, x, y);
    for (const auto kind : {kernels::FilterKind::box, kernels::FilterKind::bartlett,
                            kernels::FilterKind::mitchell, kernels::FilterKind::gaussian}) {
      const kernels::ResolveWeights<float> weights(
          {.kind = kind, .radius = kind == kernels::FilterKind::box ? 0.5 : 2}, samples, 1, x, y);
      constexpr std::size_t n = 32, stride = 64;
      std::vector<float> in(stride * 9 * count, 1.0F), out(n);
      // Said not to be flat, so that the weights are summed.
      const std::vector<std::uint32_t> flat(n, 0);
      const float* first = in.data() + 4 * stride + 16;
      const std::uint32_t* flat_rows[] = {flat.data()};
      float* out_rows[] = {out.data()};
      const kernels::ResolveRow<float> row{.n = n,
                                           .left = -8,
                                           .right = n + 8,
                                           .top = -4,
                                           .bottom = 5,
                                           .in = {&first, 1},
                                           .sample_stride = stride * 9,
                                           .row_stride = stride,
                                           .flat = flat_rows,
                                           .out = out_rows};
      kernels::simd::resolve_row(weights, row);
      float textbook = 0;
      for (int s = 0; s < samples; ++s) textbook += 1.0F * (1.0F / static_cast<float>(samples));
      for (const float v : out) t.tally(textbook != 1, v != 1, {static_cast<double>(samples)});
    }
  }
  const std::vector<float> values(1000, 0.5F);
  t.price(
      [&] {
        float sum = 0;
        for (const float v : values) sum += v * 0.001F;
        keep(sum);
      },
      [&] {
        float sum = 0;
        for (const float v : values) sum += v;
        keep(sum / 1000);
      });
}

// ----- areas

using glm::dvec2;
constexpr int area_edge = 6;  // px

// The share of pixel (x, y) to the left of the line from `top` to `bottom`, which runs down through all of it.
Rational share_left_of(const dvec2& top, const dvec2& bottom, int x, int y) {
  // Between two rows the line is straight: the integral of clamp(x_line - x, 0, 1), in pieces at 0 and 1.
  const Rational x0 = Rational(top.x), y0 = Rational(top.y);
  const Rational slope = (Rational(bottom.x) - x0) / (Rational(bottom.y) - y0);
  const auto at = [&](const Rational& v) { return Rational(x0 + (v - y0) * slope - x); };
  std::vector<Rational> cuts{Rational(y), Rational(y + 1)};
  if (sgn(slope) != 0)
    for (const int side : {0, 1}) {
      const Rational v = y0 + (x0 * -1 + x + side) / slope;
      if (v > cuts[0] && v < cuts[1]) cuts.push_back(v);
    }
  std::sort(cuts.begin(), cuts.end());
  Rational area = 0;
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    const auto inside = [&](const Rational& v) {
      return Rational(v < 0 ? Rational(0) : v > 1 ? Rational(1) : v);
    };
    area += (cuts[i] - cuts[i - 1]) * (inside(at(cuts[i - 1])) + inside(at(cuts[i]))) / 2;
  }
  return area;
}

std::vector<double> shares_of(std::span<const dvec2> contour) {
  std::vector<kernels::AreaEdge> edges;
  kernels::add_edges(edges, contour);
  std::vector<double> all(area_edge * area_edge, 0.0);
  kernels::AreaSweep sweep(std::move(edges), kernels::FillRule::nonzero, {0, 0, area_edge, area_edge});
  sweep.rows([&](int y, std::span<const double> row) {
    std::copy(row.begin(), row.end(), all.begin() + y * area_edge);
  });
  return all;
}

// 16 x 16 samples of a pixel, those on a border counted in: what is left (-1) or right (1) of the line.
double counted(const dvec2& top, const dvec2& bottom, int x, int y, int side) {
  int n = 0;
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 16; ++i) {
      const double v = y + (j + 0.5) / 16,
                   line = top.x + (v - top.y) * ((bottom.x - top.x) / (bottom.y - top.y));
      n += side * (x + i / 16.0 - line) >= 0;
    }
  return n / 256.0;
}

void abutting_areas(Trial& t) {
  const auto judge = [&](const dvec2& top, const dvec2& bottom) {
    const double end = area_edge;
    const std::array left{dvec2(0, 0), top, bottom, dvec2(0, end)};
    const std::array right{top, dvec2(end, 0), dvec2(end, end), bottom};
    const auto a = shares_of(left), b = shares_of(right);
    for (int y = 0; y < area_edge; ++y)
      for (int x = 0; x < area_edge; ++x) {
        const std::size_t i = static_cast<std::size_t>(y * area_edge + x);
        const double naive = counted(top, bottom, x, y, -1) + counted(top, bottom, x, y, 1);
        t.measure(distance(naive, Rational(1), Rational(u64)),
                  std::fabs(Rational((Rational(a[i]) + Rational(b[i]) - 1) / Rational(u64)).get_d()),
                  {top.x, bottom.x, static_cast<double>(x), static_cast<double>(y)});
        t.require(distance(a[i], share_left_of(top, bottom, x, y), Rational(u64)) <= 16,
                  "the exact area to 16 u",
                  {top.x, bottom.x, static_cast<double>(x), static_cast<double>(y)});
      }
  };
  for (const double x : {1.0, 2.5, 3 - 0x1p-20, 3 + 0x1p-20, 4.0625})
    for (const double lean : {0.0, 0x1p-20, -0.5, 1.0}) judge({x, 0}, {x + lean, area_edge});
  for (std::size_t n = t.samples(100, 5000); n-- > 0;)
    judge({t.random.uniform(0.1, area_edge - 0.1), 0}, {t.random.uniform(0.1, area_edge - 0.1), area_edge});
}

}  // namespace

std::vector<HardCase> sampling() {
  return {
      {"SMP-01", "17000000 times 1, a million times 0.1 and 0.001", "sum in float", "kernels::CompensatedSum",
       "rationals", "relative error <= 2 u64, however many", "u64", 2, stagnating_sum},
      {"SMP-02", "the highest 100000 integers of 32 and 64 bits", "i 2^-32 and i 2^-64",
       "kernels::uniform_from", "comparison", "below 1 always", "numbers that reach 1", 0, uniform_below_one},
      {"SMP-04", "100000 values around 1e4, spread 0.1", "E[x^2] - E[x]^2 in float",
       "kernels::Moments, merged in parts", "rationals", "relative error <= n u64 kappa; never negative",
       "n u64 kappa", 1, variance_of_a_large_mean},
      {"SMP-06", "tents of radius 1 to 8, phases k / 16 and random", "(1 - |x| / r) / r in float",
       "kernels::fill_filter_weights", "rationals", "the weights sum to 1 within 2 u", "u", 2,
       bartlett_sums_to_one},
      {"SMP-07", "100000 numbers of either sign from e^-5 to e^20, shuffled; 1 to 64 threads",
       "sum in the order they come, double", "kernels::ExactSum, pairwise_sum, tree_reduce", "rationals",
       "rounded once in any order; one result for any threads", "ulp", 0.5, sum_in_any_order},
      {"SMP-13", "3 to 49 samples that are all 1, four filters", "sum of 1/N", "kernels::simd::resolve_row",
       "equality", "a full pixel is exactly 1", "pixels that are not", 0, coverage_of_equal_samples},
      {"SMP-14", "an edge at k, k + 1/2, k + 1/16 and k +- 2^-20, upright and leaning; random ones",
       "16 x 16 samples, those on the border inside", "kernels::AreaSweep", "areas in rationals",
       "what two areas with one border cover adds up to 1 within 2 u; each share exact to 16 u", "u", 2,
       abutting_areas},
  };
}

}  // namespace frustum::hard
