#include "nodes/check/energy.h"

#include "nodes/check.h"
#include "runtime/buffers/material.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <algorithm>

namespace frustum {
namespace {

struct Inputs {
  Ref<Material> material;
};
struct Params {
  int angles = 9, order = 64;
};
struct Outputs {
  Ref<Table> table;
  Ref<Number> excess;
};

double largest(const glm::dvec3& c) { return std::max({c.r, c.g, c.b}); }

double highlight_of(const Material& m, double theta, const energy::Gauss& gauss) {
  if (m.unlit || m.model == Reflection::lambert || largest(m.specular) == 0) return 0;
  const auto lobe = m.model == Reflection::phong ? energy::Lobe::phong : energy::Lobe::blinn;
  return energy::highlight_share(lobe, m.shininess, theta, gauss);
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const Material& m = *in.material;
  const energy::Gauss gauss(static_cast<std::size_t>(p.order));
  auto table = std::make_shared<Table>();
  table->columns = {{.name = "angle", .unit = "degrees"},
                    {.name = "diffuse"},
                    {.name = "specular"},
                    {.name = "total"},
                    {.name = "excess"}};
  double worst = 0;
  for (int i = 0; i < p.angles; ++i) {
    ctx.poll();
    const double degrees = 90.0 * i / p.angles;
    const double lobe = highlight_of(m, degrees * std::numbers::pi / 180, gauss);
    const glm::dvec3 diffuse = m.unlit ? glm::dvec3(0) : m.diffuse, specular = m.specular * lobe;
    const double total = largest(diffuse + specular), excess = std::max(0.0, total - 1);
    worst = std::max(worst, excess);
    const double row[] = {degrees, largest(diffuse), largest(specular), total, excess};
    for (std::size_t c = 0; c < 5; ++c) table->columns[c].numbers.push_back(row[c]);
  }
  return {table, std::make_shared<Number>(Number{worst})};
}

}  // namespace

NodeType nodes::check_energy() {
  return node("check.energy", run)
      .doc("Integrates what a surface sends back over the hemisphere, by the angle that light comes from.")
      .cite("Lewis 1994, Making shaders more physically plausible, doi:10.1111/1467-8659.1320109")
      .covers(49)
      .input("material", &Inputs::material, "Its diffuse, specular, shininess and model count.")
      .param("angles", &Params::angles,
             "Angles from 0 below 90 degrees, evenly; raising it looks closer at grazing light.",
             {.range = between(1, 900)})
      .param("order", &Params::order,
             "Points of the quadrature; raising it follows lobes cut by the horizon.",
             {.range = between(4, 512)})
      .knob({"4", "16", "64", "256"},
            "The horizon cuts the lobe: rows of points are off by order^-2, either way, their mean by "
            "order^-5/2.",
            -2.5)
      .output("table", &Outputs::table,
              "By angle: shares of the light sent back, of the strongest channel, and how far they exceed 1.")
      .output("excess", &Outputs::excess, "The largest of these excesses; 0 where no light is made.");
}

}  // namespace frustum
