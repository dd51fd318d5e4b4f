#include "runtime/app/metrics/flip.h"

#include "nodes/kernels/parallel.h"
#include "runtime/app/metrics/delta_e.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace frustum {
namespace {

using Kernel = std::vector<double>;  // 2 r + 1 weights around the middle

constexpr double qc = 0.7, pc = 0.4, pt = 0.95, qf = 0.5;  // section 4.2 and 4.4 of the paper
constexpr double feature_width_deg = 0.082;
constexpr double square_of_pi() { return std::numbers::pi * std::numbers::pi; }
constexpr glm::dvec3 white{0.95047, 1.0, 1.08883};

// One contrast sensitivity: a1 sqrt(pi/b1) exp(-pi^2 d^2/b1) + the same of a2, b2, with d in degrees.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr Sensitivity luminance{1, 0.0047, 0, 1e-5}, red_green{1, 0.0053, 0, 1e-5},
    blue_yellow{34.1, 0.04, 13.5, 0.025};

template <class F>
Kernel kernel_of(int radius, const F& weight) {
  Kernel k;
  for (int i = -radius; i <= radius; ++i) k.push_back(weight(i));
  return k;
}

double sum(const Kernel& k) {
  double s = 0;
  for (const double w : k) s += w;
  return s;
}

void convolve_row(const Grid& in, const Kernel& kx, int y, double* out) {
  const int r = static_cast<int>(kx.size() / 2);
  const double* row = in.values.data() + in.index(0, y);
  for (int x = 0; x < in.width; ++x) {
    double s = 0;
    for (int i = -r; i <= r; ++i)
      s += kx[static_cast<std::size_t>(i + r)] * row[std::clamp(x + i, 0, in.width - 1)];
    out[x] = s;
  }
}

// The picture filtered by kx along rows and ky along columns.
Grid separable(const Grid& in, const Kernel& kx, const Kernel& ky) {
  Grid rows(in.width, in.height), out(in.width, in.height);
  const auto height = static_cast<std::size_t>(in.height);
  kernels::parallel_blocks(height, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      convolve_row(in, kx, static_cast<int>(y), rows.values.data() + rows.index(0, static_cast<int>(y)));
  });
  const int r = static_cast<int>(ky.size() / 2);
  kernels::parallel_blocks(height, 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int i = -r; i <= r; ++i) {
        const double w = ky[static_cast<std::size_t>(i + r)];
        const double* from = rows.values.data() + rows.index(0, std::clamp(y + i, 0, in.height - 1));
        double* to = out.values.data() + out.index(0, y);
        for (int x = 0; x < in.width; ++x) to[x] += w * from[x];
      }
  });
  return out;
}

// The sum of the two Gaussians of a sensitivity, scaled so that all its weights over the square add up to 1.
Grid sensitivity_filtered(const Grid& in, const Sensitivity& s, double ppd) {
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * square_of_pi())) * ppd));
  const auto gaussian = [&](double b) {
    return kernel_of(radius, [&](int i) { return std::exp(-square_of_pi() * (i / ppd) * (i / ppd) / b); });
  };
  const Kernel k1 = gaussian(s.b1), k2 = gaussian(s.b2);
  const double w1 = s.a1 * std::sqrt(std::numbers::pi / s.b1), w2 = s.a2 * std::sqrt(std::numbers::pi / s.b2);
  const double total = w1 * sum(k1) * sum(k1) + w2 * sum(k2) * sum(k2);
  Grid out = separable(in, k1, k1);
  if (s.a2 == 0) {
    for (double& v : out.values) v *= w1 / total;
    return out;
  }
  const Grid second = separable(in, k2, k2);
  for (std::size_t i = 0; i < out.values.size(); ++i)
    out.values[i] = (w1 * out.values[i] + w2 * second.values[i]) / total;
  return out;
}

// The opponent space in which the eye's filters work; its first channel is L* without the curve.
std::array<Grid, 3> opponent(const Picture& p) {
  std::array<Grid, 3> out;
  out.fill(Grid(p.width(), p.height()));
  for (std::size_t i = 0; i < out[0].values.size(); ++i) {
    const glm::dvec3 rgb{p.rgb[0].values[i], p.rgb[1].values[i], p.rgb[2].values[i]};
    const glm::dvec3 v = xyz_of_rec709({std::clamp(rgb.r, 0.0, 1.0), std::clamp(rgb.g, 0.0, 1.0),
                                        std::clamp(rgb.b, 0.0, 1.0)}) /
                         white;
    out[0].values[i] = 116 * v.y - 16, out[1].values[i] = 500 * (v.x - v.y),
    out[2].values[i] = 200 * (v.y - v.z);
  }
  return out;
}

// L*a*b* whose chroma fades with lightness: colours of dark places are seen less (the Hunt effect).
glm::dvec3 hunt_lab(const glm::dvec3& linear) {
  const glm::dvec3 lab = lab_of_xyz(xyz_of_rec709(linear));
  return {lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z};
}

double hyab(const glm::dvec3& a, const glm::dvec3& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

std::vector<glm::dvec3> seen_colors(const std::array<Grid, 3>& ycc, double ppd) {
  const Grid y = sensitivity_filtered(ycc[0], luminance, ppd),
             cx = sensitivity_filtered(ycc[1], red_green, ppd),
             cz = sensitivity_filtered(ycc[2], blue_yellow, ppd);
  std::vector<glm::dvec3> out(y.values.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double v = (y.values[i] + 16) / 116;
    const glm::dvec3 xyz = glm::dvec3{v + cx.values[i] / 500, v, v - cz.values[i] / 200} * white;
    const glm::dvec3 rgb = rec709_of_xyz(xyz);
    out[i] =
        hunt_lab({std::clamp(rgb.r, 0.0, 1.0), std::clamp(rgb.g, 0.0, 1.0), std::clamp(rgb.b, 0.0, 1.0)});
  }
  return out;
}

// The colour difference mapped to [0, 1]: [0, pc max] to [0, pt], the rest to what is left.
double redistributed(double e, double max) {
  return e < pc * max ? pt / (pc * max) * e : pt + (e - pc * max) / (max - pc * max) * (1 - pt);
}

// Weights of one sign scaled to a sum of 1: a feature detector answers 1 to a step or a dot of full contrast.
Kernel balanced(Kernel k, double positive, double negative) {
  for (double& w : k) w /= w > 0 ? positive : negative;
  return k;
}

// Magnitudes of edges and points; y is luminance in [0, 1].
struct Features {
  Grid edges, points;
};
Features features(const Grid& y, double ppd) {
  const double sd = 0.5 * feature_width_deg * ppd;
  const int radius = static_cast<int>(std::ceil(3 * sd));
  const Kernel g = kernel_of(radius, [&](int i) { return std::exp(-i * i / (2 * sd * sd)); });
  const auto half = [&](const Kernel& k, bool positive) {
    double s = 0;
    for (const double w : k) s += (w > 0) == positive ? std::abs(w) : 0;
    return s * sum(g);
  };
  const auto detector = [&](auto weight) {
    const Kernel k =
        kernel_of(radius, [&](int i) { return weight(i) * g[static_cast<std::size_t>(i + radius)]; });
    const Kernel b = balanced(k, half(k, true), half(k, false));
    const Grid along = separable(y, b, g), across = separable(y, g, b);
    Grid out(y.width, y.height);
    for (std::size_t i = 0; i < out.values.size(); ++i)
      out.values[i] = std::hypot(along.values[i], across.values[i]);
    return out;
  };
  return {detector([](int i) { return -static_cast<double>(i); }),
          detector([&](int i) { return i * i / (sd * sd) - 1; })};
}

Grid lightness(const std::array<Grid, 3>& ycc) {
  Grid out = ycc[0];
  for (double& v : out.values) v = (v + 16) / 116;
  return out;
}

}  // namespace

Grid flip_map(const Picture& reference, const Picture& test, double ppd) {
  const auto a = opponent(reference), b = opponent(test);
  const auto colors_a = seen_colors(a, ppd), colors_b = seen_colors(b, ppd);
  const Features fa = features(lightness(a), ppd), fb = features(lightness(b), ppd);
  const double max = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), qc);
  Grid out(reference.width(), reference.height());
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    const double color = redistributed(std::pow(hyab(colors_a[i], colors_b[i]), qc), max);
    const double edge = std::abs(fa.edges.values[i] - fb.edges.values[i]);
    const double point = std::abs(fa.points.values[i] - fb.points.values[i]);
    const double feature = std::pow(std::max(edge, point) / std::numbers::sqrt2, qf);
    out.values[i] = std::pow(color, 1 - std::min(feature, 1.0));
  }
  return out;
}

}  // namespace frustum
