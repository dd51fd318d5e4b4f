#include "runtime/buffers/screen_view.h"

#include <fmt/format.h>

namespace frustum {

Rect picture_window(const Mesh& mesh) {
  if (!mesh.camera)
    throw NodeError("no_camera", "the mesh has passed no projection, so its picture has no resolution",
                    at_input("mesh"));
  return picture_window(*mesh.camera);
}

Rect picture_window(const Camera& camera) {
  const glm::ivec2 size = camera.resolution;
  constexpr int limit = 65536;
  if (size.x > limit || size.y > limit)
    throw NodeError("too_large", fmt::format("the picture is {} x {} pixels; at most {} x {} can be drawn",
                                             size.x, size.y, limit, limit));
  return {0, 0, size.x, size.y};
}

kernels::SamplePositions sample_positions(const SamplePattern* pattern) {
  if (pattern == nullptr) return kernels::centre_sample();
  return {pattern->samples, pattern->period, pattern->x, pattern->y};
}

kernels::DepthOrder depth_order(const Mesh& mesh) {
  return kernels::is_reversed(clip_space(mesh.camera.get()).depth) ? kernels::DepthOrder::reversed
                                                                   : kernels::DepthOrder::standard;
}

int corner_bits_of(const Mesh& mesh) {
  return mesh.camera ? mesh.camera->subpixel_bits : kernels::corner_bits;
}

}  // namespace frustum
