#include "nodes/vector/make.h"

#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  std::vector<glm::dvec3> points, vectors;
  int repeat = 0;
  glm::dvec3 step{0};
};
struct Outputs {
  Ref<Points> points;
  Ref<Vectors> vectors;
};

Outputs run(const Inputs&, const Params& p, Context&) {
  return {
      std::make_shared<Points>(Points{vector::rows_of(p.points, static_cast<std::size_t>(p.repeat), p.step)}),
      std::make_shared<Vectors>(Vectors{p.vectors})};
}

}  // namespace

NodeType nodes::vector_make() {
  return node("vector.make", run)
      .doc(
          "Makes points (w = 1) and vectors (w = 0) of numbers; a link that takes one for the other is "
          "refused.")
      .cite("Errata E5; homogeneous coordinates after Moebius 1827")
      .covers(4)
      .param("points", &Params::points, "Places; x, y and z.")
      .param("vectors", &Params::vectors, "Directions with a length; x, y and z.")
      .param("repeat", &Params::repeat, "Further points after the last one; raising it makes more.",
             {.range = between(0, 1000000)})
      .param("step", &Params::step, "From each of the further points to the next.")
      .output("points", &Outputs::points, "The points, as one row each.")
      .output("vectors", &Outputs::vectors, "The vectors, as one row each.");
}

}  // namespace frustum
