// Where a pixel came from: its samples, the faces seen there, the source triangles of those faces, and the
// node that made them.
#pragma once

#include "runtime/app/session.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace frustum {

// A mesh on the way from the rasterizer up to the node that made it.
struct MeshOnTheWay {
  std::string port;         // "cut.mesh"
  std::uint64_t faces = 0;  // how many of its faces come from the source triangle
  std::uint32_t first = 0;  // the first of them
};

struct SeenTriangle {
  std::uint32_t face = 0;               // of the mesh that was rasterized
  std::uint32_t source_triangle = 0;    // of the mesh as it was made
  std::vector<int> samples;             // in which it is seen
  std::array<glm::dvec3, 3> corners{};  // of the source triangle, in the space in which it was made
  std::vector<MeshOnTheWay> path;       // from the rasterized mesh up to the made one
};

struct Provenance {
  std::string ids;                      // the port whose plane "id" was read: "hits.visibility"
  std::string made_by;                  // the node that made the triangles: "mesh"
  std::string made_type;                // "surface.tessellate"
  SourcePlace made_place;               // where that node stands in its file
  int samples = 0, empty = 0;           // of the pixel; those that see nothing
  std::vector<SeenTriangle> triangles;  // most samples first, then by face
};

// Follows the graph upwards from any pixel port. Runs what is needed for that one pixel; other options
// (threads, cancel) are those of `options`. Null, and a problem, where there are no pixels, no ids or no
// mesh, or where the run fails; `end` says how the run ended.
std::optional<Provenance> provenance(Session&, const Graph&, PortRef port, int x, int y, RunOptions options,
                                     Diagnostics& problems, RunResult::End& end);

Json to_json(const Provenance&);
std::string to_text(const Provenance&);

}  // namespace frustum
