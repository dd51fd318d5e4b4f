// One buffer of a report: what it is, its statistics, and a form that the page can draw.
#pragma once

#include "runtime/app/report/blobs.h"
#include "runtime/core/buffer.h"

#include <cstdint>

namespace frustum::report {

// {"kind", "color", "bytes", "digest", "health", "summary", "table"?, "view"?} where view is one of
//   {"type": "picture", "window", "step", "width", "height", "samples", "color_space", "alpha",
//    "planes": [{"name", "data": blob}]}          every step-th pixel of the central sample
//   {"type": "faces" | "lines", "space", "shown", "total", "positions": blob, "indices": blob, "flat": bool}
Json describe_buffer(const Buffer& buffer, Blobs& blobs, std::uint64_t most_values);

}  // namespace frustum::report
