// The meshes that frame_bench.cpp draws: smooth tori of any fineness, a soup, and layers that fill the screen.
#pragma once

#include "runtime/buffers/mesh.h"

#include <glm/vec3.hpp>

namespace frustum::bench {

// What the camera of all frames shares: it looks at the origin, 45 degrees high, 16 to 9 wide.
inline constexpr double fov_y_deg = 45, near_z = 0.1, far_z = 100;
inline constexpr int width = 1920, height = 1080;

struct FrameScene {
  Ref<Mesh> mesh;  // position, normal and uv by vertex, in world space
  glm::dvec3 eye;
  bool cull;  // whether back faces are left out
};

// A torus about the y axis, radii 0.7 and 0.3, with a seam where u and v wrap: 2 * columns * rows triangles.
FrameScene torus(int columns, int rows);
// 100,000 triangles of one size anywhere in the picture, turned at random, in random order: eight deep on average.
FrameScene soup();
// Eight pairs of triangles that each fill the picture, the farthest first.
FrameScene layers();

}  // namespace frustum::bench
