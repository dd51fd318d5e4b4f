#include "nodes/project/mvp.h"

#include "nodes/kernels/matrix.h"
#include "nodes/kernels/matrix_product.h"
#include "nodes/project.h"
#include "runtime/buffers/camera.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace project {
enum class Volume : std::uint8_t { perspective, orthographic };
constexpr auto choices(Volume) {
  return std::array{std::pair{Volume::perspective, "perspective"},
                    std::pair{Volume::orthographic, "orthographic"}};
}
}  // namespace project

namespace {

struct Inputs {
  Ref<Camera> camera;
  std::optional<Ref<Matrix>> model;
};
struct Params {
  project::Volume volume = project::Volume::perspective;
};
struct Outputs {
  Ref<Matrix> matrix, viewport, projection, view, model, camera;
  Ref<Table> conditions;
};

Ref<Matrix> of(const glm::dmat4& m) { return std::make_shared<Matrix>(Matrix{m}); }

kernels::Projection projection_of(const Camera& c, project::Volume volume) {
  const bool good =
      c.resolution.x > 0 && c.resolution.y > 0 && c.near_z < c.far_z &&
      (volume == project::Volume::perspective ? c.near_z > 0 && c.fov_y > 0 && c.fov_y < 3.14159265358979
                                              : c.height > 0 && std::isfinite(c.far_z));
  if (!good)
    throw NodeError("impossible_camera",
                    "the camera's near and far planes, angle, height or resolution make no volume",
                    at_input("camera"));
  if (volume == project::Volume::orthographic)
    return kernels::orthographic(c.height, c.aspect(), c.near_z, c.far_z, clip_space(&c));
  return kernels::perspective(c.fov_y, c.aspect(), c.near_z, c.far_z, clip_space(&c));
}

// How well each factor, and their product, can be undone.
Table conditions_of(std::span<const std::pair<const char*, glm::dmat4>> factors) {
  Table t;
  t.columns = {{.name = "matrix"}, {.name = "rcond"}};
  for (const auto& [name, m] : factors) {
    const auto back = kernels::inverse<4>(m);
    t.columns[0].texts.emplace_back(name);
    t.columns[1].numbers.push_back(back ? back->rcond : 0);
  }
  return t;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const Camera& c = *in.camera;
  const glm::dmat4 model = in.model ? (*in.model)->value : glm::dmat4(1.0);
  const auto [view, fault] = kernels::look_at(c.eye, c.target, c.up);
  if (fault == kernels::LookAtFault::no_direction)
    ctx.warn("camera_without_direction", "the camera's eye and target are one point: it looks along -z");
  const glm::dmat4 eye_from_world = kernels::matrix_of(view),
                   world_from_eye = kernels::matrix_of(kernels::inverse(view));
  const glm::dmat4 clip_from_eye = kernels::matrix_of(projection_of(c, p.volume));
  const glm::dmat4 pixels_from_ndc = project::viewport_matrix(viewport_of(c));
  glm::dmat4 all = model;
  for (const glm::dmat4& next : {eye_from_world, clip_from_eye, pixels_from_ndc})
    all = kernels::matrix_product(next, all);
  const std::pair<const char*, glm::dmat4> factors[] = {{"M_mod", model},
                                                        {"M_cam^-1", eye_from_world},
                                                        {"M_proj", clip_from_eye},
                                                        {"M_vp", pixels_from_ndc},
                                                        {"M", all}};
  return {of(all),
          of(pixels_from_ndc),
          of(clip_from_eye),
          of(eye_from_world),
          of(model),
          of(world_from_eye),
          std::make_shared<Table>(conditions_of(factors))};
}

}  // namespace

NodeType nodes::project_mvp() {
  return node("project.mvp", run)
      .doc("The matrix from a model to pixels, M = M_vp M_proj M_cam^-1 M_mod, and each of its factors.")
      .cite("Errata E9 to E13: M_vp is the viewport, and w is divided by after M, once clipping is done")
      .covers(22)
      .input("camera", &Inputs::camera, "Where the picture is taken from.")
      .input("model", &Inputs::model,
             "M_mod, from the model to the world; the identity where it is left out.")
      .param("volume", &Params::volume, "Whether things farther away are smaller.")
      .output("matrix", &Outputs::matrix, "The product; divide x, y and z by w after it.")
      .output("viewport", &Outputs::viewport, "M_vp: NDC to pixels, whose y points down.")
      .output("projection", &Outputs::projection, "M_proj: eye to clip space.")
      .output("view", &Outputs::view, "M_cam^-1: world to eye space.")
      .output("model", &Outputs::model, "M_mod, as it came.")
      .output("camera", &Outputs::camera, "M_cam: where the camera stands in the world.")
      .output("conditions", &Outputs::conditions,
              "Reciprocal conditions: 1 loses no digit on the way back, 0 has none.");
}

}  // namespace frustum
