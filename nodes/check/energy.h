// How much of the light that falls on a surface its highlight sends back.
#pragma once

#include "nodes/kernels/elementary.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace frustum::energy {

enum class Lobe : std::uint8_t { phong, blinn };

/// Points in (0, 1) and weights that integrate polynomials of degree 2 n - 1 exactly. Newton on Legendre's recurrence;
/// within 4 u. Source: Golub & Welsch 1969 has the theory, Press et al. section 4.6 the iteration.
struct Gauss {
  std::vector<double> at, weight;
  explicit Gauss(std::size_t n) : at(n), weight(n) {
    for (std::size_t i = 0; i < n; ++i) {
      double x =
          kernels::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (static_cast<double>(n) + 0.5));
      double slope = 1;
      for (int step = 0; step < 8; ++step) {
        double p = 1, before = 0;
        for (std::size_t k = 1; k <= n; ++k) {
          const double older = before, d = static_cast<double>(k);
          before = p, p = ((2 * d - 1) * x * before - (d - 1) * older) / d;
        }
        slope = static_cast<double>(n) * (x * p - before) / (x * x - 1);
        x -= p / slope;
      }
      at[i] = (x + 1) / 2, weight[i] = 1 / ((1 - x * x) * slope * slope);
    }
  }
};

/// The share of light from the angle `theta` (from the normal, < pi / 2) that a highlight of strength 1 sends back into the
/// hemisphere: (1 / (pi cos theta)) times the integral of lobe(v) cos(v) over directions v above the surface,
/// since colours here are radiance over irradiance / pi of light that falls straight on.
///   lobe      phong: (r.v)^e about the mirrored light; blinn: (n.h)^e, with dv = 4 (h.v) dh
///   order     points of Gauss in the lobe's angle; 8 times as many around its axis
/// It grows without bound towards theta = pi / 2: the lobes have no cosine that the division could cancel.
/// Error at order 64, theta <= 80 degrees: 1e-4 of the result (the horizon cuts the lobe; without it 1e-12).
inline double highlight_share(Lobe lobe, double exponent, double theta, const Gauss& gauss) {
  const double cosine = kernels::cos(theta), sine = kernels::sin(theta);
  const std::size_t around = 8 * gauss.at.size();
  double sum = 0;
  // u = x^c with c (e + 1) = 32 at most: the power u^e du = c x^(c (e + 1) - 1) dx is as flat at 0 as a polynomial, and no
  // steeper at 1 than the points there can follow.
  const double c_power = std::fmin(1, 32 / (exponent + 1)), flatness = c_power * (exponent + 1) - 1;
  for (std::size_t i = 0; i < gauss.at.size(); ++i) {
    const double x = gauss.at[i], u = kernels::pow(x, c_power), w = std::sqrt(std::fmax(0, 1 - u * u));
    double ring = 0;
    for (std::size_t j = 0; j < around; ++j) {
      const double c =
          kernels::cos(2 * std::numbers::pi * (static_cast<double>(j) + 0.5) / static_cast<double>(around));
      if (lobe == Lobe::phong) {
        ring += std::fmax(0, u * cosine + w * c * sine);
      } else {
        const double h_l = u * cosine + w * c * sine;  // h = (w c, w s, u), l = (sine, 0, cosine)
        ring += std::fmax(0, 2 * h_l * u - cosine) * 4 * std::fmax(0, h_l);
      }
    }
    sum += gauss.weight[i] * c_power * kernels::pow(x, flatness) * ring;
  }
  const double measure = 2 * std::numbers::pi / static_cast<double>(around);
  return sum * measure / (std::numbers::pi * cosine);
}

}  // namespace frustum::energy
