#include "runtime/app/suite/relation.h"

#include "runtime/buffers/mesh.h"

#include <fmt/format.h>

namespace frustum {
namespace {

using Kind = Relation::Kind;

NodeError cannot(const std::string& what, const Buffer& b) {
  return {"no_relation", fmt::format("{}; this buffer is of kind {}", what, b.type().name)};
}

// A raster over `window` whose pixel x, y is that at from(x, y) of another, its real planes but for alpha
// times a factor.
template <class From>
Raster mapped(const Raster& source, const Rect& window, double times, From from) {
  Frame frame = source.frame();
  frame.window = window;
  Raster out(frame);
  const Tile to = out.view(), of = source.view();
  const Rect& w = source.frame().window;
  const auto copy_plane = [&]<class T>(int plane, T) {
    const bool coverage = frame.planes[static_cast<std::size_t>(plane)].name == "A";
    for (int sample = 0; sample < frame.samples(); ++sample)
      for (int y = window.y0; y < window.y1; ++y)
        for (int x = window.x0; x < window.x1; ++x) {
          const auto [fx, fy] = from(x, y);
          const T value = of.row<T>(plane, sample, fy)[fx - w.x0];
          T& target = to.row<T>(plane, sample, y)[x - window.x0];
          target = value;
          if constexpr (std::is_floating_point_v<T>)
            if (!coverage) target = static_cast<T>(static_cast<double>(value) * times);
        }
  };
  for (std::size_t p = 0; p < frame.planes.size(); ++p) switch (frame.planes[p].kind) {
      case PlaneKind::f32: copy_plane(static_cast<int>(p), float{}); break;
      case PlaneKind::f64: copy_plane(static_cast<int>(p), double{}); break;
      case PlaneKind::u32: copy_plane(static_cast<int>(p), std::uint32_t{}); break;
    }
  return out;
}

Buffer moved(const Relation& r, const Buffer& own, const Rect& window) {
  const Raster& source = own.type().raster(own.data());
  const Rect w = source.frame().window;
  const bool x = r.kind == Kind::mirror_x || r.kind == Kind::rotate_180;
  const bool y = r.kind == Kind::mirror_y || r.kind == Kind::rotate_180;
  return own.type().from_raster(
      mapped(source, window, r.kind == Kind::times ? r.times : 1, [&](int px, int py) {
        return std::pair{x ? w.x0 + w.x1 - 1 - px : px - r.shift.x,
                         y ? w.y0 + w.y1 - 1 - py : py - r.shift.y};
      }));
}

Buffer positions_times(const Mesh& mesh, const glm::dmat4& m) {
  const Column& p = mesh.at("position");
  if (p.width() != 3) throw NodeError("no_relation", "a matrix moves positions in object or world space");
  auto out = std::make_shared<Column>(p.name(), p.domain(), p.kind(), 3, p.rows(), p.space());
  for (std::size_t row = 0; row < p.rows(); ++row)
    for (int k = 0; k < 3; ++k) {
      const double v =
          m[0][k] * p.number(row, 0) + m[1][k] * p.number(row, 1) + m[2][k] * p.number(row, 2) + m[3][k];
      if (p.kind() == NumberKind::f64)
        out->values<glm::dvec3>()[row][k] = v;
      else
        out->values<glm::vec3>()[row][k] = static_cast<float>(v);
    }
  auto result = std::make_shared<Mesh>();
  result->columns = {mesh.share("triangle"), out};
  return Ref<Mesh>(std::move(result));
}

}  // namespace

RelatedPair related(const Relation& r, const Buffer& own, const Buffer& changed) {
  if (r.kind == Kind::same) return {changed, own};
  if (r.kind == Kind::matrix) {
    const auto a = changed.as<Mesh>(), b = own.as<Mesh>();
    if (!a || !b) throw cannot("a matrix moves the positions of a mesh", own);
    return {positions_times(*a, glm::dmat4{1}), positions_times(*b, r.matrix)};
  }
  if (!own.type().is_pixels() || &own.type() != &changed.type())
    throw cannot("this relation is between pixels", own);
  const Frame& frame = own.type().raster(own.data()).frame();
  if (frame.pattern && r.kind != Kind::times)
    throw NodeError("no_relation",
                    "pixels with several samples do not move: their samples would lie elsewhere");
  if (r.kind != Kind::shift) return {changed, moved(r, own, frame.window)};
  const Rect& w = frame.window;
  const Rect both = intersection(w, {w.x0 + r.shift.x, w.y0 + r.shift.y, w.x1 + r.shift.x, w.y1 + r.shift.y});
  if (both.empty()) throw NodeError("no_relation", "the shift leaves no pixel to compare");
  return {moved({.kind = Kind::same}, changed, both), moved(r, own, both)};
}

}  // namespace frustum
