#pragma once
// Where the samples of a pixel lie, in units of 2^-12 px from its top left corner.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "nodes/kernels/random.h"

namespace frustum::kernels {

enum class PatternKind : std::uint8_t { grid, jittered, sobol, standard };

// The grid closest to square that has exactly n cells: `columns` is the least divisor of n not below sqrt(n).
// A prime n gives one row.
struct GridShape {
  int columns, rows;
};
constexpr GridShape grid_shape(int n) {
  int rows = 1;
  for (int r = 1; r * r <= n; ++r)
    if (n % r == 0) rows = r;
  return {n / rows, rows};
}

// Pixels after which the pattern repeats, in x and y; the grid and the standard are the same in every pixel.
constexpr int pattern_period(PatternKind kind) {
  return kind == PatternKind::grid || kind == PatternKind::standard ? 1 : 64;
}

// Whether the graphics interfaces agree on places for that many samples.
constexpr bool has_standard_samples(int n) { return n == 1 || n == 2 || n == 4 || n == 8 || n == 16; }

// Their standard places in 1/16 px from the top left corner, y down, in their order: those for n samples
// start at n - 1. Source: Vulkan 1.3, "Multisampling", standardSampleLocations; Direct3D 11.3, 19.2.4. OpenGL
// leaves them to the implementation, and y runs up there.
inline constexpr std::array<std::array<std::uint8_t, 2>, 31> standard_samples{
    {{8, 8},                                                                               //
     {12, 12}, {4, 4},                                                                     //
     {6, 2},   {14, 6}, {2, 10}, {10, 14},                                                 //
     {9, 5},   {7, 11}, {13, 9}, {5, 3},   {3, 13}, {1, 7},   {11, 15}, {15, 1},           //
     {9, 9},   {7, 5},  {5, 10}, {12, 7},  {3, 6},  {10, 13}, {13, 11}, {11, 3}, {6, 14},  //
     {8, 1},   {4, 2},  {2, 12}, {0, 8},   {15, 4}, {14, 15}, {1, 0}}};

namespace pattern_detail {

constexpr std::uint32_t reverse_bits(std::uint32_t v) {
  v = (v >> 1 & 0x55555555U) | (v & 0x55555555U) << 1;
  v = (v >> 2 & 0x33333333U) | (v & 0x33333333U) << 2;
  v = (v >> 4 & 0x0f0f0f0fU) | (v & 0x0f0f0f0fU) << 4;
  v = (v >> 8 & 0x00ff00ffU) | (v & 0x00ff00ffU) << 8;
  return v >> 16 | v << 16;
}

// The first two dimensions of Sobol's sequence, as binary fractions of 32 bits. The second's direction
// numbers are Pascal's triangle modulo 2: each is the one before it, exclusive-or itself shifted by one.
constexpr std::array<std::uint32_t, 2> sobol(std::uint32_t index) {
  std::uint32_t y = 0, direction = 1U << 31;
  for (std::uint32_t i = index; i != 0; i >>= 1) {
    if ((i & 1) != 0) y ^= direction;
    direction ^= direction >> 1;
  }
  return {reverse_bits(index), y};
}

// Flips each binary digit by a hash of the seed and the digits above it: a nested uniform scrambling.
// Whatever the hash does, strata map to strata.
// Source: Owen 1995; the hash of Laine & Karras 2011 with the constants of Burley 2020, JCGT 9(4).
constexpr std::uint32_t owen_scrambled(std::uint32_t fraction, std::uint32_t seed) {
  std::uint32_t v = reverse_bits(fraction);
  v ^= v * 0x3d20adeaU;
  v += seed;
  v *= seed >> 16 | 1;
  v ^= v * 0x05526c56U;
  v ^= v * 0x53a22864U;
  return reverse_bits(v);
}

}  // namespace pattern_detail

// Fills the n = x.size() = y.size() sample offsets of pixel (px, py), each in [0, 4096).
//
//   grid      cell centres of grid_shape(n), row by row, rounded to 2^-12 px
//   jittered  one uniform point in each of those cells
//   standard  standard_samples; requires has_standard_samples(n)
//   sobol     the first n points of Sobol's (0,2)-sequence, scrambled by pixel: for n = 2^k each dyadic
//             rectangle of area 2^-k holds exactly one
//
// No two samples of a pixel coincide for n <= 4096 (grid, jittered: for up to 4096 columns).
inline void fill_sample_offsets(PatternKind kind, std::uint64_t seed, int px, int py,
                                std::span<std::uint16_t> x, std::span<std::uint16_t> y) {
  constexpr Dimension dimension("sample_pattern");
  const auto n = static_cast<std::uint32_t>(x.size());
  const auto [columns, rows] = grid_shape(static_cast<int>(n));
  const auto centre = [](std::uint32_t cell, std::uint32_t cells) {
    return static_cast<std::uint16_t>(((2 * cell + 1) * 4096 + cells) / (2 * cells));
  };
  // A point of the cell's whole number of 2^-12 px steps.
  const auto inside = [](std::uint32_t cell, std::uint32_t cells, std::uint32_t random) {
    const std::uint32_t first = cell * 4096 / cells, end = (cell + 1) * 4096 / cells;
    return static_cast<std::uint16_t>(first + (std::uint64_t{end - first} * random >> 32));
  };
  const auto scramble = random_bits(seed, px, py, 0, dimension);
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto c = static_cast<std::uint32_t>(columns), r = static_cast<std::uint32_t>(rows);
    if (kind == PatternKind::grid) {
      x[i] = centre(i % c, c), y[i] = centre(i / c, r);
    } else if (kind == PatternKind::standard) {
      const auto& place = standard_samples[n - 1 + i];
      x[i] = static_cast<std::uint16_t>(place[0] * 256), y[i] = static_cast<std::uint16_t>(place[1] * 256);
    } else if (kind == PatternKind::jittered) {
      const auto random = random_bits(seed, px, py, i, dimension);
      x[i] = inside(i % c, c, random[0]), y[i] = inside(i / c, r, random[1]);
    } else {
      const auto [u, v] = pattern_detail::sobol(i);
      x[i] = static_cast<std::uint16_t>(pattern_detail::owen_scrambled(u, scramble[0]) >> 20);
      y[i] = static_cast<std::uint16_t>(pattern_detail::owen_scrambled(v, scramble[1]) >> 20);
    }
  }
}

}  // namespace frustum::kernels
