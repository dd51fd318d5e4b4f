#include "tests/fuzz/support/gltf.h"

#include "runtime/io/gltf.h"
#include "tests/fuzz/support/check.h"
#include "tests/support/temp_file.h"

#include <cmath>

namespace frustum::fuzz {
namespace {

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check_view(const GltfScene::View& view) {
  const Camera& c = view.camera;
  require(finite(c.eye) && finite(c.target) && finite(c.up), "a camera stands or looks nowhere");
  require(c.eye != c.target, "a camera looks at itself");
  require(c.near_z > 0 && c.near_z < c.far_z, "a camera's depths are not in order");
  require(c.fov_y > 0 && c.fov_y < 4 && c.height > 0, "a camera sees nothing");
}

void check_light(const Light& light) {
  require(
      finite(light.color) && finite(light.direction) && finite(light.position) && finite(light.attenuation),
      "a light is not finite");
  require(
      light.kind != Light::Kind::spot || (light.inner >= 0 && light.inner < light.outer && light.outer < 1.6),
      "a spot has no cone");
}

}  // namespace

void read_scene(std::string_view input, std::string_view name) {
  static const test::TempFolder folder;
  static const std::string beside = folder.write("beside.bin", std::string(84, '\0'));
  const FilePath file{std::string(name), folder.file(name)};
  reading(file, [&](Context& ctx) {
    ctx.precision = input.size() % 2 == 0 ? Precision::single : Precision::real_double;
    const GltfScene scene = read_gltf(input, file, true, ctx);
    check_mesh(scene.mesh);
    for (const GltfScene::View& view : scene.views) check_view(view);
    for (const Light& light : scene.lights.lights) check_light(light);
  });
}

}  // namespace frustum::fuzz
