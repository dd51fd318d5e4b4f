#include "nodes/clip/homogeneous.h"

#include "nodes/all_nodes.h"
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

// Kept faces and pieces of cut ones, merged in the order of their source faces.
struct Merged {
  std::vector<std::uint32_t> source;  // old face of each new one
  std::vector<std::uint32_t> piece;   // its number among the pieces, or `whole`
  static constexpr std::uint32_t whole = ~0U;
};
Merged merged(std::span<const std::uint32_t> kept, std::span<const std::uint32_t> pieces) {
  Merged m;
  m.source.reserve(kept.size() + pieces.size());
  m.piece.reserve(kept.size() + pieces.size());
  std::size_t k = 0;
  for (std::uint32_t p = 0; p < pieces.size(); ++p) {
    for (; k < kept.size() && kept[k] < pieces[p]; ++k)
      m.source.push_back(kept[k]), m.piece.push_back(Merged::whole);
    m.source.push_back(pieces[p]), m.piece.push_back(p);
  }
  m.source.insert(m.source.end(), kept.begin() + static_cast<std::ptrdiff_t>(k), kept.end());
  m.piece.resize(m.source.size(), Merged::whole);
  return m;
}

template <class R>
Ref<Column> new_vertices(const Column& old, const clip::Pieces<R>& pieces) {
  auto out = resized(old, old.rows() + pieces.position.size());
  copy_rows(old, *out);
  apply(pieces.vertices, old, *out, old.rows());
  if (old.name() == "position") {  // exact: the planes hold bit for bit
    const auto to = out->template values<glm::vec<4, R>>().subspan(old.rows());
    std::copy(pieces.position.begin(), pieces.position.end(), to.begin());
  }
  return out;
}

template <class R>
Ref<Column> new_corners(const Column& old, const clip::Pieces<R>& pieces, const Merged& m) {
  auto made = resized(old, pieces.corners.rows());
  apply(pieces.corners, old, *made, 0);
  const auto gathered = gather_faces(old, m.source);
  auto out = std::const_pointer_cast<Column>(gathered);  // made above, not yet published
  const std::size_t row = 3 * static_cast<std::size_t>(old.width()) * bytes_of(old.kind());
  for (std::size_t f = 0; f < m.piece.size(); ++f)
    if (m.piece[f] != Merged::whole)
      std::memcpy(static_cast<std::byte*>(out->data()) + f * row,
                  static_cast<const std::byte*>(made->data()) + m.piece[f] * row, row);
  return gathered;
}

template <class R>
Mesh with_pieces(const Mesh& mesh, std::span<const std::uint32_t> kept, const clip::Pieces<R>& pieces) {
  const Merged m = merged(kept, pieces.source);
  Mesh out = mesh;
  out.columns.clear();
  for (const auto& old : mesh.columns) {
    if (old->name() == "triangle") {
      auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, m.source.size());
      const auto from = old->values<glm::uvec3>();
      const auto to = triangle->template values<glm::uvec3>();
      for (std::size_t f = 0; f < to.size(); ++f)
        to[f] = m.piece[f] == Merged::whole ? from[m.source[f]] : pieces.triangle[m.piece[f]];
      out.columns.push_back(std::move(triangle));
    } else if (old->domain() == Domain::vertex) {
      out.columns.push_back(new_vertices(*old, pieces));
    } else if (old->domain() == Domain::corner) {
      out.columns.push_back(new_corners(*old, pieces, m));
    } else {
      out.columns.push_back(old->domain() == Domain::face ? gather_faces(*old, m.source) : old);
    }
  }
  if (mesh.find("origin") == nullptr)
    out.columns.push_back(
        Column::make<std::uint32_t>("origin", Domain::face, std::span<const std::uint32_t>(m.source)));
  if (mesh.closed == true) out.closed = false;
  return out;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const clip::Cutting cutting{in.mesh->camera && in.mesh->camera->reversed_z, p.planes == Planes::near_only,
                              p.guard_band};
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
      result = std::make_shared<Mesh>(select_faces(*in.mesh, kept));
      return;
    }
    const auto pieces = clip::cut_faces<R>(cutting, position, triangle, among(clip::Verdict::cut));
    ctx.poll();
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
      .output("mesh", &Outputs::mesh,
              "The parts inside; winding and attributes are kept, origin names the source face.",
              {.space = Space::clip});
}

}  // namespace frustum
