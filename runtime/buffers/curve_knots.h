// Curves over knots from what a graph says: points, weights, a degree and a kind of knots.
#pragma once

#include "runtime/buffers/curve.h"

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace frustum {

enum class KnotKind : std::uint8_t {
  clamped,  // 0 (degree + 1 times), 1, 2 ... and the last as often: the curve begins and ends at its points
  uniform,  // 0, 1, 2 ...: it does not
  closed,   // uniform, and the first `degree` points once more at the end
  given
};
constexpr auto choices(KnotKind) {
  return std::array{std::pair{KnotKind::clamped, "clamped"}, std::pair{KnotKind::uniform, "uniform"},
                    std::pair{KnotKind::closed, "closed"}, std::pair{KnotKind::given, "given"}};
}

// What is wrong with given knots whatever the points are, as NodeError at the parameter knot_values: knots
// that fall, are beyond 1e150, repeat more than degree times inside the curve or degree + 1 times at its
// ends, or leave no domain.
void check_knots(KnotKind kind, std::span<const double> given, std::size_t degree);

// A curve of a degree >= 1 over knots that pass check_knots. Throws NodeError, at the parameters points,
// knot_values and weights, where there are too few points, and where knots or weights are not as many as
// the points ask for.
Curve spline_curve(std::vector<glm::dvec3> points, std::vector<double> weights, std::size_t degree,
                   KnotKind kind, std::span<const double> given);

}  // namespace frustum
