#include "nodes/transform/slerp.h"

#include "nodes/kernels/quaternion.h"
#include "nodes/transform.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <numbers>

namespace frustum {
namespace {

struct Inputs {
  Ref<Matrix> from, to;
};
struct Params {
  double t = 0.5;
};
struct Outputs {
  Ref<Matrix> matrix;
  Ref<Number> angle;
};

// The quaternion of a matrix that has to be a rotation.
glm::dvec4 rotation_in(const Matrix& m, const char* input) {
  const glm::dmat3 r(m.value);
  const glm::dmat3 off = glm::transpose(r) * r - glm::dmat3(1.0);
  const double size = kernels::largest_component(off[0]) + kernels::largest_component(off[1]) +
                      kernels::largest_component(off[2]);
  if (!(size < 1e-6) || kernels::determinant_sign(r[0], r[1], r[2]) <= 0)
    throw NodeError("no_rotation",
                    "the matrix is no rotation: its axes are not of length 1 and at right angles, or "
                    "left-handed; transform.decompose finds the rotation in it",
                    at_input(input));
  return kernels::quaternion_of(r);
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const glm::dvec4 a = rotation_in(*in.from, "from"), b = rotation_in(*in.to, "to");
  // Of two quaternions half a right angle and more apart, one's negative is nearer.
  const double apart = 2 * std::min(transform::arc(a, b), transform::arc(a, -b));
  if (std::numbers::pi - apart < 0x1p-26)
    ctx.warn("opposite_rotations",
             "the rotations are half a turn apart, and two ways between them are equally short");
  const glm::dvec4 q = transform::slerp(a, b, p.t);
  const auto turn = kernels::quaternion_rotation(q.x, {q.y, q.z, q.w});
  return {std::make_shared<Matrix>(Matrix{kernels::matrix_of(turn.value())}),
          std::make_shared<Number>(Number{apart * 180 / std::numbers::pi})};
}

}  // namespace

NodeType nodes::transform_slerp() {
  return node("transform.slerp", run)
      .doc("The rotation part of the way between two, at constant speed and by one axis: no gimbal locks.")
      .cite("Shoemake 1985, Animating rotation with quaternion curves; Shepperd 1978; Kahan 2006")
      .covers(13)
      .input("from", &Inputs::from, "A rotation; what it moves by is not looked at.")
      .input("to", &Inputs::to, "Another one.")
      .param("t", &Params::t, "How far: 0 is the first, 1 the second; beyond, it turns on.")
      .output("matrix", &Outputs::matrix, "The rotation between them.")
      .output("angle", &Outputs::angle, "Between the two, in degrees: 0 to 180.");
}

}  // namespace frustum
