// Colours of vertices as mesh files store them.
#pragma once

#include "runtime/buffers/column.h"
#include "runtime/core/context.h"

namespace frustum {

// Turns a column of 3 or 4 whole numbers from 0 to `most` (others are cut to that), sRGB, into linear Rec.709
// in place: red, green and blue are decoded, alpha is divided by `most`. Each is rounded once, from double.
template <class R>
void decode_srgb(Column& color, int most, const Context& ctx);

}  // namespace frustum
