// The node tree of a glTF scene, flattened: what stands where.
#pragma once

#include "runtime/buffers/camera.h"
#include "runtime/buffers/light.h"
#include "runtime/io/gltf_json.h"
#include "runtime/io/gltf_notes.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace frustum::gltf {

// p -> linear p + translation.
struct Placement {
  glm::dmat3 linear{1};
  glm::dvec3 translation{0};
};

struct Instance {
  std::size_t mesh = 0;
  Placement world_from_mesh;
};

struct NamedCamera {
  std::string node, name;  // as the file calls the node and the camera; may be empty
  Camera camera;
};

struct Flattened {
  std::vector<Instance> instances;
  std::vector<NamedCamera> cameras;
  std::vector<Light> lights;
};

// Walks the default scene (`scene`, else the first one, else every node that is no child), parents before
// children, in the file's order. Placements are exact for translations, scales and quarter turns, whatever
// the length of the quaternion. Skinned meshes stand where their file's bind pose puts them: the node's own
// transform does not count (glTF 2.0, 3.7.3.3).
//
// Lights (KHR_lights_punctual) shine in lux and candela; ours are radiance factors, of which 1 on a white
// Lambert surface is 1. Such a surface under E lux sends out E / pi cd/m^2, so a directional light of
// intensity I has colour I / pi, and a point light of I candela I / pi at distance 1, falling with the square.
//
// Throws NodeError("malformed_file") for a node that is its own ancestor or has two parents, and for whatever
// has no place: a quaternion without length, a matrix that is not affine.
Flattened flatten(const Object& document, Notes& notes);

}  // namespace frustum::gltf
