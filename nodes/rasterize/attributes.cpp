#include "nodes/rasterize/attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "nodes/kernels/parallel.h"
#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/point_columns.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace kernels {

constexpr auto choices(Interpolation) {
  return std::array{std::pair{Interpolation::hyperbolic, "hyperbolic"},
                    std::pair{Interpolation::affine, "affine"}};
}

}  // namespace kernels
namespace {

using kernels::Attribute;
using kernels::AttributeDomain;
using kernels::Interpolation;
using kernels::PlaneView;

constexpr std::string_view perspective_name = "perspective_interpolation",
                           normals_name = "normal_interpolation";

struct Inputs {
  Tiled<Visibility> hits;
  Ref<Mesh> mesh;
};
struct Params {
  Interpolation interpolation = Interpolation::hyperbolic;
};
struct Outputs {
  Tiled<Image> points;
};

template <class R>
struct Interpolator {
  Ref<Mesh> mesh;
  Ref<Column> position;
  Ref<SamplePattern> pattern;
  Interpolation interpolation;
  std::vector<PointColumn> sources;
  int hit_id, w;  // planes
};
using State = std::variant<Interpolator<float>, Interpolator<double>>;

// Adds the planes of every column that has a place on the screen.
template <class R>
std::vector<PointColumn> add_planes(const Mesh& mesh, bool interpolates_normals, PlaneList& planes) {
  std::vector<PointColumn> sources;
  for (const Ref<Column>& c : mesh.columns) {
    if (!domain_of(*c) || c->name() == "position") continue;
    sources.push_back(PointColumn::add<R>(c, has_slopes(*c), planes));
    sources.back().constant = !interpolates_normals && c->name() == "normal";
  }
  return sources;
}

std::uint64_t samples_of(const Inputs& in) {
  const Frame& f = in.hits.frame();
  return static_cast<std::uint64_t>(f.window.area()) * static_cast<std::uint64_t>(f.samples());
}

Verdict perspective(const Inputs& in, const Params& p, const Context& ctx) {
  if (p.interpolation == Interpolation::affine)
    return off_user("the graph asks for affine interpolation: textures swim where w changes");
  return ctx.real([&]<class R>() {
    const auto column = in.mesh->template real<R>("position");
    const auto screen = column->template values<glm::vec<4, R>>();
    const std::size_t vertex =
        kernels::first_where(screen.size(), [&](std::size_t i) { return screen[i].w != R(1); });
    if (vertex == screen.size())
      return off_exact("1/w is 1 at every vertex: the projection is parallel", samples_of(in));
    return on(fmt::format("1/w is {:.6g} at vertex {}", screen[vertex].w, vertex), samples_of(in));
  });
}

// A corner's numbers that stand for a whole face are finite, without -0: a + u (b - a) is then exactly a for
// b = a.
template <class R>
std::size_t first_changing_face(const Mesh& mesh, const Column& column, AttributeDomain domain) {
  const R* data = static_cast<const R*>(column.data());
  const auto width = static_cast<std::size_t>(column.width());
  const kernels::ScreenMesh<R> screen{{}, mesh.triangles(), {}};
  const Attribute<R> a{data, column.width(), domain};
  const auto plain = [](R x) { return std::isfinite(x) && !(x == R(0) && std::signbit(x)); };
  return kernels::first_where(mesh.faces(), [&](std::size_t f) {
    const auto face = static_cast<std::uint32_t>(f);
    const R *p = data + a.row(screen, face, 0) * width, *q = data + a.row(screen, face, 1) * width,
            *r = data + a.row(screen, face, 2) * width;
    for (std::size_t i = 0; i < width; ++i)
      if (!plain(p[i]) || p[i] != q[i] || p[i] != r[i] || !plain(q[i]) || !plain(r[i])) return true;
    return false;
  });
}

// The weights are finite where 1/w is, and neither 0 nor so extreme that their products overflow.
template <class R>
std::size_t first_wild_vertex(const Mesh& mesh) {
  const auto column = mesh.real<R>("position");
  const auto screen = column->template values<glm::vec<4, R>>();
  return kernels::first_where(screen.size(), [&](std::size_t i) {
    const double w = static_cast<double>(screen[i].w);
    return !(w >= 0x1p-149 && w <= 0x1p128);
  });
}

Verdict normals(const Inputs& in, const Params&, const Context& ctx) {
  const std::uint64_t samples = samples_of(in);
  const Column* column = in.mesh->find("normal");
  const auto domain = column != nullptr ? domain_of(*column) : std::nullopt;
  if (!domain) return off_exact("the mesh has no normals", samples);
  return ctx.real([&]<class R>() {
    const Ref<Column> normal = as_real<R>(in.mesh->share("normal"));
    if (const std::size_t f = first_changing_face<R>(*in.mesh, *normal, *domain); f < in.mesh->faces())
      return on(fmt::format("the normal changes over face {}", f), samples);
    if (const std::size_t v = first_wild_vertex<R>(*in.mesh); v < in.mesh->vertices())
      return on(fmt::format("1/w of vertex {} is no usual number", v), samples);
    return off_exact("the three corners of each face have the same normal", samples);
  });
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame& hits = in.hits.frame();
  return ctx.real([&]<class R>() -> Prepared<State, Outputs> {
    Frame points{hits.window, hits.pattern, {{"id", PlaneKind::u32}}};
    std::vector<PointColumn> sources = add_planes<R>(*in.mesh, ctx.simulates(normals_name), points.planes);
    const int w = static_cast<int>(points.planes.size());
    points.planes.push_back({"w", plane_kind_of<R>});
    Interpolator<R> state{in.mesh,
                          in.mesh->template real<R>("position"),
                          hits.pattern,
                          ctx.simulates(perspective_name) ? p.interpolation : Interpolation::affine,
                          std::move(sources),
                          in.hits.read("id"),
                          w};
    return {std::move(state), {std::move(points)}};
  });
}

// Copies the ids of one row, if somebody reads them, and throws where they are of another mesh.
void check_and_copy(const std::uint32_t* from, int count, std::uint32_t faces, std::uint32_t* to) {
  constexpr int lanes = 16;  // a fixed number, so that the compiler uses vectors
  std::array<std::uint32_t, lanes> most{};
  int x = 0;
  for (; x + lanes <= count; x += lanes)
    for (int k = 0; k < lanes; ++k) {
      std::uint32_t& m = most[static_cast<std::size_t>(k)];
      m = std::max(m, from[x + k] + 1);  // no_face + 1 is 0
    }
  for (; x < count; ++x) most[0] = std::max(most[0], from[x] + 1);
  const std::uint32_t greatest = *std::max_element(most.begin(), most.end());
  if (greatest > faces)
    throw NodeError("wrong_mesh",
                    fmt::format("face {} is seen, but the mesh has {} faces: the hits are of another mesh",
                                greatest - 1, faces),
                    at_input("mesh"));
  if (to != nullptr) std::copy_n(from, count, to);
}

template <class R>
void fill(const Interpolator<R>& s, const Tile& from, const Tile& to) {
  const Rect& r = to.rect();
  const auto ids = plane_view<const std::uint32_t>(from, static_cast<std::size_t>(s.hit_id));
  const auto faces = static_cast<std::uint32_t>(s.mesh->faces());
  for (int sample = 0; sample < to.samples(); ++sample)
    for (int y = r.y0; y < r.y1; ++y)
      check_and_copy(ids.row(sample, y - r.y0), r.width(), faces,
                     to.has(0) ? to.row<std::uint32_t>(0, sample, y) : nullptr);

  const kernels::ScreenMesh<R> screen{
      s.position->template values<glm::vec<4, R>>(), s.mesh->triangles(), {}, corner_bits_of(*s.mesh)};
  std::vector<Attribute<R>> attributes;
  for (const PointColumn& source : s.sources) {
    const auto a = wanted_planes<R>(source, to);
    if (!a) continue;
    if (source.constant)
      copy_attribute<R>(screen, {r.x0, r.y0, r.x1, r.y1}, to.samples(), ids, *a);
    else
      attributes.push_back(*a);
  }
  const PlaneView<R> w = plane_view<R>(to, static_cast<std::size_t>(s.w));
  if (attributes.empty() && w.data == nullptr) return;
  attributes_at<R>({screen, sample_positions(s.pattern.get()), s.interpolation}, {r.x0, r.y0, r.x1, r.y1},
                   ids, {attributes, w});
}

void tile(const State& state, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena&) {
  const Tile& to = out[&Outputs::points];
  const Tile from = in[&Inputs::hits].part(to.rect());
  std::visit([&](const auto& interpolator) { fill(interpolator, from, to); }, state);
}

}  // namespace

NodeType nodes::rasterize_attributes() {
  return pixel_node("rasterize.attributes", prepare, tile)
      .doc("Gives the attributes of the faces seen, interpolated to every sample.")
      .cite("Heckbert & Moreton 1991, Interpolation for Polygon Texture Mapping and Shading (hyperbolic)")
      .covers(31, 32)
      .input("hits", &Inputs::hits, "Which face is seen at each sample.")
      .input("mesh", &Inputs::mesh, "The mesh that was rasterized.", {.space = Space::screen})
      .param("interpolation", &Params::interpolation,
             "hyperbolic is straight in the scene; affine is straight on the screen, so textures swim in "
             "perspective.")
      .knob({"affine", "hyperbolic"},
            "affine saves a division a sample and is off by O(k^2) over a depth range of k.")
      .effect(perspective_name, perspective, "Attributes are weighted by 1/w and divided by their sum.",
              {"sample", 1})  // tests/bench/effects_bench.cpp, one thread: 0.8 to 3.6
      .effect(normals_name, normals, "Normals are interpolated between the corners of each face.",
              {"sample", 0.5})  // 0 to 2.0
      .output("points", &Outputs::points,
              "id, uv and P with derivatives, N, w and other columns; 0 where nothing is seen.")
      .blank_where(&Inputs::hits);
}

}  // namespace frustum
