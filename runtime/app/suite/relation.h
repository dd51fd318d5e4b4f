// How a buffer has to change when its input is changed.
#pragma once

#include "runtime/app/suite/check.h"
#include "runtime/core/buffer.h"

namespace frustum {

// Two buffers that have to be alike: the first made from that of the changed run, the second from that of
// the case's own run by the relation. A shift compares where both have pixels, a matrix compares positions
// alone. Throws NodeError("no_relation") where a buffer cannot be changed so: pixels with several samples
// are not moved, a matrix is for meshes in object or world space, a factor for pixels.
struct RelatedPair {
  Buffer actual, expected;
};
RelatedPair related(const Relation&, const Buffer& own, const Buffer& changed);

}  // namespace frustum
