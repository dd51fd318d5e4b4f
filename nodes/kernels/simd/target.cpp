#include "nodes/kernels/simd/target.h"

#include <hwy/targets.h>

namespace frustum::kernels {
namespace {

std::int64_t mask_of(Simd target) {
  switch (target) {
    case Simd::sse4: return HWY_SSE4;
    case Simd::avx2: return HWY_AVX2;
    case Simd::avx512: return HWY_AVX3;
  }
  return 0;
}

void choose(std::int64_t mask) {
  hwy::SetSupportedTargetsForTest(mask);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace

bool use_simd(Simd target) {
  hwy::SetSupportedTargetsForTest(0);
  if ((hwy::SupportedTargets() & mask_of(target)) == 0) return false;
  choose(mask_of(target));
  return true;
}

void use_best_simd() { choose(0); }

std::string_view simd_in_use() {
  const std::int64_t targets = hwy::SupportedTargets();
  return hwy::TargetName(targets & -targets);  // a smaller bit is a better target
}

}  // namespace frustum::kernels
