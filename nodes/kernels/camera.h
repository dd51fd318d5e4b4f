#pragma once
// From world space to pixels: view, projection, divide, viewport. Each step with its inverse in closed form.
// Right-handed; the camera looks along -z of eye space, y up; x and y of NDC are in [-1, 1], y up or down and depth
// as ClipSpace says; pixels have y down.

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <span>

#include "nodes/kernels/affine.h"
#include "nodes/kernels/clip_space.h"
#include "nodes/kernels/elementary.h"
#include "nodes/kernels/parallel.h"
#include "nodes/kernels/vector.h"

namespace frustum::kernels {

// What was wrong with a look-at, and was replaced.
enum class LookAtFault : std::uint8_t { none, no_direction, up_along_direction };

struct LookAt {
  Affine eye_from_world;  // rigid: its inverse is exact, the eye itself is its translation
  LookAtFault fault;
};

// Puts `eye` at the origin and `target` on the negative z axis, `up` in the upper half of the y-z plane.
// Orthonormal to 4 u for every direction. Where target = eye (or either is not finite) the camera looks
// along -z; where up is within 2^-40 rad of the view direction, up becomes -z, or y if the view is more along
// z: looking straight down with y up, the top of the picture is north (-z).
inline LookAt look_at(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up) {
  LookAtFault fault = LookAtFault::none;
  const auto away = normalized(eye - target);
  if (!away) fault = LookAtFault::no_direction;
  const glm::dvec3 back = away.value_or(glm::dvec3(0, 0, 1));
  const glm::dvec3 replacement = std::fabs(back.z) <= 0.7 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
  glm::dvec3 sideways = cross(normalized_or(up, back), back);
  if (norm(sideways) < 0x1p-40) {
    if (fault == LookAtFault::none) fault = LookAtFault::up_along_direction;
    sideways = cross(replacement, back);
  }
  const glm::dvec3 right = normalized_or(sideways, glm::dvec3(1, 0, 0));
  const glm::dvec3 above = cross(back, right);
  Affine view = rotation_of(orthonormalized(glm::transpose(glm::dmat3(right, above, back))));
  view.translation = -(view.linear * eye);
  view.inverse_translation = eye;
  return {view, fault};
}

// A symmetric view volume to clip space, by its five numbers:
//   x_clip = x X, y_clip = y Y, z_clip = z Z + D, w_clip = -z (perspective) or 1 (orthographic)
// An orthographic box is moved first and scaled then, z_clip = (z + S) Z: where it is thin and far away, z Z
// and D are large and cancel (hard case PRJ-07). S is the unevaluated sum of two numbers. In the form of OpenGL: errata E9, the notes' matrices have rank 3.
struct Projection {
  glm::dvec2 scale;     // X, Y; Y < 0 where y of clip space points down
  double depth_scale;   // Z
  double depth_offset;  // D = S Z
  bool perspective;
  ClipSpace space;
  TwoTerms<double> depth_shift = {0, 0};  // S; 0 for a perspective
};

// Depth runs from -1 at near_z to 1 at far_z, or from 0 to 1; or from 1 to 0, which gives float depth its even
// relative resolution. Both ends are met within 2 u f / (f - n). far_z may be infinite. Requires 0 < near_z < far_z,
// 0 < fov_y < pi, aspect = width / height > 0.
inline Projection perspective(double fov_y, double aspect, double near_z, double far_z,
                              ClipSpace space = {}) {
  const double y = 1 / tan(fov_y / 2);
  Projection p{{y / aspect, space.y_down ? -y : y}, 0, 0, true, space};
  const bool infinite = far_z == std::numeric_limits<double>::infinity();
  // Z rounded once, then D from the Z that is stored, rounded once: what Z lost cancels at the near plane.
  const TwoTerms<double> depth = two_sum(far_z, -near_z);
  switch (space.depth) {
    case DepthRange::one_to_zero:
      p.depth_scale = infinite ? 0 : quotient<double>({near_z, 0.0}, depth).hi;
      p.depth_offset = product(two_sum(p.depth_scale, 1.0), {near_z, 0}).hi;
      break;
    case DepthRange::zero_to_one:
      p.depth_scale = infinite ? -1 : -quotient<double>({far_z, 0.0}, depth).hi;
      p.depth_offset = p.depth_scale * near_z;
      break;
    case DepthRange::minus_one_to_one:
      p.depth_scale = infinite ? -1 : -quotient(two_sum(far_z, near_z), depth).hi;
      p.depth_offset = product(two_sum(p.depth_scale, -1.0), {near_z, 0}).hi;
      break;
  }
  return p;
}

// A view volume `height` high between near_z and far_z. Requires height > 0, aspect > 0, finite near_z <
// far_z.
inline Projection orthographic(double height, double aspect, double near_z, double far_z,
                               ClipSpace space = {}) {
  const double y = 2 / height, depth = far_z - near_z;
  const glm::dvec2 scale(y / aspect, space.y_down ? -y : y);
  switch (space.depth) {
    case DepthRange::one_to_zero: return {scale, 1 / depth, far_z / depth, false, space, {far_z, 0}};
    case DepthRange::zero_to_one: return {scale, -1 / depth, -near_z / depth, false, space, {near_z, 0}};
    case DepthRange::minus_one_to_one: break;
  }
  const auto ends = two_sum(near_z, far_z);
  return {scale, -2 / depth, -ends.hi / depth, false, space, {ends.hi / 2, ends.lo / 2}};
}

inline glm::dmat4 matrix_of(const Projection& p) {
  glm::dmat4 m(0.0);
  m[0][0] = p.scale.x, m[1][1] = p.scale.y, m[2][2] = p.depth_scale;
  m[3][2] = p.depth_offset;
  m[2][3] = p.perspective ? -1 : 0;
  m[3][3] = p.perspective ? 0 : 1;
  return m;
}

// The projection in the precision of a buffer.
template <std::floating_point R>
struct ClipMap {
  explicit ClipMap(const Projection& p)
      : x(static_cast<R>(p.scale.x)),
        y(static_cast<R>(p.scale.y)),
        z(static_cast<R>(p.depth_scale)),
        shift(static_cast<R>(p.depth_shift.hi)),
        shift_low(static_cast<R>((p.depth_shift.hi - static_cast<double>(shift)) + p.depth_shift.lo)),
        offset(static_cast<R>(p.perspective ? p.depth_offset : 0)),
        perspective(p.perspective) {}
  glm::vec<4, R> operator()(const glm::vec<3, R>& p_eye) const {
    return {p_eye.x * x, p_eye.y * y, ((p_eye.z + shift) + shift_low) * z + offset,
            perspective ? -p_eye.z : R(1)};
  }
  R x, y, z, shift, shift_low, offset;
  bool perspective;
};

// p_clip[i] = P p_eye[i] in the precision of the buffers: x and y one rounding each, z two (of an orthographic
// box three, relative to its depth), w exact. Nothing is divided. Requires equal sizes. Cost: 6 operations a
// point; memory speed.
template <std::floating_point R>
void map_to_clip(const Projection& projection, std::span<const glm::vec<3, R>> p_eye,
                 std::span<glm::vec<4, R>> p_clip) {
  const ClipMap<R> map(projection);
  parallel_blocks(p_eye.size(), usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) p_clip[i] = map(p_eye[i]);
  });
}

// Back from NDC to eye space, in closed form: the general inverse loses z / near digits. Infinite z where
// depth is that of an infinite far plane.
inline glm::dvec3 eye_from_ndc(const Projection& p, const glm::dvec3& ndc) {
  if (!p.perspective)
    return {ndc.x / p.scale.x, ndc.y / p.scale.y,
            (ndc.z / p.depth_scale - p.depth_shift.hi) - p.depth_shift.lo};
  const double distance = p.depth_offset / (ndc.z + p.depth_scale);
  return {ndc.x * distance / p.scale.x, ndc.y * distance / p.scale.y, -distance};
}

// The view volume's sides as half-spaces of homogeneous points: inside where dot(plane, p) >= 0. In order near, far,
// left, right, bottom, top of the picture.
inline std::array<glm::dvec4, 6> clip_planes(ClipSpace space = {}, double guard_band = 1) {
  const glm::dvec4 low(0, 0, 1, -least_depth(space.depth)), high(0, 0, -1, 1);
  const bool reversed = is_reversed(space.depth);
  const double up = space.y_down ? -1 : 1;
  return {reversed ? high : low,
          reversed ? low : high,
          glm::dvec4(1, 0, 0, guard_band),
          glm::dvec4(-1, 0, 0, guard_band),
          glm::dvec4(0, up, 0, guard_band),
          glm::dvec4(0, -up, 0, guard_band)};
}

// The same planes for points of the space that `projection * view` comes from, not normalised.
// Source: Gribb & Hartmann 2001.
inline std::array<glm::dvec4, 6> frustum_planes(const Projection& projection, const Affine& eye_from_world) {
  const glm::dmat4 to_planes = glm::transpose(matrix_of(projection) * matrix_of(eye_from_world));
  auto planes = clip_planes(projection.space);
  for (auto& plane : planes) plane = to_planes * plane;
  return planes;
}

// NDC to pixels: x_px = (x + 1) W / 2, y_px = (1 - y) H / 2 (errata E10 and E11), or (1 + y) H / 2 where y of NDC
// points down already; z as it is. In double, so that for W up to 2^14 the NDC of a pixel centre, rounded to float,
// comes back within 2^-10 px of it.
struct Viewport {
  double half_width, half_height;  // pixels
  double up;                       // the sign of NDC y at the top of the picture
  explicit Viewport(const glm::ivec2& resolution, bool y_down = false)
      : half_width(resolution.x / 2.0), half_height(resolution.y / 2.0), up(y_down ? -1 : 1) {}

  template <std::floating_point R>
  R x_px(R x_ndc) const {
    return static_cast<R>((static_cast<double>(x_ndc) + 1) * half_width);
  }
  template <std::floating_point R>
  R y_px(R y_ndc) const {
    return static_cast<R>((1 - up * static_cast<double>(y_ndc)) * half_height);
  }
  // Subtracting first keeps the middle at 0 and pixel centres that mirror each other so, bit for bit.
  glm::dvec2 ndc_from_px(const glm::dvec2& px) const {
    return {(px.x - half_width) / half_width, up * ((half_height - px.y) / half_height)};
  }
};

// x / w, y / w, z / w, each rounded once: 1 / w overflows for w below 2^-128, the quotients need not.
template <std::floating_point R>
glm::vec<3, R> divided(const glm::vec<4, R>& p) {
  return {p.x / p.w, p.y / p.w, p.z / p.w};
}

// The first point whose divide by w changes a bit; p_clip.size() where w is 1 everywhere, as after a parallel
// projection.
template <std::floating_point R>
std::size_t first_to_divide(std::span<const glm::vec<4, R>> p_clip) {
  return first_where(p_clip.size(), [&](std::size_t i) { return p_clip[i].w != R(1); });
}

}  // namespace frustum::kernels
