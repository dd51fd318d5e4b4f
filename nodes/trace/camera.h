// The rays of a camera.
#pragma once

#include "nodes/kernels/camera.h"
#include "nodes/kernels/ray_beam.h"

namespace frustum::trace {

// Rays through places of the picture, in world space.
//   perspective:  from the eye along -n + (x / X) u + (y / Y) v, with (x, y) in NDC and the projection's scales X and
//                 Y: t is the distance along the view axis. The eye is not subtracted from a point of the picture, which
//                 far from the origin would leave no digits of the way (hard case RAY-24).
//   orthographic: from the plane through the eye along -n.
// Errata E41 and E42: the notes put the row where the column belongs, and their N_c - 1 divides by zero for one column; a
// pixel's place is (x + 1/2) / W here.
class CameraRays {
 public:
  CameraRays(const kernels::LookAt& view, const kernels::Projection& projection,
             const kernels::Viewport& viewport)
      : viewport_(viewport),
        perspective_(projection.perspective),
        eye_(view.eye_from_world.inverse_translation) {
    const glm::dmat3& world_from_eye = view.eye_from_world.inverse_linear;
    back_ = world_from_eye[2];
    by_x_ = world_from_eye[0] / projection.scale.x, by_y_ = world_from_eye[1] / projection.scale.y;
  }

  // At (x, y) px, y down.
  kernels::RayBeam at(const glm::dvec2& px) const {
    const glm::dvec2 ndc = viewport_.ndc_from_px(px);
    const glm::dvec3 place = ndc.x * by_x_ + ndc.y * by_y_;
    const glm::dvec3 dx = by_x_ / viewport_.half_width, dy = by_y_ * (-viewport_.up / viewport_.half_height);
    kernels::RayBeam beam{.origin = eye_, .along = -back_};
    if (perspective_)
      beam.along = place - back_, beam.along_dx = dx, beam.along_dy = dy;
    else
      beam.origin = eye_ + place, beam.origin_dx = dx, beam.origin_dy = dy;
    return beam;
  }

 private:
  kernels::Viewport viewport_;
  bool perspective_;
  glm::dvec3 eye_, back_, by_x_, by_y_;
};

}  // namespace frustum::trace
