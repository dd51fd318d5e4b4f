#include "runtime/buffers/quad.h"

#include "runtime/core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace frustum {
namespace {

glm::dvec2 on_screen(const glm::dvec3& p, const Matrix* matrix, std::size_t i) {
  glm::dvec4 h(p, 1);
  if (matrix != nullptr) h = matrix->value * h;
  if (!(std::fabs(h.x) + std::fabs(h.y) + std::fabs(h.w) < std::numeric_limits<double>::infinity()))
    throw NodeError("not_finite", fmt::format("corner {} is not finite", i), at_input("corners"));
  if (h.w <= 0)
    throw NodeError(
        "behind_the_eye",
        fmt::format("corner {} lies behind the eye (w = {:.6g}): the square would have to be clipped", i,
                    h.w),
        at_input("corners"));
  return {h.x / h.w, h.y / h.w};
}

}  // namespace

kernels::QuadMap quad_map(const Points& corners, const Matrix* matrix, kernels::QuadMapKind kind) {
  if (corners.at.size() != 4)
    throw NodeError("wrong_count",
                    fmt::format("a quadrilateral has 4 corners; there are {}", corners.at.size()),
                    at_input("corners"));
  std::array<glm::dvec2, 4> px;
  for (std::size_t i = 0; i < 4; ++i) px[i] = on_screen(corners.at[i], matrix, i);
  const auto map = kernels::QuadMap::of(px, kind);
  if (!map)
    throw NodeError(
        "not_convex",
        "the corners do not go around a convex quadrilateral: its plane is seen edge-on, or sides cross",
        at_input("corners"));
  return *map;
}

}  // namespace frustum
