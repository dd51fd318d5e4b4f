#include "nodes/light/ambient.h"

#include "nodes/light.h"
#include "runtime/buffers/light.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  Color color{glm::dvec3{0.1}};
};
struct Outputs {
  Ref<LightSet> light;
};

void check(const Params& p) {
  if (!is_radiance(p.color.rgb))
    throw NodeError("not_finite", "the colour of the light is not a finite number", at_param("color"));
}

Outputs run(const Inputs&, const Params& p, Context&) {
  return {one_light(Light{.kind = Light::Kind::ambient, .color = p.color.rgb})};
}

}  // namespace

NodeType nodes::light_ambient() {
  return node("light.ambient", run)
      .doc("Makes a light that reaches every point from everywhere alike.")
      .covers(55, 62)
      .param("color", &Params::color, "Linear Rec.709; raising it brightens what no other light reaches.",
             {.range = at_least(0)})
      .check(check)
      .output("light", &Outputs::light, "The light, for the lights of shade.surface.");
}

}  // namespace frustum
