// Attributes at the samples where a face is seen.
#pragma once

#include "nodes/kernels/interpolate_attributes.h"
#include "nodes/kernels/simd/interpolate_attributes.h"

namespace frustum {

// See kernels::interpolate_attributes: with vectors for single precision, the same bytes on every target.
template <std::floating_point R>
void attributes_at(const kernels::AttributeScene<R>& scene, kernels::PixelRect rect,
                   kernels::PlaneView<const std::uint32_t> id, const kernels::AttributePlanes<R>& planes) {
  if constexpr (std::is_same_v<R, float>)
    kernels::simd::interpolate_attributes(scene, rect, id, planes);
  else
    kernels::interpolate_attributes(scene, rect, id, planes);
}

/// Fills the value planes of an attribute whose corners have the same bits in every face, finite and without -0, as
/// attributes_at would: weights of whatever size leave them alone. 0 where nothing is seen.
template <std::floating_point R>
void copy_attribute(const kernels::ScreenMesh<R>& mesh, kernels::PixelRect rect, int samples,
                    kernels::PlaneView<const std::uint32_t> id, const kernels::Attribute<R>& attribute) {
  const auto width = static_cast<std::size_t>(attribute.width);
  for (int s = 0; s < samples; ++s)
    for (int y = 0; y < rect.y1 - rect.y0; ++y) {
      const std::uint32_t* faces = id.row(s, y);
      for (std::size_t i = 0; i < width; ++i) {
        if (attribute.value[i].data == nullptr) continue;
        R* to = attribute.value[i].row(s, y);
        std::uint32_t last = kernels::no_face;
        R value = 0;
        for (int x = 0; x < rect.x1 - rect.x0; ++x) {
          if (faces[x] != last) {
            last = faces[x];
            value =
                last == kernels::no_face ? R(0) : attribute.data[attribute.row(mesh, last, 0) * width + i];
          }
          to[x] = value;
        }
      }
    }
}

}  // namespace frustum
