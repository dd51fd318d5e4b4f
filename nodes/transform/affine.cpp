#include "nodes/transform/affine.h"

#include "nodes/kernels/move_points.h"
#include "nodes/transform.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/surface.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <cstring>

namespace frustum {
namespace kernels {
constexpr auto choices(EulerOrder) {
  return std::array{std::pair{EulerOrder::xyz, "xyz"}, std::pair{EulerOrder::xzy, "xzy"},
                    std::pair{EulerOrder::yxz, "yxz"}, std::pair{EulerOrder::yzx, "yzx"},
                    std::pair{EulerOrder::zxy, "zxy"}, std::pair{EulerOrder::zyx, "zyx"}};
}
}  // namespace kernels
namespace {

enum class Axis : int { x, y, z };
constexpr auto choices(Axis) {
  return std::array{std::pair{Axis::x, "x"}, std::pair{Axis::y, "y"}, std::pair{Axis::z, "z"}};
}

struct AxisTurn {
  glm::dvec3 axis{0, 1, 0};
  double degrees = 0;
};
void describe(Fields<AxisTurn>& f) {
  f.field("axis", &AxisTurn::axis, "Axis through the origin, of any length but zero.")
      .field("degrees", &AxisTurn::degrees,
             "Counter-clockwise seen against the axis; quarter turns are exact.", {.unit = "degrees"});
}

struct EulerTurn {
  glm::dvec3 degrees{0};
  kernels::EulerOrder order = kernels::EulerOrder::xyz;
};
void describe(Fields<EulerTurn>& f) {
  f.field("degrees", &EulerTurn::degrees, "Turns about x, y and z.", {.unit = "degrees"})
      .field("order", &EulerTurn::order, "Which turn is made first, second and third, about fixed axes.");
}

struct Shear {
  Axis move = Axis::x, by = Axis::y;
  double amount = 0;
};
void describe(Fields<Shear>& f) {
  f.field("move", &Shear::move, "The coordinate that changes.")
      .field("by", &Shear::by, "The coordinate it grows with; another one.")
      .field("amount", &Shear::amount,
             "How much it grows for each unit of the other; raising it slants more.");
}

struct Step {
  std::optional<glm::dvec3> translate;
  std::optional<AxisTurn> rotate;
  std::optional<EulerTurn> euler;
  std::optional<glm::dvec4> quaternion;
  std::optional<glm::dvec3> scale;
  std::optional<Shear> shear;
  std::optional<glm::dmat4> matrix;
};
void describe(Fields<Step>& f) {
  f.field("translate", &Step::translate, "Moves by a vector.", {.unit = "world units"})
      .field("rotate", &Step::rotate, "Turns about an axis.")
      .field("euler", &Step::euler, "Turns about the coordinate axes, one after the other.")
      .field("quaternion", &Step::quaternion,
             "Turns by w + x i + y j + z k, written w x y z, of any length but zero.")
      .field("scale", &Step::scale,
             "Stretches x, y and z by factors that are not zero; negative ones mirror.")
      .field("shear", &Step::shear, "Slants one coordinate by another.")
      .field("matrix", &Step::matrix, "Any invertible matrix on column vectors whose last row is 0 0 0 1.")
      .exactly_one();
}

using Geometry = std::variant<Ref<Mesh>, Ref<Surface>>;

struct Inputs {
  Geometry geometry;
  std::optional<Ref<Matrix>> matrix;
};
struct Params {
  std::vector<Step> steps;
};
struct Outputs {
  Geometry geometry;
  Ref<Matrix> matrix;
};

// Below it, the first and last of three Euler angles are one and the same to single precision.
constexpr double gimbal_threshold = 1e-6;

void report_gimbal_lock(const EulerTurn& e, std::size_t index, Context& ctx) {
  if (kernels::gimbal_freedom(e.degrees, e.order) >= gimbal_threshold) return;
  const auto axes = kernels::axes_of(e.order);
  ctx.warn(
      "gimbal_lock",
      fmt::format("step {}: the turn about {} is at {} degrees, where the turns about {} and {} are about "
                  "one axis; a quaternion keeps all three freedoms",
                  index, "xyz"[axes[1]], e.degrees[axes[1]], "xyz"[axes[0]], "xyz"[axes[2]]));
}

// Nothing where the step has no inverse.
std::optional<kernels::Affine> map_of(const Step& s) {
  if (s.translate) return kernels::translation(*s.translate);
  if (s.rotate) return kernels::rotation(s.rotate->axis, s.rotate->degrees);
  if (s.euler) return kernels::euler_rotation(s.euler->degrees, s.euler->order);
  if (s.quaternion)
    return kernels::quaternion_rotation(s.quaternion->x,
                                        glm::dvec3(s.quaternion->y, s.quaternion->z, s.quaternion->w));
  if (s.scale) return kernels::scaling(*s.scale);
  if (s.shear && s.shear->move != s.shear->by)
    return kernels::shearing(static_cast<int>(s.shear->move), static_cast<int>(s.shear->by), s.shear->amount);
  if (s.matrix) return kernels::affine_from_matrix(*s.matrix);
  return std::nullopt;
}

std::string_view demand_of(const Step& s) {
  if (s.rotate || s.quaternion) return "a rotation needs an axis (or quaternion) that is not zero";
  if (s.scale) return "no factor of a scale may be zero: it has no inverse, and normals no direction";
  if (s.shear) return "a shear moves one coordinate by another, not by itself";
  return "a matrix needs the last row 0 0 0 1 and an inverse";
}

void check(const Params& p) {
  for (std::size_t i = 0; i < p.steps.size(); ++i)
    if (!map_of(p.steps[i]))
      throw NodeError("singular_transform", fmt::format("step {}: {}", i, demand_of(p.steps[i])),
                      at_param(fmt::format("steps/{}", i)));
}

kernels::Affine composed_map(const Inputs& in, const Params& p, Context& ctx) {
  kernels::Affine all;
  if (in.matrix) {
    const auto map = kernels::affine_from_matrix((*in.matrix)->value);
    if (!map)
      throw NodeError("singular_transform", "the input matrix needs the last row 0 0 0 1 and an inverse",
                      at_input("matrix"));
    all = *map;
  }
  for (std::size_t i = 0; i < p.steps.size(); ++i) {
    if (p.steps[i].euler) report_gimbal_lock(*p.steps[i].euler, i, ctx);
    all = kernels::composed(map_of(p.steps[i]).value(), all);
  }
  // 2^-53 / rcond bounds the relative error of going there and back; past 1e-2 the digits are gone.
  if (kernels::rcond(all) < 0x1p-53 / 1e-2)
    ctx.warn("ill_conditioned",
             fmt::format("the map's reciprocal condition is {:.1e}: it flattens so much that it cannot "
                         "be undone in double",
                         kernels::rcond(all)));
  return all;
}

// Corner columns of mirrored triangles follow the corners' new places.
Ref<Column> reversed_corners(const Column& c) {
  auto out = std::make_shared<Column>(c.name(), c.domain(), c.kind(), c.width(), c.rows(), c.space());
  const std::size_t row = static_cast<std::size_t>(c.width()) * bytes_of(c.kind());
  const auto* from = static_cast<const std::byte*>(c.data());
  auto* to = static_cast<std::byte*>(out->data());
  for (std::size_t i = 0; i < c.rows(); ++i) {
    const std::size_t source = i % 3 == 0 ? i : (i % 3 == 1 ? i + 1 : i - 1);
    std::memcpy(to + i * row, from + source * row, row);
  }
  return out;
}

Mesh mirrored_faces(Mesh mesh) {
  for (auto& column : mesh.columns) {
    if (column->domain() == Domain::corner) column = reversed_corners(*column);
    if (column->name() != "triangle") continue;
    auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, column->rows());
    const auto from = column->values<glm::uvec3>();
    const auto to = triangle->values<glm::uvec3>();
    for (std::size_t f = 0; f < from.size(); ++f) to[f] = kernels::reversed(from[f]);
    column = std::move(triangle);
  }
  return mesh;
}

bool is_identity(const kernels::Affine& a) {
  return a.linear == glm::dmat3(1.0) && a.translation == glm::dvec3(0.0);
}

Ref<Mesh> moved(const Mesh& mesh, const kernels::Affine& map, Context& ctx) {
  auto out = std::make_shared<Mesh>(mesh);
  if (is_identity(map)) {
    *out = mesh.with(mesh.share("position")->renamed("position", Space::world));
    return out;
  }
  ctx.real([&]<class R>() {
    using Point = glm::vec<3, R>;
    const auto from = mesh.real<R>("position");
    auto to = Column::make<Point>("position", Domain::vertex, from->rows(), Space::world);
    kernels::map_points<R>(map, from->template values<Point>(), to->template values<Point>());
    *out = mesh.with(std::move(to));
    if (mesh.find("normal") == nullptr) return;
    const auto normals = mesh.real<R>("normal");
    auto turned = Column::make<Point>("normal", normals->domain(), normals->rows(), normals->space());
    kernels::map_normals<R>(map, normals->template values<Point>(), turned->template values<Point>());
    *out = out->with(std::move(turned));
  });
  if (kernels::mirrors(map)) *out = mirrored_faces(std::move(*out));
  ctx.count("vertices", out->vertices());
  return out;
}

Ref<Surface> moved(const Surface& surface, const kernels::Affine& map, Context& ctx) {
  auto out = std::make_shared<Surface>(surface);
  kernels::map_points<double>(map, surface.points, out->points);
  if (kernels::mirrors(map))
    for (auto& patch : out->patches) patch = transform::reversed(patch);
  out->space = Space::world;
  ctx.count("control_points", out->points.size());
  return out;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const kernels::Affine map = composed_map(in, p, ctx);
  auto matrix = std::make_shared<Matrix>();
  matrix->value = kernels::matrix_of(map);
  return {std::visit([&](const auto& geometry) { return Geometry(moved(*geometry, map, ctx)); }, in.geometry),
          std::move(matrix)};
}

}  // namespace

NodeType nodes::transform_affine() {
  return node("transform.affine", run)
      .doc(
          "Moves, turns, stretches and slants geometry; the inverse is kept by structure and never solved "
          "for.")
      .cite("Rodrigues 1840; Hamilton 1844; normals by the inverse transpose, errata E6 to E8 and E44")
      .covers(10, 11, 12, 13, 14, 15)
      .input("geometry", &Inputs::geometry, "A mesh or a surface; what comes out is of the same kind.",
             {.space = {Space::object, Space::world}})
      .input("matrix", &Inputs::matrix, "An affine map made before the steps.")
      .param("steps", &Params::steps, "Elementary maps, each made after the one before it.")
      .check(check)
      .output("geometry", &Outputs::geometry,
              "The geometry in world space; mirrored faces are turned so that fronts stay fronts.",
              {.space = Space::world})
      .output("matrix", &Outputs::matrix, "The whole map, acting on column vectors.");
}

}  // namespace frustum
