// Meshes whose positions have moved to another space: what the nodes that project have in common.
#pragma once

#include "nodes/kernels/camera.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"

#include <cstdint>
#include <span>

namespace frustum {

// The mesh with new positions: map(from, to) gets the old ones as From and fills as many To. All other
// columns are shared. Claims their memory before it takes it. Throws NodeError("narrowing") for double positions in a
// single precision From.
template <class From, class To, class Map>
Mesh with_positions(const Mesh& mesh, Space space, Context& ctx, const Map& map) {
  const auto from = mesh.real<typename From::value_type>("position");
  ctx.claim(from->rows() * sizeof(To));
  auto to = Column::make<To>("position", Domain::vertex, from->rows(), space);
  map(from->template values<From>(), to->template values<To>());
  return mesh.with(std::move(to));
}

// Eye space to clip space, in the precision of the context; the mesh keeps the camera, for what comes after.
Ref<Mesh> in_clip_space(const Mesh& mesh, const Ref<Camera>& camera, const kernels::Projection& volume,
                        Context& ctx);

// Without the faces that have a corner v with no_point[v] != 0, which are counted in a warning: they lie on
// or behind the plane of the eye, or are not finite, and a divide by w gives them no place.
Mesh without_unplaced(const Mesh& mesh, std::span<const std::uint8_t> no_point, Context& ctx);

}  // namespace frustum
