#include "nodes/light/spot.h"

#include "nodes/light.h"
#include "runtime/buffers/light.h"
#include "runtime/core/node_type.h"

#include <numbers>

namespace frustum {
namespace {

constexpr double radians = std::numbers::pi / 180;

struct Inputs {};
struct Params {
  glm::dvec3 position{0, 5, 0}, direction{0, -1, 0};
  Color color{glm::dvec3{1}};
  glm::dvec3 attenuation{1, 0, 0};
  double inner = 20, outer = 30;
};
struct Outputs {
  Ref<LightSet> light;
};

void check(const Params& p) {
  if (const auto fault =
          fault_of_spot({p.position, p.direction, p.attenuation, p.inner * radians, p.outer * radians}))
    throw NodeError(std::string(fault->code), std::string(fault->what), at_param(fault->param));
}

Outputs run(const Inputs&, const Params& p, Context&) {
  return {one_light(Light{.kind = Light::Kind::spot,
                          .color = p.color.rgb,
                          .direction = kernels::normalized(p.direction).value(),
                          .position = p.position,
                          .attenuation = p.attenuation,
                          .inner = p.inner * radians,
                          .outer = p.outer * radians})};
}

}  // namespace

NodeType nodes::light_spot() {
  return node("light.spot", run)
      .doc("Makes a light that shines from one point into a cone, such as a lamp with a shade.")
      .cite("Khronos glTF extension KHR_lights_punctual, inner and outer cone angles")
      .covers(62)
      .param("position", &Params::position,
             "Where the light is, in world space; it does not light a point it lies on.")
      .param("direction", &Params::direction,
             "The axis of the cone, in world space; its length does not matter.")
      .param("color", &Params::color, "Linear Rec.709, on the axis where the attenuation is 1.",
             {.range = at_least(0)})
      .param("attenuation", &Params::attenuation,
             "x, y, z: the colour is divided by x + y d + z d^2, d the distance; raising one dims the light.",
             {.range = at_least(0)})
      .param("inner", &Params::inner,
             "Angle from the axis up to which the light is full; raising it to outer makes a hard edge.",
             {.unit = "degrees", .range = between(0, 90)})
      .param("outer", &Params::outer, "Angle from the axis where the light ends; raising it lights more.",
             {.unit = "degrees", .range = {.low = 0, .high = 90, .open_low = true}})
      .check(check)
      .output("light", &Outputs::light, "The light, for the lights of shade.surface.");
}

}  // namespace frustum
