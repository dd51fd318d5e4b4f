// What the lights and materials of a mesh call for: facts from which nodes that shade decide their effects.
//
// Every certificate here needs colours that are finite and not huge: with those, whatever a term is that is left out,
// times a colour of 0 it is 0, and never the NaN of 0 times infinity.
#pragma once

#include "runtime/buffers/light.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"
#include "runtime/core/effect.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace frustum {

// The mesh's own materials; of a mesh without any, the usual one.
std::vector<Ref<Material>> materials_of(const Mesh&);

struct LitScene {
  const Mesh& mesh;
  std::vector<Ref<Material>> materials;  // at least one; faces take theirs by the mesh's column "material"
  std::span<const Ref<LightSet>> lights;

  // The index of a material that some face has and `is` holds for; null where there is none. Linear in the faces.
  std::optional<std::size_t> used(const std::function<bool(const Material&)>& is) const;
  // The n-th light of all sets for which `is` holds, and n.
  std::optional<std::size_t> light(const std::function<bool(const Light&)>& is) const;
};

// "material \"clay\"", "material 3", or "the material" of one without a name.
std::string name_of_material(std::span<const Ref<Material>> materials, std::size_t index);

// Whether the light grows weaker with the distance from where it shines.
bool falls_off(const Light&);

// Whether highlights reach the eye: a surface has one, and a light that is not ambient shines.
Verdict needs_highlights(const LitScene&, std::uint64_t points);
// Whether ambient light, or a surface that shows its colour without light, adds anything.
Verdict needs_ambient(const LitScene&, std::uint64_t points);
// Whether the light of a point light depends on the distance.
Verdict needs_attenuation(const LitScene&, std::uint64_t points);

// Whether a face with two sides, or any where all have two, turns its back to the camera.
Verdict needs_sides(const LitScene&, bool all, const Camera*, std::uint64_t points, const Context&);

// Absent where a light shines on a surface and something may stand between them. It cannot for a closed mesh in convex
// position (no vertex lies in front of any face's plane), which is found out for small ones. A mesh that is not known to
// be closed may have lost what casts a shadow to clipping and culling.
//   position  world space, one a vertex; empty: not known
// Cost: up to 2^20 dot products.
Verdict needs_shadows(const LitScene&, std::span<const glm::dvec3> position);
// The same with the mesh's own positions, where it keeps any of world space.
Verdict needs_shadows(const LitScene&);

}  // namespace frustum
