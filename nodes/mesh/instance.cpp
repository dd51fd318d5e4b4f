#include "nodes/mesh/instance.h"

#include "nodes/kernels/move_points.h"
#include "nodes/mesh.h"
#include "runtime/buffers/mesh_faces.h"
#include "runtime/buffers/mesh_parts.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Placement {
  glm::dvec3 translate{0}, axis{0, 1, 0};
  double degrees = 0;
  glm::dvec3 scale{1};
};
void describe(Fields<Placement>& f) {
  f.field("translate", &Placement::translate, "Where the copy's origin comes to lie.",
          {.unit = "world units"})
      .field("axis", &Placement::axis, "Axis of the turn, of any length but zero.")
      .field("degrees", &Placement::degrees, "Counter-clockwise seen against the axis.", {.unit = "degrees"})
      .field("scale", &Placement::scale,
             "Stretches x, y and z, before the turn, by factors that are not zero; negative ones mirror.");
}

struct Inputs {
  Ref<Mesh> mesh;
  std::optional<Ref<Mesh>> points;
  std::optional<std::vector<Ref<Matrix>>> matrices;
};
struct Params {
  std::vector<Placement> placements;
};
struct Outputs {
  Ref<Mesh> mesh;
};

auto map_of(const Placement& at) { return mesh::placement(at.scale, at.axis, at.degrees, at.translate); }

void check(const Params& p) {
  for (std::size_t i = 0; i < p.placements.size(); ++i)
    if (!map_of(p.placements[i]))
      throw NodeError("singular_transform",
                      fmt::format("placement {}: no factor of its scale may be zero, nor its axis", i),
                      at_param(fmt::format("placements/{}", i)));
}

std::vector<kernels::Affine> maps_of(const Inputs& in, const Params& p) {
  std::vector<kernels::Affine> maps;
  for (std::size_t i = 0; in.matrices && i < in.matrices->size(); ++i) {
    const auto map = kernels::affine_from_matrix((*in.matrices)[i]->value);
    if (!map)
      throw NodeError("singular_transform",
                      fmt::format("matrix {} needs the last row 0 0 0 1 and an inverse", i),
                      at_input("matrices"));
    maps.push_back(*map);
  }
  for (const Placement& at : p.placements) maps.push_back(map_of(at).value());
  if (maps.empty()) maps.emplace_back();
  return maps;
}

// The vertices that are points; what is NaN or infinite is left out, and counted.
std::vector<glm::dvec3> points_of(const Mesh& mesh, Context& ctx) {
  std::vector<glm::dvec3> points;
  const auto position = as_real<double>(mesh.share("position"));
  for (const glm::dvec3& p : position->values<glm::dvec3>())
    if (std::isfinite(kernels::largest_component(p))) points.push_back(p);
  if (const std::size_t left = position->rows() - points.size(); left > 0)
    ctx.warn("points_not_finite", fmt::format("{} points are not finite and got no copy", left));
  return points;
}

class Copies {
 public:
  Copies(const Mesh& mesh, std::vector<kernels::Affine> maps) : mesh_(mesh), maps_(std::move(maps)) {
    for (const auto& map : maps_) mirrored_.push_back(kernels::mirrors(map) ? 1 : 0);
    require_countable(checked(mesh.vertices()), checked(mesh.faces()));
  }

  template <class R>
  Mesh made(Context& ctx) const {
    Mesh out;
    for (const auto& c : mesh_.columns)
      if (c->domain() != Domain::mesh) ctx.claim(std::uint64_t{row_bytes(*c)} * c->rows() * maps_.size());
    ctx.claim(sizeof(std::uint32_t) * mesh_.faces() * maps_.size());
    for (const auto& c : mesh_.columns) {
      ctx.poll();
      if (c->domain() == Domain::mesh)
        out.columns.push_back(c);
      else if (c->name() == "position" || c->name() == "normal")
        out.columns.push_back(moved<R>(mesh_.real<R>(c->name())));
      else
        out.columns.push_back(repeated(*c));
    }
    out.columns.push_back(numbers());
    out.materials = mesh_.materials;
    out.closed = mesh_.closed;
    return out;
  }

 private:
  std::size_t checked(std::size_t n) const {
    if (n > 0 && maps_.size() > 0xFFFFFFFFu / n)
      throw NodeError("too_large", fmt::format("{} copies of {} vertices or faces are more than 32-bit "
                                               "numbers count",
                                               maps_.size(), n));
    return n * maps_.size();
  }

  template <class Body>
  void each_copy(const Body& body) const {
    kernels::parallel_blocks(maps_.size(), 1, [&](std::size_t i, std::size_t) { body(i); });
  }

  template <class R>
  Ref<Column> moved(const Ref<Column>& from) const {
    using Point = glm::vec<3, R>;
    const bool is_position = from->name() == "position";
    const std::size_t n = from->rows();
    auto to = Column::make<Point>(from->name(), from->domain(), n * maps_.size(),
                                  is_position ? Space::world : from->space());
    const auto rows = to->template values<Point>();
    each_copy([&](std::size_t i) {
      const auto part = rows.subspan(i * n, n);
      if (is_position) return kernels::map_points<R>(maps_[i], from->template values<Point>(), part);
      const bool swapped = from->domain() == Domain::corner && mirrored_[i] != 0;
      if (swapped)
        copy_reversed_corners(*from, *to, i * n);
      else
        copy_rows(*from, *to, i * n);
      if (maps_[i].linear != glm::dmat3(1.0)) kernels::map_normals<R>(maps_[i], part, part);
    });
    return to;
  }

  Ref<Column> repeated(const Column& from) const {
    const std::size_t n = from.rows();
    auto to = column_like(from, n * maps_.size());
    const bool is_triangle = from.name() == "triangle", is_origin = from.name() == "origin";
    const std::uint32_t sources = is_origin ? greatest(from.values<std::uint32_t>()) + 1 : 0;
    each_copy([&](std::size_t i) {
      const auto k = static_cast<std::uint32_t>(i);
      if (is_triangle) {
        const auto vertices = static_cast<std::uint32_t>(mesh_.vertices());
        const auto triangles = from.values<glm::uvec3>();
        const auto part = to->values<glm::uvec3>().subspan(i * n, n);
        for (std::size_t f = 0; f < n; ++f)
          part[f] = (mirrored_[i] != 0 ? kernels::reversed(triangles[f]) : triangles[f]) + k * vertices;
      } else if (is_origin) {
        const auto part = to->values<std::uint32_t>().subspan(i * n, n);
        for (std::size_t f = 0; f < n; ++f) part[f] = from.values<std::uint32_t>()[f] + k * sources;
      } else if (from.domain() == Domain::corner && mirrored_[i] != 0) {
        copy_reversed_corners(from, *to, i * n);
      } else {
        copy_rows(from, *to, i * n);
      }
    });
    return to;
  }

  // Sources of one copy follow those of the copy before it.
  std::uint32_t greatest(std::span<const std::uint32_t> origin) const {
    std::uint32_t most = 0;
    for (const std::uint32_t o : origin) most = std::max(most, o);
    checked(std::size_t{most} + 1);
    return most;
  }

  Ref<Column> numbers() const {
    const std::size_t n = mesh_.faces();
    auto to = Column::make<std::uint32_t>("instance", Domain::face, n * maps_.size());
    const auto rows = to->values<std::uint32_t>();
    each_copy([&](std::size_t i) {
      const auto part = rows.subspan(i * n, n);
      std::fill(part.begin(), part.end(), static_cast<std::uint32_t>(i));
    });
    return to;
  }

  const Mesh& mesh_;
  std::vector<kernels::Affine> maps_;
  std::vector<std::uint8_t> mirrored_;
};

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  std::vector<kernels::Affine> maps = maps_of(in, p);
  if (in.points) maps = mesh::spread(maps, points_of(**in.points, ctx));
  ctx.count("instances", maps.size());
  Mesh plain = *in.mesh;
  std::erase_if(plain.columns, [](const auto& c) { return c->name() == "instance"; });
  const Copies copies(plain, std::move(maps));
  auto out = std::make_shared<Mesh>(ctx.real([&]<class R>() { return copies.made<R>(ctx); }));
  ctx.count("triangles", out->faces());
  return {std::move(out)};
}

}  // namespace

NodeType nodes::mesh_instance() {
  return node("mesh.instance", run)
      .doc("Copies a mesh to places: by placements, by matrices, at the vertices of another mesh.")
      .cite("Normals by the inverse transpose, errata E8 and E44")
      .input("mesh", &Inputs::mesh, "What is copied.", {.space = {Space::object, Space::world}})
      .input("points", &Inputs::points, "A copy of everything placed, moved to each of its vertices.",
             {.space = {Space::object, Space::world}})
      .input("matrices", &Inputs::matrices,
             "Affine maps, one a copy, before the placements; transform.affine makes them.")
      .param("placements", &Params::placements,
             "Stretched, then turned, then moved copies; without any place there is one copy as it is.")
      .check(check)
      .output(
          "mesh", &Outputs::mesh,
          "All copies in world space; mirrored ones have their fronts outside; column instance tells them.",
          {.space = Space::world});
}

}  // namespace frustum
