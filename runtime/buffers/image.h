// Pixels with a meaning: colour or attribute images, depth, and visibility.
#pragma once

#include "runtime/core/buffer.h"
#include "runtime/core/raster.h"

#include <cstdint>

namespace frustum {

// Any named planes: "R" "G" "B" "A" of colour, or the attributes of visible points ("uv.u", "N.x", "P.x", "id").
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

template <>
const BufferType& buffer_type<Image>();
template <>
const BufferType& buffer_type<Depth>();
template <>
const BufferType& buffer_type<Visibility>();

}  // namespace frustum
