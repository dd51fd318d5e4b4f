#include "runtime/app/metrics/delta_e.h"

#include <cmath>
#include <numbers>

namespace frustum {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr glm::dvec3 white{0.95047, 1.0, 1.08883};

double square(double v) { return v * v; }

// sqrt(c^7 / (c^7 + 25^7)).
double chroma_weight(double c) {
  const double c7 = std::pow(c, 7), k7 = std::pow(25.0, 7);
  return std::sqrt(c7 / (c7 + k7));
}

double hue_deg(double a, double b) {
  if (a == 0 && b == 0) return 0;
  const double h = std::atan2(b, a) / degree;
  return h < 0 ? h + 360 : h;
}

// The hue from h1 to h2 the shorter way round, and the hue in the middle of it; c is the product of the
// chromas.
struct Hues {
  double difference_deg, mean_deg;
};
Hues hues(double h1, double h2, double c) {
  if (c == 0) return {0, h1 + h2};  // the hue of grey is 0: the sum is the other one
  const double d = h2 - h1;
  if (std::abs(d) <= 180) return {d, (h1 + h2) / 2};
  return {d > 180 ? d - 360 : d + 360, (h1 + h2 + (h1 + h2 < 360 ? 360 : -360)) / 2};
}

}  // namespace

glm::dvec3 xyz_of_rec709(const glm::dvec3& c) {
  return {0.4124564 * c.r + 0.3575761 * c.g + 0.1804375 * c.b,
          0.2126729 * c.r + 0.7151522 * c.g + 0.0721750 * c.b,
          0.0193339 * c.r + 0.1191920 * c.g + 0.9503041 * c.b};
}

glm::dvec3 rec709_of_xyz(const glm::dvec3& v) {
  return {3.2404542 * v.x - 1.5371385 * v.y - 0.4985314 * v.z,
          -0.9692660 * v.x + 1.8760108 * v.y + 0.0415560 * v.z,
          0.0556434 * v.x - 0.2040259 * v.y + 1.0572252 * v.z};
}

glm::dvec3 lab_of_xyz(const glm::dvec3& xyz) {
  constexpr double delta = 6.0 / 29;
  const auto f = [](double t) {
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
  };
  const double x = f(xyz.x / white.x), y = f(xyz.y / white.y), z = f(xyz.z / white.z);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double delta_e_2000(const glm::dvec3& lab1, const glm::dvec3& lab2) {
  const double mean_c = (std::hypot(lab1.y, lab1.z) + std::hypot(lab2.y, lab2.z)) / 2;
  const double g = 0.5 * (1 - chroma_weight(mean_c));
  const double a1 = (1 + g) * lab1.y, a2 = (1 + g) * lab2.y;
  const double c1 = std::hypot(a1, lab1.z), c2 = std::hypot(a2, lab2.z);
  const Hues h = hues(hue_deg(a1, lab1.z), hue_deg(a2, lab2.z), c1 * c2);

  const double dl = lab2.x - lab1.x, dc = c2 - c1;
  const double dh = 2 * std::sqrt(c1 * c2) * std::sin(h.difference_deg / 2 * degree);
  const double l = (lab1.x + lab2.x) / 2, c = (c1 + c2) / 2;
  const double t = 1 - 0.17 * std::cos((h.mean_deg - 30) * degree) +
                   0.24 * std::cos(2 * h.mean_deg * degree) + 0.32 * std::cos((3 * h.mean_deg + 6) * degree) -
                   0.20 * std::cos((4 * h.mean_deg - 63) * degree);
  const double rotation_deg = 30 * std::exp(-square((h.mean_deg - 275) / 25));
  const double sl = 1 + 0.015 * square(l - 50) / std::sqrt(20 + square(l - 50));
  const double sc = 1 + 0.045 * c, sh = 1 + 0.015 * c * t;
  const double rt = -std::sin(2 * rotation_deg * degree) * 2 * chroma_weight(c);
  return std::sqrt(square(dl / sl) + square(dc / sc) + square(dh / sh) + rt * (dc / sc) * (dh / sh));
}

}  // namespace frustum
