// A sample pattern as a buffer; the struct itself is part of a Frame (runtime/core/frame.h).
#pragma once

#include "runtime/core/buffer.h"
#include "runtime/core/frame.h"

namespace frustum {
template <>
const BufferType& buffer_type<SamplePattern>();
}  // namespace frustum
