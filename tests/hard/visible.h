// Pictures by the algorithms of visibility, and what rays see in whole numbers.
#pragma once

#include "nodes/kernels/depth_sort.h"
#include "nodes/kernels/space_partition.h"
#include "tests/hard/screen.h"

#include <glm/vec2.hpp>

#include <vector>

namespace frustum::stability {
class Random;
}

namespace frustum::hard {

// One sample in the middle of each pixel, ids as `filled` has them.
Picture by_scanline(const kernels::ScreenMesh<float>& mesh, int width, int height);
Picture by_tree(const kernels::ScreenMesh<float>& mesh, int width, int height,
                const bsp::Options& options = {}, bsp::Tree* tree = nullptr);
Picture by_depth_sort(const kernels::ScreenMesh<float>& mesh, int width, int height,
                      depth_sort::Counts* counts = nullptr, std::vector<std::uint32_t>* sources = nullptr);

// Pixels whose ids differ, and whether all ids and the bits of all depths are the same.
std::size_t pixels_apart(const Picture& a, const Picture& b);
bool same_bits(const Picture& a, const Picture& b);

// Corners on the grid of 2^-8 px, at most 2^11 px away; depths in units of 2^-20 in [0, 1]; no side longer
// than 64 px, no height below 1 px, so that rounding moves no depth by 2^-15.
void add_random_face(ScreenTriangles& mesh, stability::Random& random, int width, int height,
                     std::uint32_t source);

// The nearest source at each pixel's middle, of such faces: exact in 128 bits. `unsure` where a side of a
// face that could be seen runs through it, or two faces are less than 2^-14 apart.
inline constexpr std::uint32_t unsure = kernels::no_face - 1;
std::vector<std::uint32_t> seen_by_rays(const ScreenTriangles& mesh, int width, int height);
std::size_t wrong_pixels(const Picture& picture, const std::vector<std::uint32_t>& rays);

// A polygon of the textbook's BSP tree, (x_px, y_px, depth).
struct Polygon {
  std::vector<glm::vec3> corner;
  std::uint32_t source;
};
std::vector<Polygon> polygons_of(const ScreenTriangles& mesh);
// Fuchs, Kedem & Naylor as it is taught, in float: the first polygon divides the others, its plane is that of
// its first three corners, pieces get new corners. Back to front for the camera.
std::vector<Polygon> textbook_tree(std::vector<Polygon> polygons);
// Each over what is there.
Picture painted(const std::vector<Polygon>& polygons, int width, int height);

}  // namespace frustum::hard
