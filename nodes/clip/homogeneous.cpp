#include "nodes/clip/homogeneous.h"

#include "nodes/clip.h"
#include "runtime/buffers/mesh_faces.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <cstring>

namespace frustum {
namespace {

enum class Planes { all, near_only };
constexpr auto choices(Planes) {
  return std::array{std::pair{Planes::all, "all"}, std::pair{Planes::near_only, "near"}};
}

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {
  Planes planes = Planes::all;
  double guard_band = 1;
};
struct Outputs {
  Ref<Mesh> mesh;
};

// Calls body.operator()<T>() for the element type of a column.
template <class Body>
void with_element(const Column& c, const Body& body) {
  const auto width = [&]<class N>() {
    switch (c.width()) {
      case 1: return body.template operator()<N>();
      case 2: return body.template operator()<glm::vec<2, N>>();
      case 3: return body.template operator()<glm::vec<3, N>>();
      default: return body.template operator()<glm::vec<4, N>>();
    }
  };
  switch (c.kind()) {
    case NumberKind::f32: return width.template operator()<float>();
    case NumberKind::f64: return width.template operator()<double>();
    case NumberKind::i32: return width.template operator()<std::int32_t>();
    case NumberKind::u32: return width.template operator()<std::uint32_t>();
  }
}

// Rows of `in` by weights into `out`; whole numbers are not mixed but taken from the nearest source.
void apply(const kernels::Stencils& rows, const Column& in, Column& out, std::size_t first) {
  with_element(in, [&]<class T>() {
    const auto to = out.values<T>().subspan(first, rows.rows());
    if constexpr (std::is_floating_point_v<typename Element<T>::number>)
      kernels::apply_affine<T>(rows, in.values<T>(), to);
    else
      kernels::apply_largest<T>(rows, in.values<T>(), to);
  });
}

std::shared_ptr<Column> resized(const Column& c, std::size_t rows) {
  return std::make_shared<Column>(c.name(), c.domain(), c.kind(), c.width(), rows, c.space());
}

void copy_rows(const Column& from, Column& to) {
  const std::size_t bytes = from.bytes();
  const auto* source = static_cast<const std::byte*>(from.data());
  auto* target = static_cast<std::byte*>(to.data());
  kernels::parallel_blocks(bytes, std::size_t{1} << 20, [&](std::size_t begin, std::size_t end) {
    std::memcpy(target + begin, source + begin, end - begin);
  });
}

// The column of the kept faces with the rows of `more` behind them.
Ref<Column> joined(const Column& old, std::span<const std::uint32_t> kept, const Column& more) {
  const auto front = gather_faces(old, kept);
  auto out = resized(old, front->rows() + more.rows());
  copy_rows(*front, *out);
  std::memcpy(static_cast<std::byte*>(out->data()) + front->bytes(), more.data(), more.bytes());
  return out;
}

template <class R>
Ref<Column> new_vertices(const Column& old, const clip::Pieces<R>& pieces) {
  auto out = resized(old, old.rows() + pieces.position.size());
  copy_rows(old, *out);
  if (old.name() == "position") {  // exact: the planes hold bit for bit
    const auto to = out->template values<glm::vec<4, R>>().subspan(old.rows());
    std::copy(pieces.position.begin(), pieces.position.end(), to.begin());
  } else {
    apply(pieces.vertices, old, *out, old.rows());
  }
  return out;
}

template <class R>
Ref<Column> new_faces(const Column& old, std::span<const std::uint32_t> kept, const clip::Pieces<R>& pieces) {
  if (old.name() == "triangle")
    return joined(old, kept, *Column::make<glm::uvec3>("triangle", Domain::face, std::span(pieces.triangle)));
  if (old.domain() == Domain::face) return joined(old, kept, *gather_faces(old, pieces.source));
  auto corners = resized(old, pieces.corners.rows());
  apply(pieces.corners, old, *corners, 0);
  return joined(old, kept, *corners);
}

// Kept faces first, then the pieces of cut ones: in which order faces are drawn makes no difference.
template <class R>
Mesh with_pieces(const Mesh& mesh, std::span<const std::uint32_t> kept, const clip::Pieces<R>& pieces) {
  Mesh out = mesh.with(origin_of(mesh));
  for (auto& column : out.columns) {
    if (column->domain() == Domain::vertex)
      column = new_vertices(*column, pieces);
    else if (column->domain() != Domain::mesh)
      column = new_faces(*column, kept, pieces);
  }
  if (mesh.closed == true) out.closed = false;
  return out;
}

// What with_pieces takes: every column anew, and the front of face columns twice while they are joined.
template <class R>
std::uint64_t bytes_with_pieces(const Mesh& mesh, std::size_t kept, const clip::Pieces<R>& pieces) {
  std::uint64_t sum = 0;
  for (const auto& c : mesh.columns) {
    const std::uint64_t row = static_cast<std::uint64_t>(c->width()) * bytes_of(c->kind());
    if (c->domain() == Domain::vertex) sum += row * (c->rows() + pieces.position.size());
    if (c->domain() == Domain::face) sum += row * (2 * kept + pieces.triangle.size());
    if (c->domain() == Domain::corner) sum += 3 * row * (2 * kept + pieces.triangle.size());
  }
  return sum;
}

clip::Cutting cutting_of(const Inputs& in, const Params& p) {
  return {clip_space(in.mesh->camera.get()), p.planes == Planes::near_only, p.guard_band};
}

Verdict clipping(const Inputs& in, const Params& p, const Context& ctx) {
  return ctx.real([&]<class R>() {
    const auto column = in.mesh->real<R>("position");
    const auto position = column->template values<glm::vec<4, R>>();
    const std::size_t vertex = clip::first_outside<R>(cutting_of(in, p), position);
    if (vertex == position.size())
      return off_exact("every vertex lies inside all six planes", in.mesh->faces());
    return on(fmt::format("vertex {} lies outside the view volume", vertex), in.mesh->faces());
  });
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  if (!ctx.simulates("clipping")) return {in.mesh};
  const clip::Cutting cutting = cutting_of(in, p);
  Ref<Mesh> result = in.mesh;
  ctx.real([&]<class R>() {
    using Point = glm::vec<4, R>;
    const auto column = in.mesh->real<R>("position");
    const auto position = column->template values<Point>();
    const auto triangle = in.mesh->triangles();
    const auto verdicts = clip::judge<R>(cutting, position, triangle);
    ctx.poll();
    ctx.count("triangles_dropped", verdicts.dropped + verdicts.undefined);
    ctx.count("triangles_cut", verdicts.cut);
    if (verdicts.undefined > 0)
      ctx.warn("undefined_positions",
               fmt::format("{} faces were dropped: a corner is NaN or infinite", verdicts.undefined));
    if (verdicts.all_kept()) return;
    const auto among = [&](clip::Verdict wanted) {
      return kernels::indices_where(triangle.size(),
                                    [&](std::size_t f) { return verdicts.face[f] == wanted; });
    };
    const auto kept = among(clip::Verdict::keep);
    if (verdicts.cut == 0) {
      ctx.claim(bytes_of_faces(*in.mesh, kept.size()));
      result = std::make_shared<Mesh>(select_faces(*in.mesh, kept));
      return;
    }
    const auto pieces = clip::cut_faces<R>(cutting, position, triangle, among(clip::Verdict::cut));
    ctx.poll();
    ctx.claim(bytes_with_pieces(*in.mesh, kept.size(), pieces));
    const Mesh source = column == in.mesh->share("position") ? *in.mesh : in.mesh->with(column);
    result = std::make_shared<Mesh>(with_pieces<R>(source, kept, pieces));
  });
  return {result};
}

}  // namespace

NodeType nodes::clip_homogeneous() {
  return node("clip.homogeneous", run)
      .doc("Cuts triangles against the view volume before the divide by w.")
      .cite("Sutherland & Hodgman 1974; Blinn & Newell 1978")
      .covers(35)
      .input("mesh", &Inputs::mesh,
             "Triangles in clip space; faces with a corner that is not finite are dropped.",
             {.space = Space::clip})
      .param("planes", &Params::planes,
             "Which sides of the volume cut; faces wholly outside any side go in every case.")
      .param("guard_band", &Params::guard_band,
             "Half-width of the x and y band that cuts; raising it cuts fewer faces.",
             {.unit = "w", .range = at_least(1)})
      .effect("clipping", clipping, "Faces are tested against the planes of the view volume, and cut.",
              {"face", 3})  // tests/bench/effects_bench.cpp, one thread: 2.9 to 3.2
      .output("mesh", &Outputs::mesh, "The parts inside, cut faces last; winding and attributes are kept.",
              {.space = Space::clip});
}

}  // namespace frustum
