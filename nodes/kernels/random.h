#pragma once
// Random numbers as a pure function of where they are used: no state, so any order of pixels, tiles and
// threads draws the same ones.
// Source: Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3", SC11; Philox4x32-10 passes all
// of TestU01's BigCrush.

#include <array>
#include <concepts>
#include <cstdint>
#include <glm/vec2.hpp>
#include <string_view>

namespace frustum::kernels {

using Random4 = std::array<std::uint32_t, 4>;

// Philox4x32 with 10 rounds: a bijection of the counter for each key.
constexpr Random4 philox(Random4 counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53} * counter[0];
    const std::uint64_t p1 = std::uint64_t{0xCD9E8D57} * counter[2];
    counter = {static_cast<std::uint32_t>(p1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(p1),
               static_cast<std::uint32_t>(p0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key[0] += 0x9E3779B9;
    key[1] += 0xBB67AE85;
  }
  return counter;
}

// What a random number is for: "lens", "light", "jitter". FNV-1a of the name; fold a bounce or light number
// in with `at`.
class Dimension {
 public:
  constexpr explicit Dimension(std::string_view name) {
    for (const char c : name) value_ = (value_ ^ static_cast<std::uint8_t>(c)) * 16777619U;
  }
  constexpr Dimension at(std::uint32_t index) const {
    Dimension d = *this;
    d.value_ = (d.value_ ^ index * 0x85EBCA6BU) * 16777619U;
    return d;
  }
  constexpr std::uint32_t value() const { return value_; }

 private:
  std::uint32_t value_ = 2166136261U;
};

// Four independent words for one sample of one pixel.
constexpr Random4 random_bits(std::uint64_t seed, int x, int y, std::uint32_t sample, Dimension dimension) {
  return philox({static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), sample, dimension.value()},
                {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
}

// Uniform in [0, 1): a multiple of 2^-24 (float) or 2^-53 (double), so never rounded up to 1.
template <std::floating_point R>
constexpr R uniform_from(std::uint32_t high, std::uint32_t low) {
  if constexpr (sizeof(R) == 4)
    return static_cast<R>(high >> 8) * R(0x1p-24);
  else
    return static_cast<R>((std::uint64_t{high} << 32 | low) >> 11) * R(0x1p-53);
}

template <std::floating_point R>
constexpr R random_uniform(std::uint64_t seed, int x, int y, std::uint32_t sample, Dimension dimension) {
  const auto bits = random_bits(seed, x, y, sample, dimension);
  return uniform_from<R>(bits[0], bits[1]);
}

// A point of the unit square.
template <std::floating_point R>
constexpr glm::vec<2, R> random_uniform2(std::uint64_t seed, int x, int y, std::uint32_t sample,
                                         Dimension dimension) {
  const auto bits = random_bits(seed, x, y, sample, dimension);
  return {uniform_from<R>(bits[0], bits[1]), uniform_from<R>(bits[2], bits[3])};
}

}  // namespace frustum::kernels
