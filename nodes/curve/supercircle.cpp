#include "nodes/curve/supercircle.h"

#include "nodes/curve.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <array>

namespace frustum {
namespace supercircle {
enum class Form : std::uint8_t { parametric, implicit };
constexpr auto choices(Form) {
  return std::array{std::pair{Form::parametric, "parametric"}, std::pair{Form::implicit, "implicit"}};
}
}  // namespace supercircle

namespace {

using supercircle::Form;

struct Inputs {};
struct Params {
  glm::dvec2 radii{1};
  double exponent = 2.5;
  glm::dvec3 center{0};
  Form form = Form::parametric;
  int samples = 256;
};
struct Outputs {
  Ref<Points> points;
  Ref<Table> samples;
};

template <class R>
glm::vec<2, R> point(const Params& p, double degrees) {
  const glm::vec<2, R> radii(p.radii);
  const R n = static_cast<R>(p.exponent), angle = static_cast<R>(degrees);
  return p.form == Form::parametric ? supercircle::by_parameter(radii, n, angle)
                                    : supercircle::by_ray(radii, n, angle);
}

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  const auto count = static_cast<std::size_t>(p.samples);
  ctx.claim((count + 1) * (sizeof(glm::dvec3) + 4 * sizeof(double)));
  auto points = std::make_shared<Points>();
  auto table = std::make_shared<Table>();
  table->columns = {{.name = "t", .unit = "degrees"}, {.name = "x"}, {.name = "y"}, {.name = "residual"}};
  ctx.real([&]<class R>() {
    for (std::size_t k = 0; k <= count; ++k) {
      const double degrees = 360 * (static_cast<double>(k) / static_cast<double>(count));
      const glm::dvec2 at(point<R>(p, degrees));
      points->at.emplace_back(glm::vec<3, R>(glm::dvec3(at, 0) + p.center));
      const double row[] = {degrees, at.x, at.y, supercircle::residual(p.radii, p.exponent, at)};
      for (std::size_t c = 0; c < 4; ++c) table->columns[c].numbers.push_back(row[c]);
      if (k % 4096 == 0) ctx.poll();
    }
  });
  return {std::move(points), std::move(table)};
}

}  // namespace

NodeType nodes::curve_supercircle() {
  return node("curve.supercircle", run)
      .doc("Makes points of |x / a|^n + |y / b|^n = 1, from stars through the ellipse to rounded rectangles.")
      .cite("Lame 1818; Gardner 1965, The superellipse, Scientific American 213(3):222; errata E59")
      .covers(106)
      .param("radii", &Params::radii,
             "a and b: half the width and half the height; raising them makes it larger.",
             {.range = above(0)})
      .param("exponent", &Params::exponent,
             "n: 1 is a rhombus, 2 an ellipse; raising it squares the corners.",
             {.range = between(0.01, 1e6)})
      .param("center", &Params::center, "Where its middle lies.")
      .param("form", &Params::form,
             "parametric steps by t, implicit solves the equation along rays of even angles.")
      .param("samples", &Params::samples,
             "Lines all around; a multiple of 4 has points on the axes; raising it is smoother.",
             {.range = between(3, 10000000)})
      .knob({"16", "64", "256", "1024"}, "Four times the lines are a sixteenth as far from a smooth curve.",
            -2.0)
      .output("points", &Outputs::points,
              "Around counter-clockwise with y up, the first point once more at the end.")
      .output("samples", &Outputs::samples,
              "Parameter or angle, point about the middle, and what is left of the equation.");
}

}  // namespace frustum
