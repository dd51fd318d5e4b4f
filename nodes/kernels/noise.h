// Gradient noise and sums of its octaves, as far as a pixel can tell them apart.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>

namespace frustum::kernels {

/// The published order of 0 to 255. Source: Perlin 2002, Improving Noise, doi:10.1145/566654.566636,
/// reference code.
inline constexpr std::array<std::uint8_t, 256> noise_permutation{
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,
    69,  142, 8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,
    94,  252, 219, 203, 117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136,
    171, 168, 68,  175, 74,  165, 71,  134, 139, 48,  27,  166, 77,  146, 158, 231, 83,  111, 229, 122,
    60,  211, 133, 230, 220, 105, 92,  41,  55,  46,  245, 40,  244, 102, 143, 54,  65,  25,  63,  161,
    1,   216, 80,  73,  209, 76,  132, 187, 208, 89,  18,  169, 200, 196, 135, 130, 116, 188, 159, 86,
    164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250, 124, 123, 5,   202, 38,  147, 118, 126,
    255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,  182, 189, 28,  42,  223, 183, 170, 213,
    119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101, 155, 167, 43,  172, 9,   129, 22,  39,  253,
    19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104, 218, 246, 97,  228, 251, 34,  242, 193,
    238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,
    181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,
    222, 114, 67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180};

namespace noise_detail {

/// 6 t^5 - 15 t^4 + 10 t^3: its first and second derivatives are 0 at both ends.
template <std::floating_point R>
R fade(R t) {
  return t * t * t * (t * (t * R(6) - R(15)) + R(10));
}

/// The product of (x, y, z) with one of the 12 directions to the middles of a cube's edges.
template <std::floating_point R>
R edge_product(unsigned hash, R x, R y, R z) {
  const unsigned h = hash & 15;
  const R u = h < 8 ? x : y, v = h < 4 ? y : (h == 12 || h == 14 ? x : z);
  return ((h & 1) == 0 ? u : -u) + ((h & 2) == 0 ? v : -v);
}

/// A coordinate as its cell, modulo 256, and its place in it; both 0 for what is not finite.
template <std::floating_point R>
struct Cell {
  unsigned index;
  R place;
  explicit Cell(R x) {
    const R low = std::floor(x), folded = low - R(256) * std::floor(low / R(256));
    index = folded >= R(0) && folded < R(256) ? static_cast<unsigned>(folded) : 0U;
    place = x - low;
    place = place >= R(0) ? place : R(0);
  }
};

}  // namespace noise_detail

/// Smooth noise in [-1.04, 1.04], of root mean square 0.27, with a period of 256: 0 where all coordinates are
/// whole, twice continuously differentiable, no direction or place preferred but those of the lattice. In two
/// dimensions take z = 0. Cost: some 20 ns.
template <std::floating_point R>
R gradient_noise(R x, R y, R z) {
  using namespace noise_detail;
  const Cell<R> cx(x), cy(y), cz(z);
  const auto p = [](unsigned i) { return static_cast<unsigned>(noise_permutation[i & 255]); };
  const auto mix = [](R t, R a, R b) { return a + t * (b - a); };
  const R u = fade(cx.place), v = fade(cy.place), w = fade(cz.place);
  const unsigned a = p(cx.index) + cy.index, b = p(cx.index + 1) + cy.index;
  const auto layer = [&](unsigned k) {
    const R dx = cx.place, dy = cy.place, dz = cz.place - static_cast<R>(k);
    const unsigned i = cz.index + k;
    const R front = mix(u, edge_product(p(p(a) + i), dx, dy, dz), edge_product(p(p(b) + i), dx - 1, dy, dz));
    const R back = mix(u, edge_product(p(p(a + 1) + i), dx, dy - 1, dz),
                       edge_product(p(p(b + 1) + i), dx - 1, dy - 1, dz));
    return mix(v, front, back);
  };
  return mix(w, layer(0), layer(1));
}

/// What is left of noise when it is averaged over a pixel `width` units wide: the factor c that makes c
/// noise(middle) closest to that average. Regression finds 0.97, 0.87, 0.58 and 0.32 for widths of 1/4, 1/2,
/// 1 and 3/2; this is within 0.03 of them up to 5/4 and within 0.15 everywhere, and 0 from noise_cutoff on.
inline constexpr double noise_cutoff = 2.1;
template <std::floating_point R>
R octave_share(R width) {
  const R t = width / R(noise_cutoff), left = R(1) - t * t;
  if (!(left > R(0))) return R(0);  // NaN too
  return left * left;
}

/// Octave i has frequency lacunarity^i and height gain^i; divided by the sum of all heights, whatever is
/// faded out.
struct Octaves {
  int count = 6;
  double lacunarity = 2, gain = 0.5;
  bool turbulent = false;  ///< sums |noise|: creases, and a mean above 0
};

/// The mean of |noise| over its period, to 2 digits.
inline constexpr double mean_of_turbulence = 0.22;

/// Octaves of noise at p, those that a pixel `width` units wide does not resolve faded to their mean; the
/// first that is gone ends the sum. In about [-1, 1]; turbulent, in [0, 1].
template <std::floating_point R>
R octave_sum(const Octaves& o, const std::array<R, 3>& p, R width) {
  R sum = 0, heights = 0, frequency = 1, height = 1;
  bool resolved = true;
  const R rest = o.turbulent ? static_cast<R>(mean_of_turbulence) : R(0);
  for (int i = 0; i < o.count; ++i) {
    heights += height;
    const R share = resolved ? octave_share(width * frequency) : R(0);
    resolved = share > R(0);
    if (resolved) {
      const R n = gradient_noise(p[0] * frequency, p[1] * frequency, p[2] * frequency);
      sum += height * (rest + share * ((o.turbulent ? std::abs(n) : n) - rest));
    } else {
      sum += height * rest;
    }
    frequency *= static_cast<R>(o.lacunarity), height *= static_cast<R>(o.gain);
  }
  return sum / heights;
}

/// Places of n points and their change by a pixel; null coordinates are 0. Rows do not overlap.
template <std::floating_point R>
struct PlaceRows {
  std::array<const R*, 3> at{}, by_x{}, by_y{};
  const std::uint32_t* id = nullptr;  ///< 0xFFFFFFFF where nothing is seen

  std::array<R, 3> row(const std::array<const R*, 3>& from, std::size_t i) const {
    const auto value = [&](std::size_t k) { return from[k] == nullptr ? R(0) : from[k][i]; };
    return {value(0), value(1), value(2)};
  }
  bool covers(std::size_t i) const { return id == nullptr || id[i] != 0xFFFFFFFFu; }
};

template <std::floating_point R>
R length_of(const std::array<R, 3>& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

}  // namespace frustum::kernels
