// The vector twins of nodes/kernels/lighting.h for float: the same bits, on every target.
#pragma once

#include "nodes/kernels/lighting.h"

namespace frustum::kernels::simd {

/// Cost on AVX-512, one light with a Blinn highlight: about 8 cycles a point; a vector without a selected
/// point is skipped.
void receive_light(const LightSetup<float>& setup, const PointRows<float>& in, Selection which, std::size_t n,
                   const LightRows<float>& out);

void reflect_light(const SurfaceColors<float>& colors, const LightInput<float>& light,
                   const std::array<const float*, 3>& albedo, const float* opacity, Selection which,
                   bool keep, std::size_t n, const ColorRows<float>& out);

/// Most vectors of points show one face: they cost one look into the table.
void numbers_of_faces(std::span<const float> table, const std::uint32_t* id, std::size_t n, float* out);

/// The whole row; the stride of `left` is n.
bool take_face(std::uint32_t* left, std::size_t samples, std::size_t n, std::span<const float* const> in,
               std::uint32_t* face, std::span<float* const> mean);

void put_face(const std::uint32_t* id, const std::uint32_t* face, std::size_t n, const ColorRows<float>& from,
              const ColorRows<float>& to);

}  // namespace frustum::kernels::simd
