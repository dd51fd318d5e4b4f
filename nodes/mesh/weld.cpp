#include "nodes/mesh/weld.h"

#include "nodes/mesh.h"
#include "runtime/buffers/mesh_faces.h"
#include "runtime/buffers/mesh_parts.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

enum class Attributes { split, corners, first };
constexpr auto choices(Attributes) {
  return std::array{std::pair{Attributes::split, "split"}, std::pair{Attributes::corners, "corners"},
                    std::pair{Attributes::first, "first"}};
}

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {
  double tolerance = 0;
  Attributes attributes = Attributes::split;
};
struct Outputs {
  Ref<Mesh> mesh;
};

bool is_vertex_attribute(const Column& c) { return c.domain() == Domain::vertex && c.name() != "position"; }

Mesh with_corner_attributes(Mesh mesh) {
  const auto triangles = mesh.triangles();
  for (auto& c : mesh.columns)
    if (is_vertex_attribute(*c)) c = on_corners(*c, triangles);
  return mesh;
}

// Vertex columns with the vertices kept; positions are those of each vertex's place.
Mesh gathered(const Mesh& mesh, const mesh::Kept& kept, std::span<const std::uint32_t> place) {
  std::vector<std::uint32_t> places;
  places.reserve(kept.vertices.size());
  for (const std::uint32_t v : kept.vertices) places.push_back(place[v]);
  Mesh out = mesh;
  for (auto& c : out.columns) {
    if (c->domain() == Domain::vertex) c = gather_rows(*c, c->name() == "position" ? places : kept.vertices);
    if (c->name() != "triangle") continue;
    const auto from = c->values<glm::uvec3>();
    auto to = Column::make<glm::uvec3>("triangle", Domain::face, from.size());
    const auto renumbered = to->values<glm::uvec3>();
    kernels::parallel_blocks(from.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f)
        for (glm::length_t k = 0; k < 3; ++k) renumbered[f][k] = kept.number[from[f][k]];
    });
    c = std::move(to);
  }
  return out;
}

std::vector<std::uint32_t> places_of(const Mesh& mesh, double tolerance, const Context& ctx) {
  return ctx.real([&]<class R>() {
    const auto position = mesh.real<R>("position");
    return kernels::joined_points<R>(position->template values<glm::vec<3, R>>(), tolerance);
  });
}

// Columns on corners, and then the vertex and face columns with what is kept: at most as much as there was. Three
// numbers a vertex join them.
std::uint64_t bytes_of_welding(const Mesh& mesh, Attributes attributes) {
  std::uint64_t sum = 3 * sizeof(std::uint32_t) * mesh.vertices();
  for (const auto& c : mesh.columns) {
    sum += c->bytes();
    if (attributes == Attributes::corners && is_vertex_attribute(*c)) sum += 3 * row_bytes(*c) * mesh.faces();
  }
  return sum;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  ctx.claim(bytes_of_welding(*in.mesh, p.attributes));
  const Mesh mesh = p.attributes == Attributes::corners ? with_corner_attributes(*in.mesh) : *in.mesh;
  const std::vector<std::uint32_t> place = places_of(mesh, p.tolerance, ctx);
  ctx.poll();
  std::vector<mesh::ByteRows> attributes;
  if (p.attributes == Attributes::split)
    for (const auto& c : mesh.columns)
      if (is_vertex_attribute(*c))
        attributes.push_back({static_cast<const std::byte*>(c->data()), row_bytes(*c)});
  const mesh::Kept kept = mesh::kept_vertices(mesh::equal_vertices(place, attributes));
  Mesh welded = gathered(mesh, kept, place);
  const auto triangles = welded.triangles();
  const auto faces = kernels::indices_where(
      triangles.size(), [&](std::size_t f) { return mesh::has_three_corners(triangles[f]); });
  ctx.count("vertices_joined", mesh.vertices() - kept.vertices.size());
  ctx.count("faces_dropped", triangles.size() - faces.size());
  welded.closed = std::nullopt;
  return {std::make_shared<Mesh>(select_faces(welded, faces))};
}

}  // namespace

NodeType nodes::mesh_weld() {
  return node("mesh.weld", run)
      .doc(
          "Joins vertices at one place, so that faces that touch share them; faces that collapse are "
          "dropped.")
      .input("mesh", &Inputs::mesh, "Any triangles; vertices that are not finite stay as they are.",
             {.space = {Space::object, Space::world}})
      .param(
          "tolerance", &Params::tolerance,
          "How far apart joined vertices may be: a vertex joins the earliest kept one; 0 asks for equality.",
          {.unit = "world units", .range = at_least(0)})
      .param("attributes", &Params::attributes,
             "Vertices whose other columns differ: split stays two; corners moves columns there; first wins.")
      .output("mesh", &Outputs::mesh, "The same faces over fewer vertices; what is closed is not known.");
}

}  // namespace frustum
