#include "nodes/transform/decompose.h"

#include "nodes/kernels/quaternion.h"
#include "nodes/transform.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace transform {
constexpr auto choices(Split) {
  return std::array{std::pair{Split::shear, "shear"}, std::pair{Split::turns, "turns"}};
}
}  // namespace transform

namespace {

struct Inputs {
  Ref<Matrix> matrix;
};
struct Params {
  transform::Split into = transform::Split::shear;
};
struct Outputs {
  Ref<Table> parts;
  Ref<Matrix> translation, rotation, shear, scale, turn;
  Ref<Number> error;
};

Ref<Matrix> as_matrix(const glm::dmat3& linear, const glm::dvec3& translation = glm::dvec3(0)) {
  auto m = std::make_shared<Matrix>();
  for (glm::length_t c = 0; c < 3; ++c) m->value[c] = glm::dvec4(linear[c], 0);
  m->value[3] = glm::dvec4(translation, 1);
  return m;
}

glm::dmat3 diagonal(const glm::dvec3& d) {
  glm::dmat3 m(0.0);
  for (glm::length_t i = 0; i < 3; ++i) m[i][i] = d[i];
  return m;
}

class Rows {
 public:
  void add(const char* part, const char* entry, double value) {
    table_.columns[0].texts.emplace_back(part);
    table_.columns[1].texts.emplace_back(entry);
    table_.columns[2].numbers.push_back(value);
  }
  void add(const char* part, const glm::dvec3& v) {
    add(part, "x", v.x), add(part, "y", v.y), add(part, "z", v.z);
  }
  void add(const char* part, const glm::dvec4& q) {
    add(part, "w", q.x), add(part, "x", q.y), add(part, "y", q.z), add(part, "z", q.w);
  }
  Table take() { return std::move(table_); }

 private:
  Table table_{{{.name = "part"}, {.name = "entry"}, {.name = "value"}}};
};

Outputs run(const Inputs& in, const Params& p, Context&) {
  const glm::dmat4& m = in.matrix->value;
  const auto parts = transform::parts_of(m, p.into);
  if (!parts)
    throw NodeError("singular_transform", "the matrix needs the last row 0 0 0 1 and an inverse",
                    at_input("matrix"));
  Rows rows;
  rows.add("translation", parts->translation);
  rows.add("rotation", kernels::quaternion_of(parts->rotation));
  if (p.into == transform::Split::shear) {
    rows.add("shear", "x by y", parts->shear[1][0]);
    rows.add("shear", "x by z", parts->shear[2][0]);
    rows.add("shear", "y by z", parts->shear[2][1]);
  }
  rows.add("scale", parts->scale);
  if (p.into == transform::Split::turns) rows.add("turn", kernels::quaternion_of(parts->turn));
  rows.add("mirrors", "", parts->mirrors() ? 1 : 0);
  const glm::dmat3 linear(m);
  const double error = transform::largest_entry(parts->linear() - linear) / transform::largest_entry(linear);
  rows.add("error", "of the product", error);
  return {std::make_shared<Table>(rows.take()),
          as_matrix(glm::dmat3(1.0), parts->translation),
          as_matrix(parts->rotation),
          as_matrix(parts->shear),
          as_matrix(diagonal(parts->scale)),
          as_matrix(parts->turn),
          std::make_shared<Number>(Number{error})};
}

}  // namespace

NodeType nodes::transform_decompose() {
  return node("transform.decompose", run)
      .doc("Takes an affine map apart: M = translation rotation shear scale turn.")
      .cite("Thomas 1991, Graphics Gems II (decomposing a matrix); Hestenes 1958; Shepperd 1978; errata E6")
      .covers(16)
      .input("matrix", &Inputs::matrix, "An affine map with an inverse.")
      .param("into", &Params::into,
             "shear: one rotation and a shear; turns: two rotations with the scale between, and no shear.")
      .output("parts", &Outputs::parts,
              "Every number: rotations as quaternions, mirrors is 1 where left becomes right.")
      .output("translation", &Outputs::translation, "The last map made.")
      .output("rotation", &Outputs::rotation, "Made after shear and scale, of determinant 1.")
      .output("shear", &Outputs::shear, "Upper triangular with ones on the diagonal.")
      .output("scale", &Outputs::scale, "Along the axes; z is negative where the map mirrors.")
      .output("turn", &Outputs::turn, "Made first; the identity unless split into turns.")
      .output("error", &Outputs::error,
              "Largest entry that the product is off by, over the largest of the map.");
}

}  // namespace frustum
