#include "nodes/light/directional.h"

#include "nodes/light.h"
#include "runtime/buffers/light.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  glm::dvec3 direction{-1, -2, -1};
  Color color{glm::dvec3{1}};
};
struct Outputs {
  Ref<LightSet> light;
};

void check(const Params& p) {
  if (!travel_direction(p.direction))
    throw NodeError("zero_direction", "the direction of the light has no length", at_param("direction"));
}

Outputs run(const Inputs&, const Params& p, Context&) {
  return {one_light(Light{.kind = Light::Kind::directional,
                          .color = p.color.rgb,
                          .direction = travel_direction(p.direction).value()})};
}

}  // namespace

NodeType nodes::light_directional() {
  return node("light.directional", run)
      .doc("Makes a light so far away that its rays are parallel, such as the sun.")
      .covers(62)
      .param("direction", &Params::direction,
             "The way the light travels, in world space; its length does not matter.")
      .param("color", &Params::color, "Linear Rec.709; a white surface facing the light gets this colour.",
             {.range = at_least(0)})
      .check(check)
      .output("light", &Outputs::light, "The light, for the lights of shade.surface.");
}

}  // namespace frustum
