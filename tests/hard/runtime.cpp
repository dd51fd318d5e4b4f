// The runtime: what holds across all stages.
#include "nodes/kernels/elementary.h"
#include "nodes/kernels/fill_triangles.h"
#include "nodes/kernels/lighting.h"
#include "nodes/kernels/stencil.h"
#include "nodes/kernels/sum.h"
#include "nodes/kernels/texture_lookup.h"
#include "nodes/project/viewport.h"
#include "runtime/core/digest.h"
#include "runtime/core/error.h"
#include "runtime/core/float_environment.h"
#include "runtime/core/raster.h"
#include "tests/hard/exact.h"
#include "tests/hard/screen.h"
#include "tests/hard/stages.h"
#include "tests/hard/threads.h"

#include <tbb/parallel_for.h>
#include <xmmintrin.h>
#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace frustum::hard {
namespace {

#ifdef __FAST_MATH__
#error "fast-math makes every exact method here void"
#endif

constexpr float infinity = std::numeric_limits<float>::infinity(),
                nan = std::numeric_limits<float>::quiet_NaN();

void one_rounding_an_operation(Trial& t) {
  for (std::size_t n = t.samples(50000, 5000000); n-- > 0;) {
    glm::vec3 a, b;
    for (int k = 0; k < 3; ++k) {
      a[k] = static_cast<float>(t.random.uniform(-1, 1));
      b[k] = static_cast<float>(t.random.uniform(-1, 1));
    }
    // Products of floats are exact in double, and the sum of two floats rounds to the same float through it.
    const auto product = [](float x, float y) { return static_cast<float>(static_cast<double>(x) * y); };
    const auto sum = [](float x, float y) { return static_cast<float>(static_cast<double>(x) + y); };
    const float want = sum(sum(product(a.x, b.x), product(a.y, b.y)), product(a.z, b.z));
    const float contracted = std::fma(a.z, b.z, std::fma(a.y, b.y, a.x * b.x));
    t.tally(contracted != want, kernels::dot(a, b) != want, {a.x, a.y, a.z, b.x, b.y, b.z});
  }
}

void leaking_environment(Trial& t) {
  const unsigned before = _mm_getcsr();
  // What a ray tracer and an interval kernel leave behind: flushed subnormals, rounding upwards.
  const auto library = [] { _mm_setcsr(_mm_getcsr() | 0x8040u | 0x4000u); };
  const auto broken = [] {
    volatile float small = 1e-38F, tenth = 0.1F, one = 1, three = 3;
    const float product = small * tenth, third = one / three;
    return product == 0 || third != 0x1.555556p-2F;
  };
  const auto on_this_thread = [&](double id) {
    library();
    const bool naive_broken = broken();
    _mm_setcsr(before);
    {
      const FloatEnvironment node;
      library();
    }
    const bool after_node = broken();
    library();
    bool inside = false;
    {
      const FloatEnvironment next_node;
      inside = broken();
    }
    _mm_setcsr(before);
    t.tally(naive_broken, after_node || inside, {id});
  };
  on_this_thread(0);
  t.require(((_mm_getcsr() ^ before) & 0xffc0u) == 0, "the environment is what it was");
  std::vector<double> work(20000, 1.1);
  const auto tile = [&] {
    double sum = 0;
    for (const double x : work) sum += x * x;
    keep(sum);
  };
  t.price(tile, [&] {
    const FloatEnvironment environment;
    tile();
  });
}

void sizes_that_wrap(Trial& t) {
  const auto refuses = [](int width, int height, int planes, int samples) {
    Frame frame{.window = {0, 0, width, height}};
    for (int p = 0; p < planes; ++p) frame.planes.push_back({"p" + std::to_string(p), PlaneKind::f32});
    if (samples > 1) {
      auto pattern = std::make_shared<SamplePattern>();
      pattern->samples = samples;
      frame.pattern = pattern;
    }
    try {
      const Raster raster(frame);
      return raster.bytes();
    } catch (const WorldError&) {
      return std::size_t{0};
    }
  };
  for (const auto& [w, h, planes, samples] :
       {std::array{65536, 65536, 4, 1}, std::array{65536, 65536, 4, 64}, std::array{1 << 30, 1 << 30, 4, 16},
        std::array{2000000000, 2000000000, 1, 4}, std::array{1 << 30, 1 << 30, 1, 16},
        std::array{2147483632, 2147483632, 4, 1}, std::array{1 << 30, 1 << 30, 16, 4}}) {
    const auto wide = static_cast<unsigned __int128>(w) * static_cast<unsigned>(h) *
                      static_cast<unsigned>(planes) * static_cast<unsigned>(samples) * 4;
    const auto textbook = static_cast<std::uint32_t>(w) * static_cast<std::uint32_t>(h) *
                          static_cast<std::uint32_t>(planes * samples) * 4u;
    const std::size_t got = refuses(w, h, planes, samples);
    t.tally(textbook < wide, got != 0 && got < wide, {static_cast<double>(w), static_cast<double>(h)});
  }
}

void any_number_of_threads(Trial& t) {
  std::vector<float> values(100000);
  for (float& v : values) v = static_cast<float>(t.random.magnitude(-10, 10));
  const auto in_shares = [&](int threads) {  // the textbook: a share a thread
    const std::size_t share =
        (values.size() + static_cast<std::size_t>(threads) - 1) / static_cast<std::size_t>(threads);
    float sum = 0;
    for (std::size_t begin = 0; begin < values.size(); begin += share) {
      float part = 0;
      for (std::size_t i = begin; i < std::min(begin + share, values.size()); ++i) part += values[i];
      sum += part;
    }
    return sum;
  };
  const auto in_a_tree = [&](int threads) {
    std::vector<float> leaf((values.size() + 63) / 64);
    on_threads(threads, [&] {
      tbb::parallel_for(std::size_t{0}, leaf.size(), [&](std::size_t i) {
        leaf[i] = kernels::pairwise_sum<float>(
            std::span(values).subspan(i * 64, std::min<std::size_t>(64, values.size() - i * 64)));
      });
    });
    return kernels::tree_reduce(
        std::size_t{0}, leaf.size(), [&](std::size_t i) { return leaf[i]; },
        [](float a, float b) { return a + b; });
  };
  ScreenTriangles mesh;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const auto corner = [&] {
      return glm::vec4(static_cast<float>(t.random.uniform(-20, 148)),
                       static_cast<float>(t.random.uniform(-20, 148)),
                       static_cast<float>(t.random.uniform(0, 1)), 1);
    };
    mesh.add(corner(), corner(), corner(), i);
  }
  const float naive_first = in_shares(1), first = in_a_tree(1);
  const Picture picture = filled(mesh.mesh(), 128, 128);
  for (const int threads : {2, 3, 5, 7, 16}) {
    Picture again;
    on_threads(threads, [&] { again = filled(mesh.mesh(), 128, 128); });
    const bool same = again.id == picture.id && std::equal(again.z.begin(), again.z.end(), picture.z.begin());
    t.tally(in_shares(threads) != naive_first, in_a_tree(threads) != first || !same,
            {static_cast<double>(threads)});
  }
  t.price([&] { keep(in_shares(1)); }, [&] { keep(kernels::pairwise_sum<float>(values)); });
}

void clamps_of_nan(Trial& t) {
  const auto naive_pair = [](float x) { return std::max(x, 1.0F) != std::max(1.0F, x); };
  const auto judge = [&](bool naive_wrong, bool wrong, double id) { t.tally(naive_wrong, wrong, {id}); };
  judge(naive_pair(nan), false, 0);
  judge(std::isnan(glm::clamp(nan, 0.0F, 1.0F)), !(kernels::fold(nan, kernels::EdgeRule::clamp) == 0), 1);
  for (const auto rule : {kernels::EdgeRule::repeat, kernels::EdgeRule::mirror})
    for (const float x : {nan, infinity, -infinity})
      judge(std::isnan(x - std::floor(x)), !(kernels::fold(x, rule) == 0), 2);
  // A highlight's cosine, a level of detail, a code of colour.
  using Triple = kernels::Triple<float>;
  const Triple n{0, 0, 1}, broken{nan, 0, 0};
  for (const auto kind : {kernels::Highlight::phong, kernels::Highlight::blinn})
    judge(std::isnan(glm::clamp(nan, 0.0F, 1.0F)),
          !(kernels::highlight_cosine(kind, n, broken, n, 1.0F) == 0), 3);
  const kernels::TexelLevel level{64, 64, nullptr};
  judge(std::isnan(std::log2(nan)), !(kernels::pyramid_level(nan, 0.0F, 0.0F, 0.0F, level, 6) == 6), 4);
  t.require(
      kernels::largest_component(glm::vec3(nan, 1, 2)) != kernels::largest_component(glm::vec3(1, 2, 3)) &&
          std::isnan(kernels::largest_component(glm::vec3(1, nan, 2))),
      "the largest component takes NaN in wherever it stands");
}

void keys_of_odd_numbers(Trial& t) {
  const std::array<float, 6> values{0.0F, -0.0F,    nan,
                                    1.0F, infinity, std::numeric_limits<float>::denorm_min()};
  const auto key = [](float x) { return Hasher().span(std::span<const float>(&x, 1)).done(); };
  for (const float a : values)
    for (const float b : values) {
      const bool same = std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
      t.tally((a == b) != same, (key(a) == key(b)) != same, {a, b});
    }
  t.require(Hasher().text("ab").text("c").done() != Hasher().text("a").text("bc").done(),
            "texts do not run together");
}

void our_own_elementary(Trial& t) {
  // The textbook reduces an angle by the rounded 2 pi, and takes powers as exp(y log x) in double.
  struct Function {
    double (*ours)(double);
    double (*textbook)(double);
    Real (*exact)(const Real&);
    int lowest, highest;
    bool positive;
  };
  const std::array functions{
      Function{[](double x) { return kernels::sin(x); },
               [](double x) { return std::sin(std::fmod(x, 2 * M_PI)); }, sin, -20, 40, false},
      Function{[](double x) { return kernels::cos(x); },
               [](double x) { return std::cos(std::fmod(x, 2 * M_PI)); }, cos, -20, 40, false},
      Function{[](double x) { return kernels::exp(x); },
               [](double x) { return std::pow(2.718281828459045, x); }, exp, -20, 9, false},
      Function{[](double x) { return kernels::log(x); }, [](double x) { return std::log2(x) * M_LN2; }, log,
               -400, 400, true},
      Function{[](double x) { return kernels::pow(x, 2.4); },
               [](double x) { return std::exp(2.4 * std::log(x)); },
               [](const Real& x) { return pow(x, Real(2.4)); }, -300, 300, true},
      Function{[](double x) { return kernels::acos(x); }, [](double x) { return M_PI / 2 - std::asin(x); },
               acos, -30, 0, false}};
  for (const Function& f : functions)
    for (std::size_t n = t.samples(400, 40000); n-- > 0;) {
      double x = t.random.magnitude(f.lowest, f.highest);
      if (f.positive) x = std::fabs(x);
      const Real want = exact([&] { return f.exact(Real(x)); });
      t.measure(ulps(f.textbook(x), want), ulps(f.ours(x), want), {x});
    }
  std::vector<double> inputs(1000);
  for (double& x : inputs) x = t.random.uniform(-10, 10);
  t.price_over(
      inputs, [](double x) { return std::sin(std::fmod(x, 2 * M_PI)); },
      [](double x) { return kernels::sin(x); });
}

void nothing_and_one(Trial& t) {
  const auto textbook_variance = [](std::span<const double> v) {
    double sum = 0, squares = 0;
    for (const double x : v) sum += x;
    const double mean = sum / static_cast<double>(v.size());
    for (const double x : v) squares += (x - mean) * (x - mean);
    return squares / (static_cast<double>(v.size()) - 1);
  };
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
    const std::vector<double> values(n, 3.5);
    kernels::Moments m;
    for (const double x : values) m.add(x);
    t.tally(std::isnan(textbook_variance(values)), std::isnan(m.variance()), {static_cast<double>(n)});
    t.require(kernels::pairwise_sum<double>(values) == 3.5 * static_cast<double>(n),
              "sums of nothing and of one", {static_cast<double>(n)});
  }
  // A row of one pixel, by -1 + 2 c / (n - 1).
  t.tally(std::isnan(-1 + 2 * 0.0 / (1.0 - 1.0)),
          kernels::Viewport({1, 1}).ndc_from_px({0.5, 0.5}) != glm::dvec2(0), {1});
  const Picture none = filled({}, 1, 1);
  t.require(none.id[0] == kernels::no_face && none.z[0] == 1, "no triangles");
  std::vector<glm::vec4> no_points;
  std::vector<std::uint8_t> flags;
  t.require(project::clip_to_screen<float>(true, kernels::Viewport({1, 1}), no_points, no_points, flags) == 0,
            "no points");
  kernels::Stencils rows;
  rows.end_row();
  const std::vector<float> in{1};
  std::vector<float> out{7};
  kernels::apply_affine<float>(rows, in, out);
  t.require(out[0] == 0, "a row of no weights");
  const kernels::LightSetup<float> dark{};
  const auto light = kernels::receive(dark, kernels::Triple<float>{0, 0, 1}, kernels::Triple<float>{});
  t.require(light.diffuse[0] == 0 && light.specular[0] == 0, "no lights");
}

}  // namespace

std::vector<HardCase> runtime() {
  return {
      {"SYS-01", "50000 products of vectors, in this build", "a b + c contracted to one rounding",
       "kernels::dot, as compiled", "each operation rounded on its own",
       "one rounding an operation, as the flags promise", "products that differ", 0,
       one_rounding_an_operation},
      {"SYS-02", "FTZ, DAZ and upward rounding left by a library; then 1e-38 * 0.1 and 1 / 3",
       "trust every library", "FloatEnvironment around every node", "the control register",
       "the environment of each node is the usual one, and restored", "nodes computing wrongly", 0,
       leaking_environment},
      {"SYS-04", "rasters of 65536 x 65536 x 4 up to 2^31 x 2^31 x 4",
       "width * height * planes * 4 in 32 bits", "Raster", "128-bit integers",
       "an error or enough bytes, never a small raster", "sizes that wrapped", 0, sizes_that_wrap},
      {"SYS-05", "100000 numbers and 300 triangles on 2 to 16 threads", "a share a thread",
       "kernels::pairwise_sum, tree_reduce; fill", "comparison of bits",
       "the same bits for any number of threads", "sums that differ", 0, any_number_of_threads},
      {"SYS-06", "NaN and infinities into every clamp", "std::max, glm::clamp",
       "fold, highlight_cosine, pyramid_level, largest_component", "truth table",
       "a stated result, whatever the order of the operands", "NaN let through", 0, clamps_of_nan},
      {"SYS-07", "0, -0, NaN, 1, infinity, the least subnormal as keys", "compare with ==", "Hasher",
       "comparison of bits", "the same bits hit, others miss", "wrong hits and misses", 0,
       keys_of_odd_numbers},
      {"SYS-08", "sin, cos, exp, log, pow, acos over their ranges",
       "fmod by 2 pi; exp(y log x); log2(x) ln 2", "kernels/elementary", "MPFR", "within 1 ulp", "ulp", 1,
       our_own_elementary},
      {"SYS-10", "no values, one value, one pixel, no triangles, no lights", "divide by n - 1",
       "sums, viewport, fill, stencils, lighting", "truth table", "a defined result, never NaN",
       "NaN results", 0, nothing_and_one},
  };
}

}  // namespace frustum::hard
