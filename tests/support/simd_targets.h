// Runs a test once for each SIMD target that the library is compiled for.
#pragma once

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <string>

namespace frustum::test {

// Calls are dispatched to the target of the parameter; one that the processor lacks is skipped, visibly.
class EveryTarget : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override {
    if ((hwy::SupportedTargets() & GetParam()) == 0)
      GTEST_SKIP() << "this processor has no " << hwy::TargetName(GetParam());
    hwy::SetSupportedTargetsForTest(GetParam());
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  void TearDown() override {
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

inline auto every_target() { return testing::Values(HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_STATIC_TARGET); }
inline std::string target_name(const testing::TestParamInfo<std::int64_t>& info) {
  std::string name = hwy::TargetName(info.param);
  std::erase_if(name, [](char c) { return c == '-' || c == '.' || c == ' '; });
  return name;
}

}  // namespace frustum::test
