// Four corners that a graph gives as points, as a map between the unit square and the screen.
#pragma once

#include "nodes/kernels/quad_map.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"

#include <array>
#include <utility>

namespace frustum {

namespace kernels {
constexpr auto choices(QuadMapKind) {
  return std::array{std::pair{QuadMapKind::projective, "projective"},
                    std::pair{QuadMapKind::bilinear, "bilinear"}};
}
}  // namespace kernels

// The map to the corners, which go through the matrix first, if there is one, and are divided by w (x, y in
// pixels, y down). Throws NodeError at the input "corners": "wrong_count" (four are wanted), "not_finite",
// "behind_the_eye" (w <= 0), and "not_convex" where they are not the corners of a convex quadrilateral, as
// when a plane is seen edge-on.
kernels::QuadMap quad_map(const Points& corners, const Matrix* screen_from_corners,
                          kernels::QuadMapKind kind);

}  // namespace frustum
