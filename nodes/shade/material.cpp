#include "nodes/shade/material.h"

#include "nodes/shade.h"
#include "runtime/buffers/material.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  std::string name = {};
  Reflection model = Reflection::blinn;
  Color ambient{glm::dvec3{1}}, diffuse{glm::dvec3{0.8}}, specular{glm::dvec3{0}};
  double shininess = 32;
  Color emission{glm::dvec3{0}};
  bool two_sided = false;
  bool unlit = false;
};
struct Outputs {
  Ref<Material> material;
};

double lobe_of(const Material& m) {
  switch (m.model) {
    case Reflection::lambert: return 0;
    case Reflection::phong: return kernels::phong_reflectance(m.shininess);
    case Reflection::blinn: break;
  }
  return kernels::blinn_reflectance(m.shininess);
}

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  const Material m{.name = p.name,
                   .model = p.model,
                   .ambient = p.ambient.rgb,
                   .diffuse = p.diffuse.rgb,
                   .specular = p.specular.rgb,
                   .shininess = p.shininess,
                   .emission = p.emission.rgb,
                   .two_sided = p.two_sided,
                   .unlit = p.unlit};
  if (const double share = largest_reflectance(m.diffuse, m.specular, lobe_of(m)); share > 1)
    ctx.warn("makes_energy",
             fmt::format("the surface sends back {:.3g} of the light that falls on it", share));
  return {std::make_shared<Material>(m)};
}

}  // namespace

NodeType nodes::shade_material() {
  return node("shade.material", run)
      .doc("Says how a surface reflects light: Lambert, with a Phong or Blinn highlight.")
      .cite("Lambert 1760; Phong 1975, doi:10.1145/360825.360839; Blinn 1977, doi:10.1145/563858.563893")
      .covers(49, 50)
      .param("name", &Params::name,
             "For people, files, and nodes that choose faces by what they are made of.")
      .param("model", &Params::model,
             "lambert has no highlight; phong mirrors the light, blinn uses the half vector.")
      .param("ambient", &Params::ambient, "Share of ambient light reflected, times the diffuse colour.",
             {.range = at_least(0)})
      .param("diffuse", &Params::diffuse, "Share of light scattered alike in all directions, linear Rec.709.",
             {.range = at_least(0)})
      .param("specular", &Params::specular, "Brightness of the highlight at its peak; a number is grey.",
             {.range = at_least(0)})
      .param("shininess", &Params::shininess,
             "Exponent of the highlight; raising it makes the highlight smaller.", {.range = between(0, 1e6)})
      .param("emission", &Params::emission,
             "Light of the surface's own, added to what it reflects; it lights nothing else.",
             {.range = at_least(0)})
      .param("two_sided", &Params::two_sided,
             "Whether backs are lit as if turned around; cull.backface keeps them where it is told.")
      .param("unlit", &Params::unlit, "Whether it shows its diffuse colour and texture whatever the light.")
      .output("material", &Outputs::material, "The material, for shade.surface.");
}

}  // namespace frustum
