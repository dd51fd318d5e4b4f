// Every lane of the highway functions against its scalar twin, bit for bit, on every target of this processor.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/nodes/kernels/elementary_simd_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "nodes/kernels/simd/elementary-inl.h"

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace frustum::HWY_NAMESPACE {
namespace {

enum Function { of_exp2, of_exp, of_log2, of_log, of_pow, functions };

// n is a multiple of 16, the most lanes of any target here.
void apply(int function, const float* x, const float* y, float* out, std::size_t n) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::ScalableTag<float> d;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto a = hn::LoadU(d, x + i), b = hn::LoadU(d, y + i);
    switch (function) {
      case of_exp2: hn::StoreU(exp2(d, a), d, out + i); break;
      case of_exp: hn::StoreU(exp(d, a), d, out + i); break;
      case of_log2: hn::StoreU(log2(d, a), d, out + i); break;
      case of_log: hn::StoreU(log(d, a), d, out + i); break;
      default: hn::StoreU(pow(d, a, b), d, out + i);
    }
  }
}

}  // namespace
}  // namespace frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include "tests/support/ulps.h"

namespace frustum {
HWY_EXPORT(apply);
namespace {

std::vector<float> inputs(std::uint64_t seed, std::size_t n) {
  constexpr float inf = std::numeric_limits<float>::infinity(),
                  none = std::numeric_limits<float>::quiet_NaN();
  const float special[] = {0,        -0.0F, 1,    -1,   2,      -2,      0.5F,    -0.5F,    3,
                           -3,       inf,   -inf, none, 1e-40F, -1e-45F, 0x1p24F, -0x1p25F, 16777216.0F,
                           0x1p120F, 127,   -127, 128,  -149,   -150,    88.7F,   -103.9F,  60};
  test::Random random(seed);
  std::vector<float> x(n);
  for (std::size_t i = 0; i < n; ++i) switch (i % 4) {
      case 0: x[i] = special[random.below(std::size(special))]; break;
      case 1: x[i] = static_cast<float>(random.magnitude(-149, 127)); break;
      case 2: x[i] = static_cast<float>(random.uniform(-100, 100)); break;
      default: x[i] = static_cast<float>(random.uniform(0, 1));
    }
  return x;
}

float twin(int function, float x, float y) {
  switch (function) {
    case 0: return kernels::exp2(x);
    case 1: return kernels::exp(x);
    case 2: return kernels::log2(x);
    case 3: return kernels::log(x);
    default: return kernels::pow(x, y);
  }
}

TEST(ElementarySimd, EveryTargetHasTheBitsOfTheScalarTwin) {
  const std::size_t n = 1 << 16;
  const auto x = inputs(1, n);
  auto y = inputs(2, n);
  test::Random random(3);
  for (std::size_t i = 0; i + 1 < n; ++i) std::swap(y[i], y[i + random.below(n - i)]);
  std::vector<float> out(n);
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    for (int function = 0; function < 5; ++function) {
      HWY_DYNAMIC_DISPATCH(apply)(function, x.data(), y.data(), out.data(), n);
      std::size_t differ = 0;
      for (std::size_t i = 0; i < n; ++i)
        if (std::bit_cast<std::uint32_t>(out[i]) !=
                std::bit_cast<std::uint32_t>(twin(function, x[i], y[i])) &&
            ++differ < 5)
          ADD_FAILURE() << hwy::TargetName(target) << " function " << function << " of " << x[i] << ", "
                        << y[i] << " is " << out[i] << ", not " << twin(function, x[i], y[i]);
      EXPECT_EQ(differ, 0U) << hwy::TargetName(target) << " function " << function;
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace frustum
#endif
