// How much of each source of light reaches a point: what the nodes that find shadows tell those that shade.
//
// An image with the real planes "V0", "V1" ... in [0, 1], one for each source that anything may hide. Sources are
// counted as light_sources() gives them: the lights of all links in their order, without ambient ones and those of
// colour 0; a light with an area counts once for each of its samples. A source without a plane is seen from everywhere.
#pragma once

#include "nodes/kernels/lighting.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/real_rows.h"

#include <span>
#include <string>
#include <vector>

namespace frustum {

inline std::string visibility_plane(std::size_t source) { return "V" + std::to_string(source); }

// The sources that may be hidden, in the numbers' own precision.
std::vector<kernels::LightSource<double>> light_sources(std::span<const Ref<LightSet>> lights);

// The planes of such an image by source; unset for those that nothing hides. Throws NodeError("other_lights") where it
// has one that belongs to none of the sources.
std::vector<RealPlane> read_visible_lights(const Tiled<Image>&, std::size_t sources, Precision);

}  // namespace frustum
