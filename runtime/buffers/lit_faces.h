// Light on the faces and vertices of a mesh: what flat and Gouraud shading find before any pixel.
#pragma once

#include "nodes/kernels/face_light.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"

#include <vector>

namespace frustum {

// Owns what a kernels::FaceLight looks at.
template <std::floating_point R>
struct LitFaces {
  using Domain = typename kernels::FaceLight<R>::Domain;
  Domain domain = Domain::face;
  std::vector<kernels::Received<R>> received;
  Ref<Column> screen;  // null for faces

  kernels::FaceLight<R> view(const Mesh& mesh) const {
    using V4 = glm::vec<4, R>;
    return {domain, received, mesh.triangles(), screen ? screen->values<V4>() : std::span<const V4>()};
  }
};

// By face +1, or -1 where its surface has two sides and the eye sees its back. Throws
// NodeError("missing_column").
template <std::floating_point R>
std::vector<R> sides_of_faces(const kernels::ShadingScene<R>&, const Mesh&, const Context&);

// Each face once, at its centroid with its own normal.
template <std::floating_point R>
LitFaces<R> light_faces(const kernels::ShadingScene<R>&, const Mesh&, const Context&);

// The vertices, or each corner where a vertex does not look the same from all of its faces. Throws
// NodeError("wrong_space") for a mesh that is not on the screen, "missing_column" and "wrong_column".
template <std::floating_point R>
LitFaces<R> light_vertices(const kernels::ShadingScene<R>&, const Mesh&, const Context&);

// By face (flat) or by vertex: all light together, or that of each light of the scene apart.
template <std::floating_point R>
std::vector<LitFaces<R>> light_by_source(const kernels::ShadingScene<R>&, const Mesh&, bool flat, bool apart,
                                         const Context&);

}  // namespace frustum
