// The clip spaces that the conventions of APIs make, each with depth either way.
#pragma once

#include "nodes/kernels/clip_space.h"

#include <array>

namespace frustum::test {

inline constexpr std::array<kernels::ClipSpace, 5> clip_spaces{{
    {kernels::DepthRange::minus_one_to_one, false},
    {kernels::DepthRange::zero_to_one, false},
    {kernels::DepthRange::zero_to_one, true},
    {kernels::DepthRange::one_to_zero, false},
    {kernels::DepthRange::one_to_zero, true},
}};

}  // namespace frustum::test
