#include "nodes/vector/frame.h"

#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace vector {
enum class Direction : std::uint8_t { to_world, to_frame };
constexpr auto choices(Direction) {
  return std::array{std::pair{Direction::to_world, "to_world"}, std::pair{Direction::to_frame, "to_frame"}};
}
}  // namespace vector

namespace {

using vector::Direction;
using Rows = std::variant<Ref<Points>, Ref<Vectors>>;

struct Inputs {
  Rows rows;
};
struct Params {
  glm::dvec3 origin{0}, a{1, 0, 0}, b{0, 1, 0}, c{0, 0, 1};
  Direction direction = Direction::to_world;
  double least_rcond = 1e-12;
};
struct Outputs {
  Rows rows;
  Ref<Matrix> matrix, inverse;
  Ref<Number> rcond;
};

void check(const Params& p) {
  const auto frame = vector::frame_of(p.origin, p.a, p.b, p.c);
  if (!frame)
    throw NodeError("singular_frame", "the three vectors lie in a plane: they are no coordinate system",
                    at_param("c"));
  if (frame->rcond < p.least_rcond)
    throw NodeError(
        "singular_frame",
        fmt::format("the three vectors nearly lie in a plane: their reciprocal condition is {:.1e}, "
                    "below {:.1e}, so some {:.0f} of 16 digits would be lost",
                    frame->rcond, p.least_rcond, -std::log10(frame->rcond)),
        at_param("c"));
}

Rows converted(const Rows& rows, const vector::Frame& f, Direction direction) {
  const bool out = direction == Direction::to_world;
  if (const auto* points = std::get_if<Ref<Points>>(&rows)) {
    auto to = std::make_shared<Points>();
    for (const glm::dvec3& p : (*points)->at) to->at.push_back(out ? f.world_point(p) : f.frame_point(p));
    return Ref<Points>(std::move(to));
  }
  auto to = std::make_shared<Vectors>();
  for (const glm::dvec3& v : std::get<Ref<Vectors>>(rows)->along)
    to->along.push_back(out ? f.world_vector(v) : f.frame_vector(v));
  return Ref<Vectors>(std::move(to));
}

Outputs run(const Inputs& in, const Params& p, Context&) {
  const vector::Frame f = vector::frame_of(p.origin, p.a, p.b, p.c).value();
  return {converted(in.rows, f, p.direction), std::make_shared<Matrix>(Matrix{f.world_from_frame()}),
          std::make_shared<Matrix>(Matrix{f.frame_from_world()}), std::make_shared<Number>(Number{f.rcond})};
}

}  // namespace

NodeType nodes::vector_frame() {
  return node("vector.frame", run)
      .doc("Coordinates of points and vectors in a system of three vectors and an origin, and back.")
      .cite("Higham 2002, Accuracy and Stability of Numerical Algorithms, section 14.6; errata E5")
      .covers(9)
      .input("rows", &Inputs::rows, "Points, which know the origin, or vectors, which do not.")
      .param("origin", &Params::origin, "Where the system's (0, 0, 0) lies in the world.")
      .param("a", &Params::a, "The system's (1, 0, 0) in the world.")
      .param("b", &Params::b, "The system's (0, 1, 0).")
      .param("c", &Params::c, "The system's (0, 0, 1).")
      .param("direction", &Params::direction,
             "From coordinates in the system to the world, or the other way.")
      .param("least_rcond", &Params::least_rcond,
             "Axes of a smaller reciprocal condition are refused; lowering it takes flatter ones.",
             {.range = between(0, 1)})
      .check(check)
      .output("rows", &Outputs::rows, "The same points or vectors in the other system.")
      .output("matrix", &Outputs::matrix, "From the system to the world: the columns a b c O.")
      .output("inverse", &Outputs::inverse, "From the world to the system.")
      .output("rcond", &Outputs::rcond,
              "1 for axes at right angles of any lengths, towards 0 as they become flat.");
}

}  // namespace frustum
