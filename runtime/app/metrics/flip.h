// FLIP: what a person sees who flips between two pictures.
#pragma once

#include "runtime/app/metrics/picture.h"

namespace frustum {

// Pixels per degree of the visual field: 0.7 m before a screen 0.7 m wide with 3840 pixels.
constexpr double flip_pixels_per_degree = 67.0206;

// The FLIP error of each pixel, 0 (the same) to 1. Both pictures have the same size and hold no NaN; values
// are cut to [0, 1]. Pixels beyond the border repeat those on it. The LDR metric of Andersson, Nilsson,
// Akenine-Moeller, Oskarsson, Astrom and Fairchild, "FLIP: a difference evaluator for alternating images",
// Proc. ACM Comput. Graph. Interact. Tech. 3, 2 (2020): contrast sensitivity filters in YCxCz, HyAB distance
// of Hunt-adjusted L*a*b*, and edge and point features. Cost: about 0.5 us a pixel.
Grid flip_map(const Picture& reference, const Picture& test,
              double pixels_per_degree = flip_pixels_per_degree);

}  // namespace frustum
