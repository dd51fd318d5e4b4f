#include "nodes/curve/hermite.h"

#include "nodes/curve.h"
#include "runtime/buffers/curve.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  std::optional<Ref<Points>> through;
  std::optional<Ref<Vectors>> along;
};
struct Params {
  std::vector<glm::dvec3> points, tangents;
};
struct Outputs {
  Ref<Curve> curve;
  Ref<Table> forms;
};

template <class R>
std::vector<glm::vec<3, R>> rounded(std::span<const glm::dvec3> rows) {
  return {rows.begin(), rows.end()};
}

// Each piece as the four Bezier points and, from those, the derivatives at its ends.
Table forms_of(const Curve& c, Context& ctx) {
  Table t;
  t.columns = {{.name = "piece"}, {.name = "row"}, {.name = "x"}, {.name = "y"}, {.name = "z"}};
  const auto add = [&t](std::size_t piece, const char* row, const glm::dvec3& v) {
    t.columns[0].numbers.push_back(static_cast<double>(piece));
    t.columns[1].texts.emplace_back(row);
    for (glm::length_t k = 0; k < 3; ++k) t.columns[2 + static_cast<std::size_t>(k)].numbers.push_back(v[k]);
  };
  if (!ctx.wants(1)) return t;
  ctx.real([&]<class R>() {
    for (std::size_t i = 0; i + 3 < c.points.size(); i += 3) {
      const auto p = rounded<R>(std::span(c.points).subspan(i, 4));
      const char* names[] = {"p0", "p1", "p2", "p3"};
      for (std::size_t k = 0; k < 4; ++k) add(i / 3, names[k], glm::dvec3(p[k]));
      add(i / 3, "r0", glm::dvec3(hermite::derivative(p[0], p[1], R(1))));
      add(i / 3, "r3", glm::dvec3(hermite::derivative(p[2], p[3], R(1))));
    }
  });
  return t;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  std::vector<glm::dvec3> points = p.points, along = p.tangents;
  if (in.through) {
    ctx.claim((*in.through)->at.size() * 4 * sizeof(glm::dvec3));
    points.insert(points.end(), (*in.through)->at.begin(), (*in.through)->at.end());
  }
  if (in.along) along.insert(along.end(), (*in.along)->along.begin(), (*in.along)->along.end());
  if (points.size() < 2)
    throw NodeError("wrong_count",
                    fmt::format("{} points: a curve by its ends has two or more", points.size()),
                    at_param("points"));
  if (points.size() != along.size())
    throw NodeError("rows_differ", fmt::format("{} tangents for {} points", along.size(), points.size()),
                    at_param("tangents"));
  std::vector<glm::dvec3> control;
  ctx.real([&]<class R>() {
    const auto at = rounded<R>(points), r = rounded<R>(along);
    using Row = const glm::vec<3, R>;
    for (const auto& q : hermite::bezier_points(std::span<Row>(at), std::span<Row>(r), R(1)))
      control.emplace_back(q);
  });
  auto curve = std::make_shared<Curve>(bezier_chain(std::move(control), 3));
  ctx.count("pieces", curve->pieces());
  auto forms = std::make_shared<Table>(forms_of(*curve, ctx));
  return {std::move(curve), std::move(forms)};
}

}  // namespace

NodeType nodes::curve_hermite() {
  return node("curve.hermite", run)
      .doc("Makes a chain of cubics through points, with the derivative of your choice at each.")
      .cite(
          "Ferguson 1964, JACM 11:221; errata E66 to E68: shared vectors make it C1, and G1 where they are "
          "not 0")
      .covers(116, 117)
      .input("through", &Inputs::through, "Points to go through, after those of 'points'.")
      .input("along", &Inputs::along, "Derivatives there, after those of 'tangents'.")
      .param("points", &Params::points, "Points to go through; x, y and z.")
      .param("tangents", &Params::tangents,
             "Derivative at each point, by a parameter that grows by 1 from point to point.")
      .output("curve", &Outputs::curve, "The chain, as Bezier pieces over [0, 1], [1, 2] and so on.")
      .output("forms", &Outputs::forms,
              "Each piece as Bezier points p0 to p3, and r0, r3 worked out from them again.");
}

}  // namespace frustum
