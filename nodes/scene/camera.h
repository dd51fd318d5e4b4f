// What a camera's numbers must satisfy together.
#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <string_view>

namespace frustum::scene {

// What is wrong with a camera's numbers, and the parameter to change; empty where nothing is.
struct CameraFault {
  std::string_view param = {}, what = {};
  bool empty() const { return what.empty(); }
};

// An infinite far plane is allowed, and so is an up along the
// view: project.view reports what it does about that.
inline CameraFault fault_of_camera(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up,
                                   double near_z, double far_z) {
  const auto finite = [](const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  };
  if (!finite(eye)) return {"eye", "eye must be finite"};
  if (!finite(target)) return {"target", "target must be finite"};
  if (!finite(up)) return {"up", "up must be finite"};
  if (eye == target) return {"target", "eye and target are one point: the camera looks nowhere"};
  if (up == glm::dvec3(0)) return {"up", "up has no direction"};
  if (!(near_z > 0)) return {"near", "near must be above 0"};
  if (!(far_z > near_z)) return {"far", "far must be beyond near"};
  return {};
}

}  // namespace frustum::scene
