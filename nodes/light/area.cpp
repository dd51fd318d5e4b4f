#include "nodes/light/area.h"

#include "nodes/light.h"
#include "runtime/buffers/light.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  glm::dvec3 position{0, 5, 0}, edge_u{1, 0, 0}, edge_v{0, 0, 1};
  Color color{glm::dvec3{10}};
  int samples = 16;
};
struct Outputs {
  Ref<LightSet> light;
};

void check(const Params& p) {
  if (const auto fault = fault_of_area(p.position, p.edge_u, p.edge_v))
    throw NodeError(std::string(fault->code), std::string(fault->what), at_param(fault->param));
}

Outputs run(const Inputs&, const Params& p, Context&) {
  return {one_light(Light{.kind = Light::Kind::area,
                          .color = p.color.rgb,
                          .position = p.position,
                          .edge_u = p.edge_u,
                          .edge_v = p.edge_v,
                          .samples = static_cast<std::uint32_t>(p.samples)})};
}

}  // namespace

NodeType nodes::light_area() {
  return node("light.area", run)
      .doc("Makes a light that is a rectangle, shining alike from all of its front: its shadows are soft.")
      .cite("Lambert 1760, Photometria; Sobol 1967, doi:10.1016/0041-5553(67)90144-9 (where its points lie)")
      .covers(62)
      .param("position", &Params::position, "The middle of the rectangle, in world space.")
      .param("edge_u", &Params::edge_u, "One side, in world space; raising its length enlarges and softens.",
             {.unit = "world units"})
      .param("edge_v", &Params::edge_v,
             "The other side, at a right angle; light goes to where edge_u x edge_v points.",
             {.unit = "world units"})
      .param("color", &Params::color,
             "What the light itself looks like, linear Rec.709; raising it brightens all.",
             {.range = at_least(0)})
      .param("samples", &Params::samples,
             "Points that stand for it; raising it turns steps of shadow into gradients.",
             {.range = between(1, 1024)})
      .knob({"1", "4", "16", "64", "256"},
            "Of n points spread evenly, n^1/2 lie where a shadow's edge cuts the lamp: off by n^-3/4.", -0.75)
      .check(check)
      .output("light", &Outputs::light, "The light, for the lights of shade.surface and shade.shadow.");
}

}  // namespace frustum
