#include "runtime/app/suite/invariants.h"

#include "nodes/kernels/sum.h"
#include "runtime/app/suite/mesh_edges.h"
#include "runtime/app/suite/values.h"
#include "runtime/buffers/value.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace frustum {
namespace {

using Broken = std::optional<std::string>;

const Mesh& mesh_of(const Buffer& buffer) {
  const auto mesh = buffer.as<Mesh>();
  if (!mesh)
    throw NodeError("wrong_kind",
                    fmt::format("this law is about meshes; this buffer is of kind {}", buffer.type().name));
  return *mesh;
}

std::string shown(const MeshEdge& e) { return fmt::format("the edge from vertex {} to {}", e.low, e.high); }

// ----- meshes

template <class Wrong>
Broken edges_obey(const Buffer& buffer, Wrong wrong, const char* law) {
  const auto edges = edges_of(mesh_of(buffer));
  std::size_t count = 0;
  const MeshEdge* first = nullptr;
  for (const MeshEdge& e : edges)
    if (wrong(e)) {
      if (count++ == 0) first = &e;
    }
  if (count == 0) return std::nullopt;
  return fmt::format("{} of {} edges {}; the first: {}, {} faces one way and {} the other", count,
                     edges.size(), law, shown(*first), first->forward, first->backward);
}

Broken watertight(const Buffer& b, const Buffer*, double) {
  if (mesh_of(b).faces() == 0) return "it has no faces";
  return edges_obey(
      b, [](const MeshEdge& e) { return e.forward != 1 || e.backward != 1; },
      "do not have two faces of opposite direction");
}

Broken manifold(const Buffer& b, const Buffer*, double) {
  return edges_obey(
      b, [](const MeshEdge& e) { return e.forward + e.backward > 2; }, "have more than two faces");
}

Broken winding(const Buffer& b, const Buffer*, double) {
  return edges_obey(
      b, [](const MeshEdge& e) { return e.forward > 1 || e.backward > 1; },
      "are run in the same direction by two faces");
}

// Six times the volume that the faces enclose, from the first vertex.
Broken outward(const Buffer& b, const Buffer*, double) {
  const Mesh& mesh = mesh_of(b);
  const Column& position = mesh.at("position");
  if (mesh.faces() == 0) return "it has no faces";
  const auto point = [&](std::uint32_t v) {
    return glm::dvec3{position.number(v, 0), position.number(v, 1), position.number(v, 2)};
  };
  const glm::dvec3 origin = point(mesh.triangles()[0].x);
  kernels::CompensatedSum<double> volume;
  for (const glm::uvec3& t : mesh.triangles()) {
    const glm::dvec3 p = point(t.x) - origin, q = point(t.y) - origin, r = point(t.z) - origin;
    volume.add(p.x * (q.y * r.z - q.z * r.y) + p.y * (q.z * r.x - q.x * r.z) + p.z * (q.x * r.y - q.y * r.x));
  }
  if (volume.value() > 0) return std::nullopt;
  return fmt::format("its faces enclose a volume of {:g}: they look inward", volume.value() / 6);
}

Broken unit_normals(const Buffer& b, const Buffer*, double tolerance) {
  const Column& normal = mesh_of(b).at("normal");
  for (std::size_t row = 0; row < normal.rows(); ++row) {
    double squares = 0;
    for (int k = 0; k < normal.width(); ++k) squares += normal.number(row, k) * normal.number(row, k);
    if (!(std::abs(std::sqrt(squares) - 1) <= tolerance))
      return fmt::format("normal {} has length {:.9g}", row, std::sqrt(squares));
  }
  return std::nullopt;
}

struct Box {
  std::array<double, 3> low, high;
};
Box box_of(const Mesh& mesh) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Box box{{inf, inf, inf}, {-inf, -inf, -inf}};
  const Column& position = mesh.at("position");
  for (std::size_t row = 0; row < position.rows(); ++row)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = position.number(row, static_cast<int>(k));
      box.low[k] = std::min(box.low[k], x), box.high[k] = std::max(box.high[k], x);
    }
  return box;
}

Broken within_bounds(const Buffer& b, const Buffer* other, double tolerance) {
  const Box inner = box_of(mesh_of(b)), outer = box_of(mesh_of(*other));
  for (std::size_t k = 0; k < 3; ++k)
    if (inner.low[k] < outer.low[k] - tolerance || inner.high[k] > outer.high[k] + tolerance)
      return fmt::format("along {} it reaches from {:.9g} to {:.9g}, beyond {:.9g} to {:.9g}", "xyz"[k],
                         inner.low[k], inner.high[k], outer.low[k], outer.high[k]);
  return std::nullopt;
}

// ----- numbers

template <class Wrong>
Broken numbers_obey(const Buffer& b, Wrong wrong, const char* law) {
  const Values v = values_of(b);
  std::size_t count = 0, all = 0;
  std::string first;
  for (const Series& s : v.series) {
    all += s.values.size();
    for (std::size_t i = 0; i < s.values.size(); ++i)
      if (wrong(s, s.values[i]) && count++ == 0)
        first = fmt::format("{} is {:.9g}", v.place(s, i), s.values[i]);
  }
  if (count == 0) return std::nullopt;
  return fmt::format("{} of {} numbers {}; the first: {}", count, all, law, first);
}

Broken unit_range(const Buffer& b, const Buffer*, double tolerance) {
  return numbers_obey(
      b, [=](const Series&, double x) { return !(x >= -tolerance && x <= 1 + tolerance); },
      "are not in [0, 1]");
}

Broken non_negative(const Buffer& b, const Buffer*, double tolerance) {
  return numbers_obey(
      b, [=](const Series&, double x) { return !(x >= -tolerance); }, "are below 0");
}

Broken opaque(const Buffer& b, const Buffer*, double tolerance) {
  if (values_of(b).find("A") == nullptr) return "it has no plane A";
  return numbers_obey(
      b, [=](const Series& s, double x) { return s.name == "A" && !(std::abs(x - 1) <= tolerance); },
      "of plane A are not 1");
}

Broken partition_of_unity(const Buffer& b, const Buffer*, double tolerance) {
  const Values v = values_of(b);
  if (v.series.empty()) return "it has no numbers";
  for (std::size_t row = 0; row < v.series.front().rows(); ++row) {
    kernels::CompensatedSum<double> sum;
    for (const Series& s : v.series)
      for (std::size_t k = 0; k < static_cast<std::size_t>(s.width); ++k)
        if (row < s.rows()) sum.add(s.values[row * static_cast<std::size_t>(s.width) + k]);
    if (!(std::abs(sum.value() - 1) <= tolerance))
      return fmt::format("the numbers of {} add to {:.9g}",
                         v.place(v.series.front(), row * static_cast<std::size_t>(v.series.front().width)),
                         sum.value());
  }
  return std::nullopt;
}

double total(const Series& s) {
  kernels::CompensatedSum<double> sum;
  for (const double x : s.values) sum.add(x);
  return sum.value();
}

Broken energy(const Buffer& b, const Buffer* other, double tolerance) {
  const Values mine = values_of(b), theirs = values_of(*other);
  for (const Series& s : mine.series) {
    const Series* o = theirs.find(s.name);
    if (o == nullptr) return fmt::format("the other has no '{}'", s.name);
    const double have = total(s), want = total(*o);
    if (!(std::abs(have - want) <= tolerance * std::abs(want)))
      return fmt::format("the sum of {} is {:.9g}, and {:.9g} of the other", s.name, have, want);
  }
  return std::nullopt;
}

Broken orthonormal(const Buffer& b, const Buffer*, double tolerance) {
  const auto matrix = b.as<Matrix>();
  if (!matrix)
    throw NodeError("wrong_kind",
                    fmt::format("this law is about matrices; this buffer is of kind {}", b.type().name));
  const glm::dmat4& m = matrix->value;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      const double dot = m[i][0] * m[j][0] + m[i][1] * m[j][1] + m[i][2] * m[j][2];
      if (!(std::abs(dot - (i == j ? 1 : 0)) <= tolerance))
        return fmt::format("its columns {} and {} have the product {:.9g}", i, j, dot);
    }
  return std::nullopt;
}

constexpr std::array<InvariantType, 12> types{{
    {"energy", "Each plane or column has the same sum as that of the port `of`; tolerance is relative.", true,
     energy},
    {"manifold", "No edge of the mesh has more than two faces.", false, manifold},
    {"non_negative", "No number is below zero.", false, non_negative},
    {"opaque", "Plane A is 1 everywhere.", false, opaque},
    {"orthonormal", "The columns of the matrix's linear part are of unit length and perpendicular.", false,
     orthonormal},
    {"outward", "The faces of the mesh enclose a positive volume: they look outward.", false, outward},
    {"partition_of_unity", "The planes of each pixel, or the numbers of each row, add to 1.", false,
     partition_of_unity},
    {"unit_normals", "Every normal of the mesh has length 1.", false, unit_normals},
    {"unit_range", "Every number is in [0, 1].", false, unit_range},
    {"watertight", "Every edge of the mesh has two faces, one in each direction.", false, watertight},
    {"winding", "No two faces of the mesh run along an edge in the same direction.", false, winding},
    {"within_bounds", "The mesh lies in the bounding box of the mesh at the port `of`.", true, within_bounds},
}};

}  // namespace

std::span<const InvariantType> invariant_types() { return types; }

const InvariantType* find_invariant(std::string_view name) {
  const auto found =
      std::find_if(types.begin(), types.end(), [&](const InvariantType& t) { return t.name == name; });
  return found != types.end() ? &*found : nullptr;
}

}  // namespace frustum
