// The whole chain from a model to pixels in one matrix: M = M_vp M_proj M_cam^-1 M_mod (errata E11 and E13).
#pragma once

#include <glm/mat4x4.hpp>

#include "nodes/kernels/camera.h"

namespace frustum::project {

// NDC to pixels, y down: x_px = (x + 1) W / 2, y_px = (1 - y) H / 2, or (1 + y) H / 2 where y of NDC points down;
// z and w as they are (errata E10).
inline glm::dmat4 viewport_matrix(const kernels::Viewport& v) {
  glm::dmat4 m(1.0);
  m[0][0] = v.half_width, m[3][0] = v.half_width;
  m[1][1] = -v.up * v.half_height, m[3][1] = v.half_height;
  return m;
}

}  // namespace frustum::project
