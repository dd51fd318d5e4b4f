// Values of one Bezier curve by the method of your choice: de Casteljau's algorithm, the Bernstein sum, the
// matrix form, Volk and Schumaker's, and de Casteljau's in twice the digits. They are the same polynomial;
// what differs is rounding and cost.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

#include "nodes/kernels/bezier.h"

namespace frustum::bezier {

enum class Method : std::uint8_t { matrix, volk_schumaker, bernstein, casteljau, compensated };
constexpr auto choices(Method) {
  return std::array{std::pair{Method::matrix, "matrix"}, std::pair{Method::volk_schumaker, "volk_schumaker"},
                    std::pair{Method::bernstein, "bernstein"}, std::pair{Method::casteljau, "casteljau"},
                    std::pair{Method::compensated, "compensated"}};
}

// Above this degree the binomials of the matrix form and of Volk and Schumaker's leave the range of single
// precision.
inline constexpr std::size_t highest_binomial_degree = 100;

template <class R>
using Point = glm::vec<3, R>;

// The point at t of the curve of `p`. The end points come out bit for bit by casteljau, bernstein and
// compensated, and in [0, 1] casteljau and compensated stay in the points' box. Costs and errors, n the
// degree, u max|P| the unit: casteljau O(n^2), 2 n; bernstein O(n), 4 n; volk_schumaker O(n), 4 n, grows
// beyond [0, 1]; matrix O(n) a value, up to 3^n; compensated O(n^2), 1 and far below what plain arithmetic
// can tell.
template <class R>
class Evaluator {
 public:
  Evaluator(std::span<const glm::dvec3> points, Method method) : method_(method) {
    for (const glm::dvec3& p : points) points_.emplace_back(p);
    if (method == Method::matrix) power_ = kernels::power_of_bezier(std::span<const Point<R>>(points_));
  }

  Point<R> at(double parameter) {
    const R t = static_cast<R>(parameter);
    const std::span<const Point<R>> p(points_);
    switch (method_) {
      case Method::matrix: return kernels::horner(std::span<const Point<R>>(power_), t);
      case Method::volk_schumaker: return kernels::volk_schumaker(p, t);
      case Method::bernstein: return by_basis(t);
      case Method::casteljau: break;
      case Method::compensated: return compensated(t);
    }
    scratch_ = points_;
    return kernels::casteljau(std::span(scratch_), t);
  }

 private:
  // What has no weight does not count, so that an end is its point even where another one is not finite.
  Point<R> by_basis(R t) const {
    const std::vector<R> b = kernels::bernstein(points_.size() - 1, t);
    Point<R> sum(0);
    for (std::size_t i = 0; i < b.size(); ++i)
      if (b[i] != 0) sum += points_[i] * b[i];
    return sum;
  }
  Point<R> compensated(R t) {
    Point<R> out;
    line_.resize(points_.size());
    for (glm::length_t k = 0; k < 3; ++k) {
      R low = points_[0][k], high = low;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        line_[i] = points_[i][k];
        low = std::min(low, line_[i]), high = std::max(high, line_[i]);
      }
      out[k] = kernels::casteljau_compensated(std::span<const R>(line_), t);
      if (t >= 0 && t <= 1) out[k] = kernels::between_ends(out[k], low, high);
    }
    return out;
  }

  Method method_;
  std::vector<Point<R>> points_, power_, scratch_;
  std::vector<R> line_;
};

}  // namespace frustum::bezier
