// One vertex for each distinct position.
#pragma once

#include "runtime/buffers/column.h"
#include "runtime/core/context.h"

#include <span>
#include <vector>

namespace frustum {

// Columns `triangle` and `position` (object space) of triangles given by three corners each. Corners are one
// vertex where their coordinates have equal bits, -0 counting as 0; vertices stand in the order of first use.
// Requires finite corners, a multiple of three of them and fewer than 2^32. Cost: one sort, whatever the
// coordinates are.
template <class R>
std::vector<Ref<Column>> weld_exact(std::span<const glm::vec<3, R>> corners, const Context& ctx);

}  // namespace frustum
