#include "nodes/project/planar.h"

#include "nodes/project.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace project {
constexpr auto choices(Planar) {
  return std::array{std::pair{Planar::orthographic, "orthographic"},
                    std::pair{Planar::perspective, "perspective"}};
}
}  // namespace project

namespace {

struct Inputs {
  Ref<Points> points;
};
struct Params {
  project::Planar kind = project::Planar::perspective;
  double distance = 1;
};
struct Outputs {
  Ref<Points> points;
  Ref<Matrix> matrix;
};

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  auto out = std::make_shared<Points>();
  for (const glm::dvec3& at : in.points->at)
    if (const auto q = project::projected(at, p.kind, p.distance)) out->at.push_back(*q);
  const std::size_t lost = in.points->at.size() - out->at.size();
  if (lost > 0)
    ctx.warn("points_behind_the_eye",
             fmt::format(
                 "{} points were left out: at z >= 0 they lie beside or behind the eye, which looks along -z",
                 lost));
  ctx.count("points_left_out", lost);
  return {std::move(out), std::make_shared<Matrix>(Matrix{project::planar_matrix(p.kind, p.distance)})};
}

}  // namespace

NodeType nodes::project_planar() {
  return node("project.planar", run)
      .doc("Projects points onto the plane z = -N in front of an eye at the origin, and forgets their depth.")
      .cite("Errata E9: right as projections, of rank 3, and no base for clipping and depth")
      .covers(17, 18, 19)
      .input("points", &Inputs::points, "In eye space; the eye looks along -z.")
      .param("kind", &Params::kind, "Along z, or through the eye: twice as far away is half as large.")
      .param("distance", &Params::distance,
             "N, of the plane from the eye; raising it enlarges the perspective.", {.range = above(0)})
      .output("points", &Outputs::points, "On the plane; those the eye cannot see are left out.")
      .output("matrix", &Outputs::matrix, "The homogeneous matrix: divide by w after it.");
}

}  // namespace frustum
