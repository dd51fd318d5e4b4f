// From the materials and lights of a scene to what shading computes with, in the precision of a node.
#pragma once

#include "nodes/kernels/shading_scene.h"
#include "runtime/buffers/camera.h"
#include "runtime/buffers/lit_scene.h"

namespace frustum {

// What was decided about the effects of shading.
struct ShadingEffects {
  bool highlights, ambient, attenuation, sides;     // are simulated
  bool all_highlights, all_attenuation, all_sides;  // forced: also where they are known to add nothing
};

template <std::floating_point R>
kernels::Triple<R> eye_of(const Camera& camera) {
  return {static_cast<R>(camera.eye.x), static_cast<R>(camera.eye.y), static_cast<R>(camera.eye.z)};
}

// World positions of the mesh's vertices, three of R each: kept from project.view on, or its own before it; what was never
// placed in the world stands where it is. Throws NodeError("missing_column") or NodeError("wrong_column").
template <std::floating_point R>
Ref<Column> world_positions(const Mesh&);

// The scene's lights and materials; neither sides nor opacities of faces are set. Throws NodeError("missing_camera") or
// NodeError("bad_material").
//   camera      may be null where no surface has a highlight or two sides
//   two_sided   all surfaces are, whatever their materials say
template <std::floating_point R>
kernels::ShadingScene<R> make_shading_scene(const LitScene&, const Camera* camera, bool two_sided,
                                            const ShadingEffects&);

}  // namespace frustum
