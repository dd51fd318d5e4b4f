// Mirrored rays.
#pragma once

#include <optional>

#include "nodes/kernels/ray_beam.h"
#include "nodes/kernels/surface_point.h"

namespace frustum::trace {

// The beam that a mirror sends on: along d - 2 (n.d) n, of the length of d, from the point. Nothing where the point has no
// normal. It never leads into the face: where the shading normal would send it there, the face's own takes its place.
// The change per pixel is exact: with c = n.d, d' = d - 2 c n changes by dd - 2 (c dn + (d.dn + n.dd) n).
// Errata E46; source: Whitted 1980, An improved illumination model for shaded display, doi:10.1145/358876.358882; Igehy
// 1999 (the derivatives).
inline std::optional<kernels::RayBeam> mirrored(const kernels::RayBeam& in, const kernels::SurfacePoint& at) {
  const auto about = [&](const kernels::UnitNormal& n) {
    const double c = kernels::dot(n.n, in.along);
    const auto change = [&](const glm::dvec3& dd, const glm::dvec3& dn) {
      return dd - 2.0 * (c * dn + (kernels::dot(in.along, dn) + kernels::dot(n.n, dd)) * n.n);
    };
    return kernels::RayBeam{.origin = at.p,
                            .along = in.along - 2 * c * n.n,
                            .origin_dx = at.p_dx,
                            .origin_dy = at.p_dy,
                            .along_dx = change(in.along_dx, n.dx),
                            .along_dy = change(in.along_dy, n.dy)};
  };
  const auto n = kernels::unit_normal(at);
  if (!n) return std::nullopt;
  const kernels::RayBeam out = about(*n);
  const double before = kernels::dot(at.face_normal, in.along),
               after = kernels::dot(at.face_normal, out.along);
  if (before * after < 0 || at.face_normal == glm::dvec3(0)) return out;
  return about({at.face_normal, glm::dvec3(0), glm::dvec3(0)});
}

}  // namespace frustum::trace
