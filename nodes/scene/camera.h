// What a camera's numbers must satisfy together.
#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <string_view>

namespace frustum::scene {

// What is wrong with a camera's numbers, or nothing. An infinite far plane is allowed, and so is an up along the
// view: project.view reports what it does about that.
inline std::string_view fault_of_camera(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up,
                                        double near_z, double far_z) {
  for (const auto& v : {eye, target, up})
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
      return "eye, target and up must be finite";
  if (eye == target) return "eye and target are one point: the camera looks nowhere";
  if (up == glm::dvec3(0)) return "up has no direction";
  if (!(near_z > 0)) return "near must be above 0";
  if (!(far_z > near_z)) return "far must be beyond near";
  return {};
}

}  // namespace frustum::scene
