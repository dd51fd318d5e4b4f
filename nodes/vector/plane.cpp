#include "nodes/vector/plane.h"

#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Points> corners;
  std::optional<Ref<Points>> asked;
};
struct Params {};
struct Outputs {
  Ref<Vectors> normal;
  Ref<Table> plane, sides;
};

Table table_of(const vector::Plane& plane) {
  Table t;
  t.columns = {{.name = "quantity",
                .texts = {"a", "b", "c", "d", "area", "farthest_corner", "perimeter_squared_over_area"}},
               {.name = "value",
                .numbers = {plane.normal.x, plane.normal.y, plane.normal.z, plane.d(), plane.area,
                            plane.residual, plane.condition}}};
  return t;
}

Table sides_of(const vector::Plane& plane, std::span<const glm::dvec3> asked) {
  Table t;
  t.columns = {{.name = "x"}, {.name = "y"}, {.name = "z"}, {.name = "distance"}, {.name = "side"}};
  for (const glm::dvec3& p : asked) {
    for (glm::length_t axis = 0; axis < 3; ++axis)
      t.columns[static_cast<std::size_t>(axis)].numbers.push_back(p[axis]);
    t.columns[3].numbers.push_back(plane.distance(p));
    const int side = plane.side(p);
    t.columns[4].texts.emplace_back(side > 0 ? "front" : side < 0 ? "behind" : "in the plane");
  }
  return t;
}

Outputs run(const Inputs& in, const Params&, Context&) {
  const auto& corners = in.corners->at;
  const auto plane = vector::plane_of(corners);
  if (!plane)
    throw NodeError(
        "no_plane",
        fmt::format("{} corners span no plane: they lie on a line, to within rounding", corners.size()),
        at_input("corners"));
  const std::span<const glm::dvec3> asked =
      in.asked ? std::span<const glm::dvec3>((*in.asked)->at) : std::span<const glm::dvec3>();
  return {std::make_shared<Vectors>(Vectors{{plane->normal}}), std::make_shared<Table>(table_of(*plane)),
          std::make_shared<Table>(sides_of(*plane, asked))};
}

}  // namespace

NodeType nodes::vector_plane() {
  return node("vector.plane", run)
      .doc("The plane a x + b y + c z + d = 0 of a polygon, and how far and on which side of it points lie.")
      .cite("Newell's sum: Sutherland, Sproull & Schumacker 1974; Tampieri 1992; sides: Shewchuk 1997")
      .covers(8)
      .input("corners", &Inputs::corners,
             "Three or more, counter-clockwise seen from the front; need not be flat.")
      .input("asked", &Inputs::asked, "Points whose distance and side are asked for.")
      .output("normal", &Outputs::normal, "Of unit length, towards the front.")
      .output("plane", &Outputs::plane, "The coefficients, the polygon's area, how flat and how thin it is.")
      .output("sides", &Outputs::sides,
              "Signed distances; the side is exact for the plane of the three widest corners.");
}

}  // namespace frustum
