#include "nodes/trace/points.h"

#include "nodes/trace.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/point_columns.h"
#include "runtime/buffers/rays.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

using kernels::Attribute;

struct Inputs {
  Tiled<Image> rays, hits;
  Ref<Mesh> mesh;
};
struct Params {};
struct Outputs {
  Tiled<Image> points;
};

struct State {
  Ref<Mesh> mesh;
  Ref<Column> position;  // f64
  RayReader rays;
  int id;
  RealPlane u, v;
  std::vector<PointColumn> columns;
};

template <class R>
std::vector<PointColumn> add_planes(const Mesh& mesh, PlaneList& planes) {
  std::vector<PointColumn> columns;
  for (const Ref<Column>& c : mesh.columns) {
    if (!domain_of(*c)) continue;
    const bool is_position = c->name() == "position";
    const Ref<Column> as = is_position ? c->renamed("world", Space::world) : c;
    columns.push_back(
        PointColumn::add<R>(as, has_slopes(*as) || (c->name() == "normal" && c->width() == 3), planes));
  }
  return columns;
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  const Frame &hits = in.hits.frame(), &rays = in.rays.frame();
  if (hits.window != rays.window || hits.samples() != rays.samples())
    throw NodeError("different_frames", "rays and hits have different windows or samples", at_input("hits"));
  State s{.mesh = in.mesh,
          .position = in.mesh->real<double>("position"),
          .rays = RayReader(in.rays, true),
          .id = in.hits.read("id"),
          .u = read_real(in.hits, "u", Precision::real_double),
          .v = read_real(in.hits, "v", Precision::real_double),
          .columns = {}};
  if (s.position->width() != 3)
    throw NodeError("wrong_column", "positions in world space have three components", at_input("mesh"));
  Frame frame{.window = hits.window, .pattern = hits.pattern, .planes = {{"id", PlaneKind::u32}}};
  ctx.real([&]<class R>() { s.columns = add_planes<R>(*in.mesh, frame.planes); });
  return {std::move(s), {std::move(frame)}};
}

// The samples of one row of one sample.
template <class R>
struct Row {
  const State& s;
  const std::vector<Attribute<R>>& attributes;
  int sample, y;  // of the tile

  void fill(const RayReader::Rows& rays, const std::uint32_t* id, const double* u, const double* v,
            std::size_t n) const {
    const auto position = s.position->values<glm::dvec3>();
    const auto faces = s.mesh->triangles();
    const kernels::ScreenMesh<R> mesh{{}, faces, {}};
    for (std::size_t x = 0; x < n; ++x) {
      const auto column = static_cast<int>(x);
      if (id[x] == no_face) {
        clear(column);
        continue;
      }
      if (id[x] >= faces.size())
        throw NodeError(
            "wrong_mesh",
            fmt::format("face {} was met, but the mesh has {} faces: the hits are of another mesh", id[x],
                        faces.size()),
            at_input("mesh"));
      const kernels::SampleWeights weights =
          kernels::weights_of_hit(trace::corners_of(position, faces[id[x]]), rays.beam(x), u[x], v[x]);
      for (const Attribute<R>& a : attributes)
        kernels::interpolate_attribute(a, mesh, id[x], weights, sample, column, y);
    }
  }

  void clear(int x) const {
    for (const Attribute<R>& a : attributes)
      for (const auto* planes : {&a.value, &a.dx, &a.dy})
        for (const auto& plane : *planes)
          if (plane.data != nullptr) plane.row(sample, y)[x] = R(0);
  }
};

template <class R>
void fill(const State& s, const Tile& rays, const Tile& hits, const Tile& to, Arena& arena) {
  const auto n = static_cast<std::size_t>(to.rect().width());
  const std::span<double> scratch = arena.take<double>(RayReader::scratch(n)), of_u = arena.take<double>(n),
                          of_v = arena.take<double>(n);
  std::vector<Attribute<R>> attributes;
  for (const PointColumn& c : s.columns)
    if (const auto a = wanted_planes<R>(c, to)) attributes.push_back(*a);
  for (int k = 0; k < to.samples(); ++k)
    for (int y = to.rect().y0; y < to.rect().y1; ++y) {
      const std::uint32_t* id = hits.row<const std::uint32_t>(s.id, k, y);
      if (std::uint32_t* const out = out_row<std::uint32_t>(to, 0, k, y)) std::copy_n(id, n, out);
      const Row<R> row{s, attributes, k, y - to.rect().y0};
      row.fill(s.rays.rows(rays, k, y, scratch), id, real_row<double>(hits, s.u, k, y, of_u),
               real_row<double>(hits, s.v, k, y, of_v), n);
    }
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& to = out[&Outputs::points];
  const Tile rays = in[&Inputs::rays].part(to.rect()), hits = in[&Inputs::hits].part(to.rect());
  const bool wide = to.frame().planes.size() > 1 && to.frame().planes[1].kind == PlaneKind::f64;
  if (wide)
    fill<double>(s, rays, hits, to, arena);
  else
    fill<float>(s, rays, hits, to, arena);
}

}  // namespace

NodeType nodes::trace_points() {
  return pixel_node("trace.points", prepare, tile)
      .doc("Gives the attributes of the faces that rays have met, with how they change from pixel to pixel.")
      .cite("Igehy 1999, Tracing ray differentials, doi:10.1145/311535.311555")
      .input("rays", &Inputs::rays, "The rays, for how points change from pixel to pixel.")
      .input("hits", &Inputs::hits, "What they have met.")
      .input("mesh", &Inputs::mesh, "The mesh that was met.", {.space = {Space::object, Space::world}})
      .output("points", &Outputs::points,
              "id, uv, P and N with derivatives, and other columns, as rasterize.attributes gives them.")
      .blank_where(&Inputs::hits);
}

}  // namespace frustum
