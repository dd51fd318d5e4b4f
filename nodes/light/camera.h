// A camera where a light is, that sees what may cast shadows.
#pragma once

#include "nodes/kernels/camera.h"
#include "nodes/kernels/surface_measures.h"

#include <array>
#include <cstddef>
#include <span>

namespace frustum::light_camera {

struct View {
  glm::dvec3 eye, target, up;
  double near_z, far_z;
  double height;  ///< of a parallel view, world units
  double fov_y;   ///< of a view from a place, radians
};

/// +x -x +y -y +z -z, and what is up then.
inline constexpr std::array<std::array<glm::dvec3, 2>, 6> cube{{{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)},
                                                                {glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0)},
                                                                {glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)},
                                                                {glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1)},
                                                                {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0)},
                                                                {glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0)}}};

/// A vector that is not near `direction`: y, or z where the direction is along y.
inline glm::dvec3 up_beside(const glm::dvec3& direction) {
  return std::fabs(direction.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
}

/// The least box around the finite points in the space of a view.
inline kernels::Box box_in(const kernels::LookAt& view, std::span<const glm::dvec3> p_world) {
  kernels::Box box;
  for (const glm::dvec3& p : p_world)
    if (std::isfinite(kernels::largest_component(p)))
      box.add(view.eye_from_world.linear * p + view.eye_from_world.translation);
  return box;
}

/// A border of one texel, so that the outermost silhouettes lie within the picture.
inline double with_border(double half_size, int texels) { return half_size * texels / (texels - 2.0); }

/// Looks along the unit vector `direction` at all of the points, or at a unit cube where there are none.
inline View parallel_view(const glm::dvec3& direction, std::span<const glm::dvec3> p_world, int texels) {
  const glm::dvec3 up = up_beside(direction);
  const kernels::LookAt view = kernels::look_at(-direction, glm::dvec3(0), up);
  kernels::Box box = box_in(view, p_world);
  if (box.empty()) box.add(glm::dvec3(-0.5)), box.add(glm::dvec3(0.5));
  const glm::dvec3 middle = box.centre(), half = box.half_size();
  const double size = std::max({half.x, half.y, half.z}), width = std::max(half.x, half.y);
  // Half the depth again in front and behind: depths of what is seen stay well within the range.
  const double depth = std::max({half.z, 0x1p-10 * size, 0x1p-500});
  const kernels::Affine& m = view.eye_from_world;
  const glm::dvec3 eye =
      m.inverse_linear * glm::dvec3(middle.x, middle.y, middle.z + 2 * depth) + m.inverse_translation;
  return {eye, eye + direction, up, 0.5 * depth, 3.5 * depth, 2 * with_border(width > 0 ? width : 1, texels),
          0};
}

/// Looks from `eye` along the unit vector `direction` over a cone of half the angle `half_angle` < pi / 2. The near plane
/// lies in front of all points, but no nearer than 2^-12 of the farthest one: what is nearer to the light than
/// that is cut off.
inline View view_from(const glm::dvec3& eye, const glm::dvec3& direction, const glm::dvec3& up,
                      double half_angle, std::span<const glm::dvec3> p_world, int texels) {
  const kernels::LookAt view = kernels::look_at(eye, eye + direction, up);
  const kernels::Box box = box_in(view, p_world);
  const double farthest = box.empty() || !(box.low.z < 0) ? 1 : -box.low.z;
  const double nearest = box.empty() ? farthest : -box.high.z;
  const double spread = with_border(kernels::tan(half_angle), texels);
  return {eye,
          eye + direction,
          up,
          std::max(0.5 * nearest, 0x1p-12 * farthest),
          2 * farthest,
          0,
          2 * kernels::atan2(spread, 1.0)};
}

}  // namespace frustum::light_camera
