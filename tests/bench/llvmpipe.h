// The peer of frame_bench.cpp: Mesa's software rasterizer draws the same picture through OpenGL 3.3.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace frustum::bench {

struct PeerScene {
  std::span<const glm::vec3> position, normal;  // by vertex, world space
  std::span<const glm::vec2> uv;
  std::span<const glm::uvec3> face;  // counter-clockwise is front
  bool cull;                         // whether back faces are left out
  int samples;                       // 1, or 4 that are shaded once a pixel and then averaged
  glm::mat4 clip_from_world;
  glm::vec3 eye, to_light;  // to_light: unit length
  int width, height;
  int texture_edge;  // an RGBA8 checkerboard of 8 x 8 squares, mipmapped, trilinear
  const std::uint8_t* texture;
};

// Row by row from the bottom: the number of the triangle that is seen, and the depth, 1 where none is.
struct PeerVisibility {
  std::vector<std::uint32_t> face;
  std::vector<float> depth;
};

// Draws into an offscreen RGBA8 and 32-bit float depth target. Shading per pixel: 0.1 ambient and 0.8
// diffuse, both times the texture, and a Blinn highlight of 0.3 with exponent 32.
class Llvmpipe {
 public:
  // Uploads the scene and compiles the shaders. Throws std::runtime_error with what is missing.
  explicit Llvmpipe(const PeerScene&);
  ~Llvmpipe();
  Llvmpipe(const Llvmpipe&) = delete;
  Llvmpipe& operator=(const Llvmpipe&) = delete;

  // Clear, draw, average the samples of a pixel where there are more than one, and wait until it is done.
  void frame();
  // Draws the triangles' numbers, with one sample a pixel; not timed.
  PeerVisibility visibility();
  std::string name() const;  // such as "llvmpipe (LLVM 15.0.6, 256 bits)"

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace frustum::bench
