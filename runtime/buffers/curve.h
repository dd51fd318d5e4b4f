// Smooth curves before they are lines: piecewise polynomials, or quotients of them, over knots.
#pragma once

#include "nodes/kernels/spline.h"
#include "runtime/core/buffer.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frustum {

// A B-spline, which every other basis is exactly, or within the rounding of its control points: a Bezier
// curve has knots of full multiplicity at both ends, a chain of them also (degree) inside, so that pieces
// share their joints bit for bit. Never less than degree + 1 points; knots never fall, number points +
// degree + 1, and are finite; the domain [knots[degree], knots[points]] is not empty; no knot inside it
// repeats more than `degree` times, so that the curve hangs together. A plane curve has z = 0.
struct Curve {
  std::uint32_t degree = 0;
  std::vector<glm::dvec3> points;  // what the curve follows
  std::vector<double> weights;     // one for each point, or none: a polynomial
  std::vector<double> knots;

  kernels::Spline spline() const { return {degree, points, weights, knots}; }
  std::size_t pieces() const { return kernels::spans_of(spline()).size(); }
};

template <>
const BufferType& buffer_type<Curve>();

// Knots of Bezier pieces of a degree that meet at `breaks`, of which there are at least two: each stands
// degree times, the first and the last once more.
std::vector<double> chain_knots(std::size_t degree, std::span<const double> breaks);

// A chain of (points - 1) / degree Bezier pieces over [0, 1], [1, 2] ... Requires whole pieces.
Curve bezier_chain(std::vector<glm::dvec3> points, std::size_t degree);

// Every coordinate rounded to single precision, for curves that are computed in it.
template <class R>
void round_points(std::vector<glm::dvec3>& points) {
  if constexpr (sizeof(R) < sizeof(double))
    for (glm::dvec3& p : points) p = glm::dvec3(glm::vec<3, R>(p));
}

}  // namespace frustum
