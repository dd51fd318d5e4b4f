// SSIM: how alike the structure of two pictures is.
#pragma once

#include "runtime/app/metrics/picture.h"

namespace frustum {

// The luma (Rec.709 weights) of the picture as an sRGB display shows it, cut to [0, 1].
Grid display_luma(const Picture&);

// The structural similarity around each pixel, -1 to 1 (the same), for values in [0, 1]: Gaussian window of
// 11 x 11 with sigma 1.5, K1 = 0.01, K2 = 0.03; at the border the window is cut and its weights scaled up.
// Wang, Bovik, Sheikh and Simoncelli, "Image quality assessment: from error visibility to structural
// similarity", IEEE Trans. Image Process. 13 (2004).
Grid ssim_map(const Grid& a, const Grid& b);

// The mean of the map over the pixels whose window is not cut, as in the paper; over all where there are
// none.
double ssim(const Grid& a, const Grid& b);

}  // namespace frustum
