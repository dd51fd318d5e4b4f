#include "runtime/buffers/curve_knots.h"

#include "runtime/core/context.h"

#include <fmt/format.h>

#include <cmath>

namespace frustum {
namespace {

void check_order(std::span<const double> knots) {
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!(std::fabs(knots[i]) <= 1e150))
      throw NodeError("not_finite", fmt::format("knot {} is {}: knots lie within 1e150", i, knots[i]),
                      at_param(fmt::format("knot_values/{}", i)));
    if (i > 0 && knots[i] < knots[i - 1])
      throw NodeError("bad_knots",
                      fmt::format("knot {} is {}, below the one before it, {}", i, knots[i], knots[i - 1]),
                      at_param(fmt::format("knot_values/{}", i)));
  }
}

void check_domain(std::span<const double> knots, std::size_t degree, std::size_t points) {
  const double first = knots[degree], last = knots[points];
  if (!(first < last))
    throw NodeError(
        "bad_knots",
        fmt::format("knots {} and {} are both {}: between them the curve would run", degree, points, first),
        at_param("knot_values"));
  for (std::size_t i = 0; i < knots.size();) {
    std::size_t end = i;
    while (end < knots.size() && knots[end] == knots[i]) ++end;
    const std::size_t most = first < knots[i] && knots[i] < last ? degree : degree + 1;
    if (end - i > most)
      throw NodeError(
          "bad_knots",
          fmt::format(
              "the knot {} stands {} times: a curve of degree {} takes it {} times there, or it falls "
              "apart",
              knots[i], end - i, degree, most),
          at_param(fmt::format("knot_values/{}", i)));
    i = end;
  }
}

std::vector<double> made_knots(std::size_t points, std::size_t degree, KnotKind kind) {
  std::vector<double> knots;
  const std::size_t pieces = points - degree;
  for (std::size_t i = 0; i < points + degree + 1; ++i) {
    const std::size_t inside = i < degree ? 0 : std::min(i - degree, pieces);
    knots.push_back(static_cast<double>(kind == KnotKind::clamped ? inside : i));
  }
  return knots;
}

}  // namespace

void check_knots(KnotKind kind, std::span<const double> given, std::size_t degree) {
  if (kind != KnotKind::given) return;
  if (given.size() < 2 * (degree + 1))
    throw NodeError(
        "wrong_count",
        fmt::format("{} knots: a curve of degree {} has {} or more", given.size(), degree, 2 * (degree + 1)),
        at_param("knot_values"));
  check_order(given);
  check_domain(given, degree, given.size() - degree - 1);
}

Curve spline_curve(std::vector<glm::dvec3> points, std::vector<double> weights, std::size_t degree,
                   KnotKind kind, std::span<const double> given) {
  const std::size_t least = kind == KnotKind::closed ? std::max<std::size_t>(degree, 3) : degree + 1;
  if (points.size() < least)
    throw NodeError("wrong_count",
                    fmt::format("{} points; degree {} takes {} or more", points.size(), degree, least),
                    at_param("points"));
  if (!weights.empty() && weights.size() != points.size())
    throw NodeError("rows_differ", fmt::format("{} weights for {} points", weights.size(), points.size()),
                    at_param("weights"));
  if (kind == KnotKind::closed) {
    points.reserve(points.size() + degree);
    for (std::size_t i = 0; i < degree; ++i) points.push_back(points[i]);
    if (!weights.empty()) weights.reserve(points.size());
    for (std::size_t i = 0; i < degree && !weights.empty(); ++i) weights.push_back(weights[i]);
  }
  Curve c;
  c.degree = static_cast<std::uint32_t>(degree);
  if (kind == KnotKind::given) {
    if (given.size() != points.size() + degree + 1)
      throw NodeError("wrong_count",
                      fmt::format("{} knots: {} points of degree {} take {}", given.size(), points.size(),
                                  degree, points.size() + degree + 1),
                      at_param("knot_values"));
    c.knots.assign(given.begin(), given.end());
  } else {
    c.knots = made_knots(points.size(), degree, kind);
  }
  c.points = std::move(points);
  c.weights = std::move(weights);
  return c;
}

}  // namespace frustum
