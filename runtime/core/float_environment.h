// The floating-point environment that nodes count on, whatever a library leaves behind.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace frustum {

// While it lives, this thread rounds to nearest, keeps subnormal numbers and traps nothing; then the
// environment is what it was before. Libraries such as ray tracers and interval kernels switch on "flush to
// zero" or directed rounding and may leave them on (hard case SYS-02). Cost: some 10 ns.
class FloatEnvironment {
 public:
#if defined(__SSE2__)
  FloatEnvironment() : before_(_mm_getcsr()) { _mm_setcsr(usual); }
  ~FloatEnvironment() { _mm_setcsr(before_); }
#else
  FloatEnvironment() { std::fegetenv(&before_), std::fesetenv(FE_DFL_ENV); }
  ~FloatEnvironment() { std::fesetenv(&before_); }
#endif
  FloatEnvironment(const FloatEnvironment&) = delete;
  FloatEnvironment& operator=(const FloatEnvironment&) = delete;

 private:
#if defined(__SSE2__)
  static constexpr unsigned usual = 0x1f80;  // the value after reset: Intel SDM volume 1, section 10.2.3
  unsigned before_;
#else
  std::fenv_t before_;
#endif
};

}  // namespace frustum
