#include "nodes/vector/line.h"

#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <array>

namespace frustum {
namespace {

struct Inputs {
  Ref<Points> through;
  std::optional<Ref<Points>> asked, other;
};
struct Params {
  std::vector<double> t{0, 0.25, 0.5, 0.75, 1};
};
struct Outputs {
  Ref<Points> points;
  Ref<Table> forms, sides, meeting;
};

Table forms_of(const glm::dvec2& p, const glm::dvec2& q, Context& ctx) {
  Table t;
  t.columns = {{.name = "form"}, {.name = "coefficient"}, {.name = "value"}};
  const auto add = [&](const char* form, const char* name, double value) {
    t.columns[0].texts.emplace_back(form);
    t.columns[1].texts.emplace_back(name);
    t.columns[2].numbers.push_back(value);
  };
  if (const auto e = vector::explicit_form(p, q)) {
    add("y = m x + b", "m", e->m), add("y = m x + b", "b", e->b);
  } else {
    ctx.warn("vertical_line",
             "the line is vertical, or so steep that its slope is no number: there is no y = m x + b");
  }
  const char* implicit = "(x - x0) dy - (y - y0) dx";
  add(implicit, "x0", p.x), add(implicit, "y0", p.y);
  add(implicit, "dx", q.x - p.x), add(implicit, "dy", q.y - p.y);
  const char* parametric = "p0 + t (p1 - p0)";
  add(parametric, "p0.x", p.x), add(parametric, "p0.y", p.y);
  add(parametric, "p1.x", q.x), add(parametric, "p1.y", q.y);
  return t;
}

Table sides_of(const glm::dvec2& p0, const glm::dvec2& p1, std::span<const glm::dvec3> asked, Context& ctx) {
  Table t;
  t.columns = {{.name = "x"},    {.name = "y"},      {.name = "f"},
               {.name = "side"}, {.name = "height"}, {.name = "side_by_plain_f"}};
  const auto text = [](int sign, const char* positive, const char* negative) {
    return std::string(sign > 0 ? positive : sign < 0 ? negative : "on");
  };
  std::uint64_t wrong = 0;
  for (const glm::dvec3& at : asked) {
    const glm::dvec2 q(at.x, at.y);
    const int side = vector::side_of(p0, p1, q);
    const double plain = vector::plain_implicit_value(p0, p1, q);
    const int plain_side = plain < 0 ? 1 : plain > 0 ? -1 : 0;
    wrong += plain_side != side ? 1 : 0;
    t.columns[0].numbers.push_back(q.x);
    t.columns[1].numbers.push_back(q.y);
    t.columns[2].numbers.push_back(vector::implicit_value(p0, p1, q));
    t.columns[3].texts.push_back(text(side, "left", "right"));
    t.columns[4].texts.push_back(p0.x == p1.x ? "beside" : text(vector::above(p0, p1, q), "above", "below"));
    t.columns[5].texts.push_back(text(plain_side, "left", "right"));
  }
  ctx.count("sides_wrong_by_plain_arithmetic", wrong);
  return t;
}

using Line = std::array<glm::dvec2, 2>;

Line line_of(const Points& points, const char* input) {
  const auto& at = points.at;
  if (at.size() != 2 || at[0] == at[1])
    throw NodeError("no_line",
                    fmt::format("a line takes two points at two places; there {} {}",
                                at.size() == 1 ? "is" : "are", at.size()),
                    at_input(input));
  const Line line{glm::dvec2(at[0].x, at[0].y), glm::dvec2(at[1].x, at[1].y)};
  if (line[0] == line[1])
    throw NodeError("no_line", "the two points differ in z alone, and the plane of the line is x and y",
                    at_input(input));
  return line;
}

// One row, or none.
Table meeting_of(const Line& line, const std::optional<Line>& other, Context& ctx) {
  Table t;
  t.columns = {{.name = "x"}, {.name = "y"}, {.name = "t"}, {.name = "t_other"}, {.name = "condition"}};
  if (!other) return t;
  const auto& [q0, q1] = *other;
  const auto m = vector::meeting_of(line[0], line[1], q0, q1);
  if (!m) {
    const bool same =
        vector::side_of(line[0], line[1], q0) == 0 && vector::side_of(line[0], line[1], q1) == 0;
    ctx.warn("parallel_lines", same ? "the two lines are one line: they meet everywhere"
                                    : "the two lines are parallel, or meet where no number is");
    return t;
  }
  const std::array row{m->at.x, m->at.y, m->t, m->s, m->condition};
  for (std::size_t i = 0; i < row.size(); ++i) t.columns[i].numbers.push_back(row[i]);
  return t;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const auto& through = in.through->at;
  const auto line = line_of(*in.through, "through");
  const auto other = in.other ? std::optional(line_of(**in.other, "other")) : std::nullopt;
  const auto& [p0, p1] = line;
  auto points = std::make_shared<Points>();
  for (const double t : p.t) points->at.push_back(vector::parametric(through[0], through[1], t));
  const std::span<const glm::dvec3> asked =
      in.asked ? std::span<const glm::dvec3>((*in.asked)->at) : std::span<const glm::dvec3>();
  return {std::move(points), std::make_shared<Table>(forms_of(p0, p1, ctx)),
          std::make_shared<Table>(sides_of(p0, p1, asked, ctx)),
          std::make_shared<Table>(meeting_of(line, other, ctx))};
}

}  // namespace

NodeType nodes::vector_line() {
  return node("vector.line", run)
      .doc(
          "Writes a line in its three forms, says exactly on which side points lie, and where it meets "
          "another "
          "line.")
      .cite("Shewchuk 1997, Adaptive precision predicates; C++20 std::lerp (P0811); errata E3 and E4")
      .covers(5, 6, 7)
      .input("through", &Inputs::through, "Two points; the implicit and explicit forms are of x and y, y up.")
      .input("asked", &Inputs::asked, "Points whose side is asked for.")
      .input("other", &Inputs::other, "Two points of another line, of x and y as well.")
      .param("t", &Params::t, "Where on the way from the first point (0) to the second (1) points are made.")
      .output("points", &Outputs::points, "p(t) for every t; p(1) is the second point bit for bit.")
      .output("forms", &Outputs::forms, "The coefficients; a vertical line has no explicit form.")
      .output("sides", &Outputs::sides,
              "f, the exact side and whether above, and the side that plain arithmetic would give.")
      .output("meeting", &Outputs::meeting,
              "Where the other line is met, t of both, 1 / |sin| of their angle; no row where they are "
              "parallel.");
}

}  // namespace frustum
