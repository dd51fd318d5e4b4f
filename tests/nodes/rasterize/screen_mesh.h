// Meshes in screen space for the tests of the nodes that rasterize.
#pragma once

#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/pattern.h"
#include "tests/support/run_node.h"
#include "tests/support/ulps.h"

#include <nlohmann/json.hpp>

namespace frustum::test {

template <class R>
struct ScreenMeshMaker {
  std::vector<glm::vec<4, R>> position;  // x_px, y_px, z, 1/w
  std::vector<glm::uvec3> face;
  std::vector<std::pair<std::string, std::vector<glm::vec<2, R>>>> pairs;

  std::uint32_t vertex(double x, double y, double z = 0.5, double per_w = 1) {
    position.emplace_back(static_cast<R>(x), static_cast<R>(y), static_cast<R>(z), static_cast<R>(per_w));
    return static_cast<std::uint32_t>(position.size() - 1);
  }
  std::shared_ptr<Mesh> make(glm::ivec2 resolution, bool reversed_z = false, int subpixel_bits = 8) const {
    auto mesh = std::make_shared<Mesh>();
    mesh->columns.push_back(Column::make("triangle", Domain::face, std::span<const glm::uvec3>(face)));
    mesh->columns.push_back(
        Column::make("position", Domain::vertex, std::span<const glm::vec<4, R>>(position), Space::screen));
    auto camera = std::make_shared<Camera>();
    camera->resolution = resolution;
    camera->reversed_z = reversed_z;
    camera->subpixel_bits = subpixel_bits;
    mesh->camera = camera;
    return mesh;
  }
};

template <class T>
Buffer buffer_of(std::shared_ptr<T> value) {
  return Buffer(Ref<T>(std::move(value)));
}

inline Context with_precision(Precision precision) {
  Context ctx;
  ctx.precision = precision;
  return ctx;
}

}  // namespace frustum::test
