// Depth seen from a light, and whether a point is behind it.
#pragma once

#include "nodes/kernels/camera.h"
#include "nodes/kernels/seen_face.h"

#include <cmath>
#include <optional>

namespace frustum::shadow_map {

/// A picture of depth that a light's camera took.
struct View {
  kernels::Affine eye_from_world;
  kernels::Projection volume;
  kernels::Viewport viewport;
};

/// Where the light's camera sees a point: pixels (y down), depth of NDC, and how fast depth changes there: across a
/// texel each way on the plane of the point's face, and along the view axis per world unit. All rates are >= 0, and
/// infinite on a face that the light sees edge on.
struct Seen {
  double x_px, y_px, z;
  double z_by_x_px, z_by_y_px, z_by_distance;
};

/// Nothing for a point beside or behind a camera that looks from a place.
/// Derivation: on the plane a x + b y + c z = d of eye space, NDC depth is linear in NDC x and y. From a place
/// with z_ndc = -Z - D / z it is (D / d) (a x_ndc / X + b y_ndc / Y - c) - Z; of a box, z_ndc = (z + S) Z with
/// z = (d - a x - b y) / c.
inline std::optional<Seen> seen_from_light(const View& v, const kernels::SeenFace& face,
                                           const glm::dvec3& p_world) {
  const glm::dvec3 p = v.eye_from_world.linear * p_world + v.eye_from_world.translation;
  const glm::dvec3 n = v.eye_from_world.linear * face.normal;
  const kernels::Projection& m = v.volume;
  const double w = m.perspective ? -p.z : 1;
  if (!(w > 0)) return std::nullopt;
  const double x = m.scale.x * p.x / w, y = m.scale.y * p.y / w;
  Seen s{v.viewport.x_px(x), v.viewport.y_px(y), 0, 0, 0, 0};
  if (m.perspective) {
    const double d = kernels::dot(n, p);
    s.z = -m.depth_scale + m.depth_offset / w;
    s.z_by_x_px = m.depth_offset * n.x / (d * m.scale.x),
    s.z_by_y_px = m.depth_offset * n.y / (d * m.scale.y);
    s.z_by_distance = std::fabs(m.depth_offset / (w * w));
  } else {
    s.z = ((p.z + m.depth_shift.hi) + m.depth_shift.lo) * m.depth_scale;
    s.z_by_x_px = m.depth_scale * n.x / (n.z * m.scale.x),
    s.z_by_y_px = m.depth_scale * n.y / (n.z * m.scale.y);
    s.z_by_distance = std::fabs(m.depth_scale);
  }
  // 0 / 0 where the face has no area: such a face is seen edge on.
  const auto rate = [](double r, double half_size) {
    const double size = std::fabs(r / half_size);
    return size == size ? size : std::numeric_limits<double>::infinity();
  };
  s.z_by_x_px = rate(s.z_by_x_px, v.viewport.half_width),
  s.z_by_y_px = rate(s.z_by_y_px, v.viewport.half_height);
  return s;
}

/// By how much a point's depth may lie behind what the map shows at a texel whose middle is at most `reach_px` away in x and y,
/// and still be the same surface: `bias` times what its face's plane changes over that way (1 is enough for a
/// plane), and rounding: corners in the map snap to a grid of `step_px`, each point lies within its face's slack, depths of
/// unit roundoff u have gone through at most 16 roundings.
inline double depth_tolerance(const Seen& s, const kernels::SeenFace& face, double bias, double reach_px,
                              double step_px, double u) {
  const double slope = s.z_by_x_px + s.z_by_y_px;
  const double texel = bias > 0 ? bias * reach_px * slope : 0;  // not 0 times infinity
  return texel + slope * step_px + s.z_by_distance * face.slack + 16 * u;
}

/// The share of the (2 radius + 1)^2 texels around a point that do not lie before it; outside of the map nothing does.
///   z_of(column, row) of texels in [0, size)
/// Source: Reeves, Salesin & Cook 1987, Rendering antialiased shadows with depth maps, doi:10.1145/37402.37435; their
/// random places are all texels of the square here.
template <class Depth>
double share_of_light(const Seen& s, double tolerance, int radius, const glm::ivec2& size,
                      kernels::DepthRange depth, const Depth& z_of) {
  if (!(std::fabs(s.x_px) < 0x1p30 && std::fabs(s.y_px) < 0x1p30)) return 1;
  const int column = static_cast<int>(std::floor(s.x_px)), row = static_cast<int>(std::floor(s.y_px));
  int lit = 0;
  for (int y = row - radius; y <= row + radius; ++y)
    for (int x = column - radius; x <= column + radius; ++x) {
      const bool inside = x >= 0 && y >= 0 && x < size.x && y < size.y;
      const double z = inside ? z_of(x, y) : s.z;
      const double nearer = kernels::is_reversed(depth) ? z - s.z : s.z - z;
      lit += nearer > tolerance ? 0 : 1;
    }
  const int side = 2 * radius + 1;
  return static_cast<double>(lit) / (side * side);
}

}  // namespace frustum::shadow_map
