#include "nodes/surface/tessellate.h"

#include "nodes/kernels/parallel.h"
#include "nodes/surface.h"
#include "runtime/buffers/camera.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/surface.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <atomic>

namespace frustum {
namespace {

using namespace tessellation;
using kernels::BicubicNet;

struct Inputs {
  Ref<Surface> surface;
  std::optional<Ref<Camera>> camera;
};
struct Params {
  double tolerance_px = 0.5;
  double tolerance = 1e-3;
  int min_segments = 1, max_segments = 256;
};
struct Outputs {
  Ref<Mesh> mesh;
};

PixelTolerance pixel_tolerance(const Camera& c, double pixels) {
  const auto forward = kernels::normalized(c.target - c.eye);
  if (!forward) throw NodeError("zero_direction", "the camera looks at its own eye", at_input("camera"));
  const double t = kernels::tan(0.5 * c.fov_y), aspect = c.aspect();
  return {.eye = c.eye,
          .forward = *forward,
          .near_z = c.near_z,
          .pixels = pixels,
          .focal_px = 0.5 * c.resolution.y / t,
          .corner_secant = std::sqrt(1 + t * t * (1 + aspect * aspect))};
}

// The surface with points at the same place made one, its nets, and how finely each patch is cut.
struct Plan {
  std::vector<Patch> patches;
  std::vector<BicubicNet> nets;
  std::vector<Segments> segments;
  Topology topology;

  std::array<int, 4> side_segments(std::size_t patch) const {
    std::array<int, 4> n{};
    for (const Side s : {u0, u1, v0, v1}) n[s] = topology.edges[topology.sides[patch][s].edge].segments;
    return n;
  }
};

void check(const Params& p) {
  if (p.min_segments > p.max_segments)
    throw NodeError(
        "bad_segments",
        fmt::format("min_segments is {}, and max_segments only {}", p.min_segments, p.max_segments),
        at_param("max_segments"));
}

void check_surface(const Surface& s) {
  for (std::size_t p = 0; p < s.patches.size(); ++p)
    for (const std::uint32_t i : s.patches[p]) {
      if (i >= s.points.size())
        throw NodeError("bad_surface",
                        fmt::format("patch {} has control point {} of {}", p, i, s.points.size()),
                        at_input("surface"));
      const glm::dvec3& q = s.points[i];
      if (!std::isfinite(q.x) || !std::isfinite(q.y) || !std::isfinite(q.z))
        throw NodeError("not_finite", fmt::format("control point {} of patch {} is not finite", i, p),
                        at_input("surface"));
    }
}

Plan make_plan(const Inputs& in, const Params& p, Context& ctx) {
  const Surface& surface = *in.surface;
  check_surface(surface);
  std::optional<PixelTolerance> pixels;
  if (in.camera) pixels = pixel_tolerance(**in.camera, p.tolerance_px);

  Plan plan;
  const auto same = welded(surface.points);
  std::size_t limited = 0;
  for (const auto& ids : surface.patches) {
    Patch patch;
    BicubicNet net;
    for (std::size_t k = 0; k < 16; ++k) patch[k] = same[ids[k]], net[k] = surface.points[patch[k]];
    plan.segments.push_back(
        segments_of(net, pixels ? pixels->world(net) : p.tolerance, p.min_segments, p.max_segments));
    limited += plan.segments.back().limited ? 1 : 0;
    plan.patches.push_back(patch);
    plan.nets.push_back(net);
  }
  if (limited != 0)
    ctx.warn("segments_limited",
             fmt::format("{} patches need more than {} segments for the tolerance", limited, p.max_segments));
  plan.topology = make_topology(plan.patches, plan.segments);
  return plan;
}

// Where vertices stand in the mesh: first the corners of patches, then edges, then the insides.
struct Numbering {
  std::vector<std::uint32_t> corner;        // by control point
  std::vector<std::uint32_t> first_inside;  // by patch
  std::uint32_t count = 0;

  explicit Numbering(Plan& plan, std::size_t points) : corner(points, 0xFFFFFFFFu) {
    std::uint64_t next = 0;
    const auto take = [&](std::uint64_t n) {
      const auto first = static_cast<std::uint32_t>(next);
      next += n;
      if (next > 0xFFFFFFFEu)
        throw NodeError("too_many_vertices", "more than 2^32 vertices: raise the tolerance",
                        at_param("tolerance_px"));
      return first;
    };
    for (const Patch& p : plan.patches)
      for (const std::size_t k : {0u, 3u, 12u, 15u})
        if (corner[p[k]] == 0xFFFFFFFFu) corner[p[k]] = take(1);
    for (Edge& e : plan.topology.edges)
      if (!e.is_point()) e.first_vertex = take(static_cast<std::uint64_t>(e.segments - 1));
    for (std::size_t p = 0; p < plan.patches.size(); ++p) {
      const Segments grid = interior_grid(plan.segments[p], plan.side_segments(p));
      first_inside.push_back(
          take(static_cast<std::uint64_t>(grid.u - 1) * static_cast<std::uint64_t>(grid.v - 1)));
    }
    count = static_cast<std::uint32_t>(next);
  }

  std::uint32_t on_side(const Topology& t, std::size_t patch, Side side, int i) const {
    const SideUse use = t.sides[patch][side];
    const Edge& e = t.edges[use.edge];
    const int at = use.reversed ? e.segments - i : i;
    if (at == 0 || e.is_point()) return corner[e.points[0]];
    if (at == e.segments) return corner[e.points[3]];
    return e.first_vertex + static_cast<std::uint32_t>(at - 1);
  }
};

template <class R>
void place_shared_vertices(const Plan& plan, const Numbering& n, std::span<const glm::dvec3> points,
                           std::span<glm::vec<3, R>> position) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (n.corner[i] != 0xFFFFFFFFu) position[n.corner[i]] = glm::vec<3, R>(points[i]);
  for (const Edge& e : plan.topology.edges) {
    if (e.is_point()) continue;
    const std::array p{points[e.points[0]], points[e.points[1]], points[e.points[2]], points[e.points[3]]};
    for (int i = 1; i < e.segments; ++i)
      position[e.first_vertex + static_cast<std::uint32_t>(i - 1)] =
          glm::vec<3, R>(kernels::cubic_point(p, static_cast<double>(i) / e.segments));
  }
}

// Columns of the mesh, written patch by patch.
template <class R>
struct Columns {
  std::shared_ptr<Column> position, triangle, uv, normal, patch;

  Columns(std::size_t vertices, std::size_t faces, Space space)
      : position(Column::make<glm::vec<3, R>>("position", Domain::vertex, vertices, space)),
        triangle(Column::make<glm::uvec3>("triangle", Domain::face, faces)),
        uv(Column::make<glm::vec<2, R>>("uv", Domain::corner, 3 * faces)),
        normal(Column::make<glm::vec<3, R>>("normal", Domain::corner, 3 * faces, space)),
        patch(Column::make<std::uint32_t>("patch", Domain::face, faces)) {}

  static std::uint64_t bytes(std::size_t vertices, std::size_t faces) {
    return 3 * sizeof(R) * vertices +
           (sizeof(glm::uvec3) + 3 * 5 * sizeof(R) + sizeof(std::uint32_t)) * faces;
  }

  void write(const PatchMesh& mesh, const BicubicNet& net, std::uint32_t index, std::uint32_t first_inside,
             std::size_t face) {
    std::vector<glm::vec<3, R>> normals;
    normals.reserve(mesh.vertices.size());
    const double extent = kernels::net_extent(net);
    const auto positions = position->values<glm::vec<3, R>>();
    for (const LocalVertex& v : mesh.vertices) {
      normals.emplace_back(kernels::bicubic_normal(net, extent, v.u, v.v));
      const bool inside = v.u > 0 && v.u < 1 && v.v > 0 && v.v < 1;
      if (inside && v.vertex >= first_inside)
        positions[v.vertex] = glm::vec<3, R>(kernels::bicubic_derivative(net, v.u, v.v, 0, 0));
    }
    const auto triangles = triangle->values<glm::uvec3>();
    const auto corners_uv = uv->values<glm::vec<2, R>>();
    const auto corners_normal = normal->values<glm::vec<3, R>>();
    const auto patches = patch->values<std::uint32_t>();
    for (const Triangle& t : mesh.triangles) {
      for (glm::length_t c = 0; c < 3; ++c) {
        const LocalVertex& v = mesh.vertices[t[c]];
        const std::size_t corner = 3 * face + static_cast<std::size_t>(c);
        triangles[face][c] = v.vertex;
        corners_uv[corner] = glm::vec<2, R>(v.u, v.v);
        corners_normal[corner] = normals[t[c]];
      }
      patches[face++] = index;
    }
  }
};

// Of the triangles and vertices of all patches, before they are made: a grid of u by v has 2 u v triangles, and a side
// adds at most its segments.
std::uint64_t bytes_of_patches(const Plan& plan) {
  std::uint64_t sum = 0;
  for (std::size_t p = 0; p < plan.patches.size(); ++p) {
    const std::array<int, 4> sides = plan.side_segments(p);
    const Segments grid = interior_grid(plan.segments[p], sides);
    const auto u = static_cast<std::uint64_t>(grid.u), v = static_cast<std::uint64_t>(grid.v);
    std::uint64_t around = 0;
    for (const int n : sides) around += static_cast<std::uint64_t>(n);
    sum += (2 * u * v + around) * sizeof(Triangle) + (u * v + around) * sizeof(LocalVertex);
  }
  return sum;
}

template <class R>
Ref<Mesh> build(Plan plan, const Surface& surface, Context& ctx) {
  const Numbering numbers(plan, surface.points.size());
  ctx.claim(bytes_of_patches(plan));
  std::vector<PatchMesh> meshes(plan.patches.size());
  kernels::parallel_each(meshes.size(), [&](std::size_t p) {
    ctx.poll();
    meshes[p] = triangulate(plan.segments[p], plan.side_segments(p), numbers.first_inside[p],
                            [&](Side side, int i) { return numbers.on_side(plan.topology, p, side, i); });
  });
  std::vector<std::size_t> first_face{0};
  for (const PatchMesh& m : meshes) first_face.push_back(first_face.back() + m.triangles.size());

  ctx.claim(Columns<R>::bytes(numbers.count, first_face.back()));
  Columns<R> columns(numbers.count, first_face.back(), surface.space);
  place_shared_vertices<R>(plan, numbers, surface.points,
                           columns.position->template values<glm::vec<3, R>>());
  kernels::parallel_each(meshes.size(), [&](std::size_t p) {
    ctx.poll();
    columns.write(meshes[p], plan.nets[p], static_cast<std::uint32_t>(p), numbers.first_inside[p],
                  first_face[p]);
  });
  ctx.count("triangles", first_face.back());
  auto mesh = std::make_shared<Mesh>();
  mesh->columns = {columns.position, columns.triangle, columns.uv, columns.normal, columns.patch};
  mesh->closed = plan.topology.closed();
  return mesh;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  Plan plan = make_plan(in, p, ctx);
  return {ctx.real([&]<class R>() { return build<R>(std::move(plan), *in.surface, ctx); })};
}

}  // namespace

NodeType nodes::surface_tessellate() {
  return node("surface.tessellate", run)
      .doc("Cuts smooth patches into triangles that stay within a tolerance and meet without cracks.")
      .cite("Filip, Magedson & Markot 1986, Surface algorithms using bounds on derivatives, CAGD 3")
      .covers(122)
      .input("surface", &Inputs::surface, "Bicubic patches; counter-clockwise is where dP/du x dP/dv points.")
      .input("camera", &Inputs::camera,
             "A perspective camera in the surface's space: tolerance_px then counts.")
      .param("tolerance_px", &Params::tolerance_px,
             "With a camera, how far the triangles may be off in the picture; raising it makes fewer.",
             {.unit = "px", .range = above(0)})
      .knob({"8", "4", "2", "1", "0.5", "0.25", "0.125", "0.03125"},
            "Triangles like 1/tolerance; how pixels err depends on how much silhouette and texture edge they "
            "see.")
      .param("tolerance", &Params::tolerance,
             "Without a camera, how far they may be off; raising it makes fewer.",
             {.unit = "world units", .range = above(0)})
      .knob({"0.1", "0.03", "0.01", "0.003", "0.001", "0.0001"},
            "The chord of a segment h is off by O(h^2), so triangles are like 1/tolerance.")
      .param("min_segments", &Params::min_segments, "Least number of segments of a patch in u and in v.",
             {.range = between(1, 4096)})
      .param("max_segments", &Params::max_segments,
             "Largest number; patches that would need more are reported.", {.range = between(1, 4096)})
      .check(check)
      .output("mesh", &Outputs::mesh,
              "Triangles with uv and normal at corners (creases stay sharp), and the column patch.");
}

}  // namespace frustum
