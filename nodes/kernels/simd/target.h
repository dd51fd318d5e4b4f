// Which vector instructions the kernels may use: a testing aid, since the bytes must not depend on it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

namespace frustum::kernels {

enum class Simd : std::uint8_t { sse4, avx2, avx512 };
constexpr auto choices(Simd) {
  return std::array{std::pair{Simd::sse4, "sse4"}, std::pair{Simd::avx2, "avx2"},
                    std::pair{Simd::avx512, "avx512"}};
}
constexpr std::string_view name_of(Simd s) { return choices(s)[static_cast<std::size_t>(s)].second; }

// Makes every kernel of this process use exactly this target from its next call on. False, and nothing
// changed, where the processor lacks it. Not while a run is going on.
bool use_simd(Simd target);

// Back to the best target of the processor.
void use_best_simd();

// The name of the target that the kernels use now: "AVX3", "AVX2", "SSE4", "SSSE3", "SCALAR".
std::string_view simd_in_use();

}  // namespace frustum::kernels
