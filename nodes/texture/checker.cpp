#include "nodes/texture/checker.h"

#include "nodes/texture.h"
#include "runtime/buffers/texture.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  double scale = 8;
  Color even{glm::dvec3{1}}, odd{glm::dvec3{0}};
};
struct Outputs {
  Ref<Texture> texture;
};

void check(const Params& p) {
  if (!is_checker_scale(p.scale))
    throw NodeError("bad_scale", "the scale of a checkerboard is a finite positive number",
                    at_param("scale"));
}

Outputs run(const Inputs&, const Params& p, Context&) {
  return {std::make_shared<Texture>(Texture{Checker{p.scale, p.even.rgb, p.odd.rgb}})};
}

}  // namespace

NodeType nodes::texture_checker() {
  return node("texture.checker", run)
      .doc("Makes a checkerboard by formula, which filters without error at any size.")
      .covers(30)
      .param("scale", &Params::scale, "Squares per unit of u and of v; raising it makes them smaller.",
             {.unit = "squares", .range = above(0)})
      .param("even", &Params::even, "Colour of the square at (0, 0), linear Rec.709.", {.range = at_least(0)})
      .param("odd", &Params::odd, "Colour of its neighbours, linear Rec.709.", {.range = at_least(0)})
      .check(check)
      .output("texture", &Outputs::texture, "The checkerboard.");
}

}  // namespace frustum
