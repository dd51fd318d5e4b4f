// Rays bent where one medium ends and another begins.
#pragma once

#include "nodes/kernels/ray_beam.h"
#include "nodes/kernels/surface_point.h"

#include <cmath>
#include <optional>

namespace frustum::trace {

// What happens to light of unit direction d at a surface with unit normal n on the side it comes from.
//   eta  the index of refraction before the surface over that behind it, > 0
struct Refraction {
  bool total = false;      // nothing gets through
  double reflectance = 0;  // the share that is mirrored, unpolarised; 1 where all is
  glm::dvec3 along{0};     // unit; of what gets through
  double cos_in = 0, cos_out = 0;
};

// Snell's law and Fresnel's equations of a clear medium. The part of d along the surface is scaled by eta and kept; what
// it leaves of the unit length is (1 - eta s)(1 + eta s), s = |n x d|: 1 - eta^2 (1 - c^2) cancels twice near the critical
// angle and gets the side wrong (hard case RAY-17). At normal incidence the reflectance is ((eta - 1) / (eta + 1))^2; at
// eta = 1 nothing bends, without a branch (RAY-20).
// Errata E47; source: Born & Wolf, Principles of Optics, 1.5.2.
inline Refraction refracted(const glm::dvec3& d, const glm::dvec3& n, double eta) {
  Refraction out;
  out.cos_in = std::fabs(kernels::dot(n, d));
  const double s = kernels::norm(kernels::cross(n, d)), left = (1 - eta * s) * (1 + eta * s);
  if (!(left > 0)) {
    // At the critical angle itself light grazes the surface, and none of it gets through either.
    out.total = true, out.reflectance = 1;
    return out;
  }
  out.cos_out = std::sqrt(left);
  const glm::dvec3 tangent = d - kernels::dot(n, d) * n;
  out.along = eta * tangent - out.cos_out * n;
  const double parallel = (out.cos_in - eta * out.cos_out) / (out.cos_in + eta * out.cos_out),
               across = (eta * out.cos_in - out.cos_out) / (eta * out.cos_in + out.cos_out);
  out.reflectance = (parallel * parallel + across * across) / 2;
  return out;
}

// A beam at a surface: what is bent, if any is, and the share that is mirrored.
struct Bent {
  std::optional<kernels::RayBeam> beam;
  double reflectance = 0;
};

// The beam goes on with the length it had. Outside is where the face's normal points: there the index is `outside`, on the
// other side `inside`. Nothing where the point has no normal.
// With d of unit length, c = n.d < 0, c' = n.d' and m = eta c - c', d' = eta d - m n changes by
// eta dd - (m dn + dm n), dm = (eta - eta^2 c / c') dc, dc = d.dn + n.dd. Source: Igehy 1999.
inline Bent bent(const kernels::RayBeam& in, const kernels::SurfacePoint& at, double outside, double inside) {
  const auto normal = kernels::unit_normal(at);
  const auto unit = kernels::normalized(in.along);
  if (!normal || !unit) return {};
  const double length = kernels::norm(in.along);
  const bool enters = kernels::dot(at.face_normal == glm::dvec3(0) ? normal->n : at.face_normal, *unit) < 0;
  const double turn = kernels::dot(normal->n, *unit) < 0 ? 1 : -1;
  const kernels::UnitNormal n{turn * normal->n, turn * normal->dx, turn * normal->dy};
  const double eta = enters ? outside / inside : inside / outside;
  const Refraction r = refracted(*unit, n.n, eta);
  if (r.total) return {std::nullopt, 1};
  const double c = -r.cos_in, m = eta * c + r.cos_out;
  const auto change = [&](const glm::dvec3& of_along, const glm::dvec3& dn) {
    const double stretch = kernels::dot(*unit, of_along);  // of the length
    const glm::dvec3 dd = (of_along - stretch * *unit) / length;
    const double dc = kernels::dot(*unit, dn) + kernels::dot(n.n, dd),
                 dm = (eta + eta * eta * c / r.cos_out) * dc;
    return length * (eta * dd - (m * dn + dm * n.n)) + stretch * r.along;
  };
  return {kernels::RayBeam{.origin = at.p,
                           .along = length * r.along,
                           .origin_dx = at.p_dx,
                           .origin_dy = at.p_dy,
                           .along_dx = change(in.along_dx, n.dx),
                           .along_dy = change(in.along_dy, n.dy)},
          r.reflectance};
}

}  // namespace frustum::trace
