#include "runtime/buffers/camera.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <numbers>

namespace frustum {
namespace {

Json json(const glm::dvec3& v) { return {json_number(v.x), json_number(v.y), json_number(v.z)}; }

struct Ops {
  static std::size_t bytes(const Camera& c) { return sizeof c; }
  static void hash(const Camera& c, Hasher& h) {
    for (const glm::dvec3& v : {c.eye, c.target, c.up}) h.value(v.x).value(v.y).value(v.z);
    h.value(c.fov_y).value(c.near_z).value(c.far_z).value(c.height).value(c.reversed_z);
    h.value(c.resolution.x).value(c.resolution.y);
    h.value(c.conventions).value(c.subpixel_bits);
  }
  static void save(const Camera& c, ArchiveWriter& w) {
    for (const glm::dvec3& v : {c.eye, c.target, c.up}) w.raw(&v, sizeof v);
    w.value(c.fov_y).value(c.near_z).value(c.far_z).value(c.height).value(c.reversed_z);
    w.value(c.resolution.x).value(c.resolution.y);
    w.value(c.conventions).value(c.subpixel_bits);
  }
  static Camera load(ArchiveReader& r) {
    Camera c;
    for (glm::dvec3* v : {&c.eye, &c.target, &c.up}) r.raw(v, sizeof *v);
    for (double* v : {&c.fov_y, &c.near_z, &c.far_z, &c.height}) *v = r.value<double>();
    c.reversed_z = r.flag();
    for (int* v : {&c.resolution.x, &c.resolution.y}) *v = r.value<int>();
    c.conventions = r.choice(Conventions::d3d);
    c.subpixel_bits = r.value<int>();
    if (c.subpixel_bits < 4 || c.subpixel_bits > 8) throw ArchiveError("a grid that does not exist");
    return c;
  }
  // far_z may be infinite; as a NaN it still counts.
  static Health health(const Camera& c) {
    const std::pair<std::string_view, double> values[] = {
        {"eye", c.eye.x},
        {"eye", c.eye.y},
        {"eye", c.eye.z},
        {"target", c.target.x},
        {"target", c.target.y},
        {"target", c.target.z},
        {"up", c.up.x},
        {"up", c.up.y},
        {"up", c.up.z},
        {"fov_y", c.fov_y},
        {"near_z", c.near_z},
        {"height", c.height},
        {"far_z", std::isinf(c.far_z) && c.far_z > 0 ? 0 : c.far_z}};
    return health_of("camera", values);
  }
  static Json summary(const Camera& c) {
    return {{"eye", json(c.eye)},
            {"target", json(c.target)},
            {"up", json(c.up)},
            {"fov_y_deg", json_number(c.fov_y * 180 / std::numbers::pi)},
            {"near", json_number(c.near_z)},
            {"far", json_number(c.far_z)},
            {"height", json_number(c.height)},
            {"reversed_z", c.reversed_z},
            {"conventions", choices(c.conventions)[static_cast<std::size_t>(c.conventions)].second},
            {"subpixel_bits", c.subpixel_bits},
            {"resolution_px", {c.resolution.x, c.resolution.y}}};
  }
};

}  // namespace

kernels::ClipSpace clip_space(Conventions conventions, bool reversed_z) {
  using kernels::DepthRange;
  const DepthRange usual =
      conventions == Conventions::gl ? DepthRange::minus_one_to_one : DepthRange::zero_to_one;
  return {reversed_z ? DepthRange::one_to_zero : usual, conventions == Conventions::vulkan};
}

kernels::ClipSpace clip_space(const Camera* camera) {
  return camera == nullptr ? kernels::ClipSpace{} : clip_space(camera->conventions, camera->reversed_z);
}

template <>
const BufferType& buffer_type<Camera>() {
  static const BufferType type =
      make_buffer_type<Camera, Ops>("camera", "Where the picture is taken from, and its size.", "#6fa35c");
  return type;
}

}  // namespace frustum
