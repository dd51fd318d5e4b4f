#pragma once
// In what the clip spaces of the APIs differ: the depths that the near and the far plane get, and where y points.
// x, w and the planes to the sides are the same in all.

#include <cstdint>

namespace frustum::kernels {

// NDC depth from the near plane to the far plane.
enum class DepthRange : std::uint8_t { minus_one_to_one, zero_to_one, one_to_zero };

constexpr double near_depth(DepthRange r) {
  return r == DepthRange::minus_one_to_one ? -1 : r == DepthRange::zero_to_one ? 0 : 1;
}
constexpr double far_depth(DepthRange r) { return r == DepthRange::one_to_zero ? 0 : 1; }
// The lower end of the range; the upper one is 1 in all.
constexpr double least_depth(DepthRange r) { return r == DepthRange::minus_one_to_one ? -1 : 0; }
// Whether the greater depth is the nearer one.
constexpr bool is_reversed(DepthRange r) { return r == DepthRange::one_to_zero; }

struct ClipSpace {
  DepthRange depth = DepthRange::minus_one_to_one;
  bool y_down = false;
};

}  // namespace frustum::kernels
