// Pixels with a meaning: colour or attribute images, depth, and visibility.
#pragma once

#include "runtime/core/buffer.h"
#include "runtime/core/raster.h"

#include <cstdint>
#include <string_view>

namespace frustum {

// Any named planes: "R" "G" "B" "A" of colour, or the attributes of visible points.
//
// The points of rasterize.attributes hold, at each covered sample (all zero and id = no_face elsewhere),
// those of
//   id                         u32   the face seen
//   uv.u uv.v                  real  texture coordinates
//   uv.du_dx uv.dv_dx uv.du_dy uv.dv_dy   their screen derivatives, per pixel; uv1.u ... of further sets
//   N.x N.y N.z                real  interpolated world-space normal, not renormalised
//   P.x P.y P.z                real  world-space position; P.dx_dx P.dy_dx P.dz_dx ... its change per pixel
//   color.x color.y color.z    real  vertex colour, linear Rec.709 (color.w: opacity)
//   w                          real  distance along the view axis (clip w)
// and any other column NAME of the mesh as NAME.x NAME.y NAME.z NAME.w (NAME alone for width 1).
struct Image {
  Raster raster;
};

// One real plane "Z" in the depth convention of the camera; empty samples hold its far value.
struct Depth {
  Raster raster;
};

// What is seen at each sample: planes "id" (u32: the face of the mesh, or no_face) and "Z" (real).
struct Visibility {
  Raster raster;
};

constexpr std::uint32_t no_face = 0xFFFFFFFFu;

// The colour space of all colour that nodes compute: linear light, Rec.709 primaries, D65 white.
constexpr std::string_view linear_rec709 = "lin_rec709";

template <>
const BufferType& buffer_type<Image>();
template <>
const BufferType& buffer_type<Depth>();
template <>
const BufferType& buffer_type<Visibility>();

}  // namespace frustum
