#include "runtime/buffers/curve.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

std::span<const double> coordinates(const Curve& c) {
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double));
  return {c.points.empty() ? nullptr : &c.points[0].x, 3 * c.points.size()};
}

struct Ops {
  static std::size_t bytes(const Curve& c) {
    return sizeof c + c.points.size() * sizeof c.points[0] +
           (c.weights.size() + c.knots.size()) * sizeof(double);
  }
  static void hash(const Curve& c, Hasher& h) {
    h.value(c.degree).span(coordinates(c)).span<double>(c.weights).span<double>(c.knots);
  }
  static void save(const Curve& c, ArchiveWriter& w) {
    w.value(c.degree).span<glm::dvec3>(c.points).span<double>(c.weights).span<double>(c.knots);
  }
  static Curve load(ArchiveReader& r) {
    Curve c;
    c.degree = r.value<std::uint32_t>();
    c.points = r.vector<glm::dvec3>();
    c.weights = r.vector<double>();
    c.knots = r.vector<double>();
    const bool whole = c.points.size() > c.degree && c.knots.size() == c.points.size() + c.degree + 1 &&
                       (c.weights.empty() || c.weights.size() == c.points.size()) &&
                       std::is_sorted(c.knots.begin(), c.knots.end()) &&
                       c.knots[c.degree] < c.knots[c.points.size()];
    if (!whole) throw ArchiveError("a curve whose points, weights and knots do not match");
    return c;
  }
  static Health health(const Curve& c) {
    const Scan points = scan(coordinates(c)), weights = scan(c.weights);
    Health h = to_health(points, coordinates(c).size(), [](std::size_t i) {
      return fmt::format("control point {}, {}", i / 3, "xyz"[i % 3]);
    });
    const Health w =
        to_health(weights, c.weights.size(), [](std::size_t i) { return fmt::format("weight {}", i); });
    h.values += w.values, h.nan += w.nan;
    h.positive_infinity += w.positive_infinity, h.negative_infinity += w.negative_infinity;
    if (h.first.empty()) h.first = w.first;
    return h;
  }
  static Json summary(const Curve& c) {
    const kernels::Spline s = c.spline();
    Json out = {{"kind", s.rational() ? "rational" : "polynomial"},
                {"degree", c.degree},
                {"pieces", c.pieces()},
                {"control_points", c.points.size()},
                {"knots", c.knots.size()},
                {"domain", {json_number(s.first()), json_number(s.last())}}};
    Json parts = Json::array();
    const auto add = [&](std::string name, std::vector<double> values) {
      Json part = {{"name", std::move(name)}};
      part.update(to_json(measure(std::move(values))));
      parts.push_back(std::move(part));
    };
    for (glm::length_t k = 0; k < 3; ++k) {
      std::vector<double> values;
      for (const glm::dvec3& p : c.points) values.push_back(p[k]);
      add(std::string(1, "xyz"[k]), std::move(values));
    }
    if (s.rational()) add("weight", c.weights);
    add("knot", c.knots);
    out["components"] = std::move(parts);
    return out;
  }
  // Control points; beside each the knots at which its influence begins and ends.
  static Json table(const Curve& c, std::size_t first, std::size_t count) {
    return json_table(
        {"x", "y", "z", "weight", "from_knot", "to_knot"}, c.points.size(), first, count, [&](std::size_t i) {
          const glm::dvec3& p = c.points[i];
          return Json{json_number(p.x),        json_number(p.y),
                      json_number(p.z),        json_number(c.weights.empty() ? 1.0 : c.weights[i]),
                      json_number(c.knots[i]), json_number(c.knots[i + c.degree + 1])};
        });
  }
};

}  // namespace

template <>
const BufferType& buffer_type<Curve>() {
  static const BufferType type = make_buffer_type<Curve, Ops>(
      "curve", "A piecewise polynomial or rational curve: control points, weights and knots.", "#b48bd0");
  return type;
}

std::vector<double> chain_knots(std::size_t degree, std::span<const double> breaks) {
  std::vector<double> knots{breaks.front()};
  for (const double b : breaks) knots.insert(knots.end(), degree, b);
  knots.push_back(breaks.back());
  return knots;
}

Curve bezier_chain(std::vector<glm::dvec3> points, std::size_t degree) {
  const std::size_t pieces = degree == 0 ? 1 : (points.size() - 1) / degree;
  std::vector<double> breaks;
  for (std::size_t i = 0; i <= pieces; ++i) breaks.push_back(static_cast<double>(i));
  Curve c;
  c.degree = static_cast<std::uint32_t>(degree);
  c.points = std::move(points);
  c.knots = chain_knots(degree, breaks);
  return c;
}

}  // namespace frustum
