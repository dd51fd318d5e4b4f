#include "nodes/light/point.h"

#include "nodes/light.h"
#include "runtime/buffers/light.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  glm::dvec3 position{0, 5, 0};
  Color color{glm::dvec3{1}};
  glm::dvec3 attenuation{1, 0, 0};
};
struct Outputs {
  Ref<LightSet> light;
};

void check(const Params& p) {
  if (const auto fault = fault_of_point(p.position, p.attenuation))
    throw NodeError(std::string(fault->code), std::string(fault->what), at_param(fault->param));
}

Outputs run(const Inputs&, const Params& p, Context&) {
  return {one_light(Light{.kind = Light::Kind::point,
                          .color = p.color.rgb,
                          .position = p.position,
                          .attenuation = p.attenuation})};
}

}  // namespace

NodeType nodes::light_point() {
  return node("light.point", run)
      .doc("Makes a light that shines from one point in all directions.")
      .covers(62)
      .param("position", &Params::position,
             "Where the light is, in world space; it does not light a point it lies on.")
      .param("color", &Params::color, "Linear Rec.709, where the attenuation is 1.", {.range = at_least(0)})
      .param("attenuation", &Params::attenuation,
             "x, y, z: the colour is divided by x + y d + z d^2, d the distance; raising one dims the light.",
             {.range = at_least(0)})
      .check(check)
      .output("light", &Outputs::light, "The light, for the lights of shade.surface.");
}

}  // namespace frustum
