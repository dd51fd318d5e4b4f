#include "runtime/io/obj.h"

#include "nodes/kernels/transfer.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/mtl.h"
#include "runtime/io/normals.h"
#include "runtime/io/obj_faces.h"
#include "runtime/io/obj_parse.h"
#include "runtime/io/obj_vertices.h"
#include "runtime/io/triangulate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>
#include <utility>

namespace frustum {
namespace {

using obj::absent;
using obj::Corner;

// From parsed chunks to one mesh. Everything that depends on order runs over the chunks in order.
template <class R>
class Assembler {
 public:
  Assembler(std::string_view text, const FilePath& file, Context& ctx)
      : text_(text), file_(file), ctx_(ctx) {}

  Mesh run() {
    parse();
    number_chunks();
    resolve();
    flatten();
    triangulate_polygons();
    weld();
    Mesh m;
    m.columns = {triangles(), gather()};
    m.columns.push_back(normal_column());
    if (has_colors_) m.columns.push_back(color_column());
    if (const Ref<Column> uv = uv_column(); uv_missing_ < vertex_count())
      m.columns.push_back(uv);
    else
      uv_missing_ = 0;
    add_names(m);
    report();
    return m;
  }

 private:
  using Vec2 = glm::vec<2, R>;
  using Vec3 = glm::vec<3, R>;

  // Where a chunk's items start in the whole file.
  struct Base {
    std::size_t v = 0, vt = 0, vn = 0, triangles = 0;
  };

  template <class Body>
  void for_chunks(Body&& body) {
    tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) {
      if (ctx_.cancel == nullptr || !ctx_.cancel->cancelled()) body(i);
    });
    ctx_.poll();
  }

  [[noreturn]] void fail(std::size_t chunk, std::size_t at, std::string_view what) const {
    const auto offset = static_cast<std::size_t>(chunks_[chunk].text.data() - text_.data()) + at;
    throw NodeError("malformed_file", fmt::format("{}: {}", place_in(file_, text_, offset), what));
  }

  void parse() {
    const auto pieces = obj::split_lines(text_, std::size_t{1} << 20);
    chunks_.resize(pieces.size());
    for_chunks([&](std::size_t i) { obj::parse(pieces[i], chunks_[i]); });
    for (std::size_t i = 0; i < chunks_.size(); ++i)
      if (!chunks_[i].error.empty()) fail(i, chunks_[i].error_at, chunks_[i].error);
  }

  void number_chunks() {
    Base b;
    for (const auto& c : chunks_) {
      bases_.push_back(b);
      b.v += c.positions.size() / 3, b.vt += c.uvs.size() / 2, b.vn += c.normals.size() / 3;
      b.triangles += c.corners.size() - 2 * c.sizes.size();
    }
    total_ = b;
    if (std::max({b.v, b.vt, b.vn, 3 * b.triangles}) > std::size_t{1} << 31)
      throw NodeError("too_large", fmt::format("{} has more than 2^31 corners or vertices", file_.written));
  }

  // Makes relative indices absolute, and finds the first face that names something that is not there.
  void resolve() {
    std::vector<std::size_t> wrong(chunks_.size(), ~std::size_t{0});
    for_chunks([&](std::size_t i) {
      auto& c = chunks_[i];
      for (const std::size_t k : c.relative) {
        Corner& corner = c.corners[k / 3];
        if (k % 3 == 0) corner.v += static_cast<std::int32_t>(bases_[i].v);
        if (k % 3 == 1) corner.vt += static_cast<std::int32_t>(bases_[i].vt);
        if (k % 3 == 2) corner.vn += static_cast<std::int32_t>(bases_[i].vn);
      }
      const auto inside = [](std::int32_t index, std::size_t n) {
        return index >= 0 && static_cast<std::size_t>(index) < n;
      };
      for (std::size_t k = 0; k < c.corners.size() && wrong[i] == ~std::size_t{0}; ++k) {
        const Corner& corner = c.corners[k];
        if (!inside(corner.v, total_.v) || (corner.vt != absent && !inside(corner.vt, total_.vt)) ||
            (corner.vn != absent && !inside(corner.vn, total_.vn)))
          wrong[i] = k;
      }
    });
    for (std::size_t i = 0; i < chunks_.size(); ++i)
      if (wrong[i] != ~std::size_t{0}) fail_index(i, wrong[i]);
  }

  [[noreturn]] void fail_index(std::size_t chunk, std::size_t corner) const {
    const auto& c = chunks_[chunk];
    std::size_t face = 0, end = 0;
    while ((end += c.sizes[face]) <= corner) ++face;
    fail(chunk, obj::find_face(c.text, face),
         fmt::format("a corner names what is not there: the file has {} v, {} vt and {} vn", total_.v,
                     total_.vt, total_.vn));
  }

  void flatten() {
    positions_.resize(total_.v), normals_.resize(total_.vn), uvs_.resize(total_.vt);
    has_colors_ =
        std::any_of(chunks_.begin(), chunks_.end(), [](const auto& c) { return !c.colors.empty(); });
    if (has_colors_) colors_.assign(total_.v, Vec3{1});
    for_chunks([&](std::size_t i) {
      auto& c = chunks_[i];
      for (std::size_t k = 0; k < c.positions.size() / 3; ++k)
        positions_[bases_[i].v + k] = {c.positions[3 * k], c.positions[3 * k + 1], c.positions[3 * k + 2]};
      for (std::size_t k = 0; k < c.normals.size() / 3; ++k)
        normals_[bases_[i].vn + k] = {c.normals[3 * k], c.normals[3 * k + 1], c.normals[3 * k + 2]};
      for (std::size_t k = 0; k < c.uvs.size() / 2; ++k)
        uvs_[bases_[i].vt + k] = {c.uvs[2 * k], c.uvs[2 * k + 1]};
      for (std::size_t k = 0; k < c.colors.size() / 3; ++k)
        colors_[bases_[i].v + k] = {c.colors[3 * k], c.colors[3 * k + 1], c.colors[3 * k + 2]};
      c.positions = {}, c.normals = {}, c.uvs = {}, c.colors = {};
    });
  }

  // Afterwards every three corners of a chunk are a triangle.
  void triangulate_polygons() {
    std::vector<std::uint64_t> fans(chunks_.size());
    for_chunks([&](std::size_t i) {
      auto& c = chunks_[i];
      if (c.corners.size() == 3 * c.sizes.size()) return;
      std::vector<Corner> out;
      out.reserve(3 * (c.corners.size() - 2 * c.sizes.size()));
      std::vector<glm::dvec3> polygon;
      std::vector<std::array<std::uint32_t, 3>> cut;
      const Corner* face = c.corners.data();
      for (const std::uint32_t n : c.sizes) {
        polygon.clear(), cut.clear();
        for (std::uint32_t k = 0; k < n; ++k)
          polygon.emplace_back(positions_[static_cast<std::size_t>(face[k].v)]);
        if (!triangulate(polygon, cut)) ++fans[i];
        for (const auto& t : cut) out.insert(out.end(), {face[t[0]], face[t[1]], face[t[2]]});
        face += n;
      }
      c.corners = std::move(out);
    });
    for (const std::uint64_t n : fans) fans_ += n;
  }

  // Numbers the distinct (vt, vn) at each position; a corner's vt becomes that number.
  void weld() {
    vertices_ = obj::VertexSet(total_.v);
    for (auto& c : chunks_) {
      ctx_.poll();
      for (Corner& k : c.corners) k.vt = vertices_.add(k);
    }
    vertices_.finish();
  }

  std::size_t vertex_count() const { return vertices_.size(); }

  Ref<Column> triangles() {
    auto column = Column::make<glm::uvec3>("triangle", Domain::face, total_.triangles);
    const auto out = column->template values<glm::uvec3>();
    for_chunks([&](std::size_t i) {
      const auto& corners = chunks_[i].corners;
      const auto vertex = [&](const Corner& k) { return vertices_.vertex(k.v, k.vt); };
      for (std::size_t t = 0; 3 * t < corners.size(); ++t)
        out[bases_[i].triangles + t] = {vertex(corners[3 * t]), vertex(corners[3 * t + 1]),
                                        vertex(corners[3 * t + 2])};
    });
    return column;
  }

  Ref<Column> gather() {
    auto column = Column::make<Vec3>("position", Domain::vertex, vertex_count(), Space::object);
    const auto out = column->template values<Vec3>();
    vertices_.for_each([&](std::size_t i, std::size_t v, const obj::Variant&) { out[i] = positions_[v]; });
    return column;
  }

  Ref<Column> uv_column() {
    auto column = Column::make<Vec2>("uv", Domain::vertex, vertex_count());
    const auto out = column->template values<Vec2>();
    std::atomic<std::uint64_t> missing{0};
    vertices_.for_each([&](std::size_t i, std::size_t, const obj::Variant& k) {
      if (k.vt == absent) ++missing;
      out[i] = k.vt == absent ? Vec2{0} : uvs_[static_cast<std::size_t>(k.vt)];
    });
    uv_missing_ = missing;
    return column;
  }

  Ref<Column> normal_column() {
    auto column = Column::make<Vec3>("normal", Domain::vertex, vertex_count());
    const auto out = column->template values<Vec3>();
    std::atomic<std::uint64_t> missing{0};
    const Vec3 none{0};
    vertices_.for_each([&](std::size_t i, std::size_t, const obj::Variant& k) {
      const auto n =
          k.vn == absent ? std::nullopt : unit(glm::dvec3(normals_[static_cast<std::size_t>(k.vn)]));
      if (!n) ++missing;
      out[i] = n ? Vec3(*n) : none;
    });
    if ((normals_computed_ = missing) == 0) return column;
    const std::vector<glm::dvec3> sums = area_normals();
    vertices_.for_each([&](std::size_t i, std::size_t v, const obj::Variant&) {
      if (out[i] == none) out[i] = Vec3(unit(sums[v]).value_or(glm::dvec3(0, 0, 1)));
    });
    return column;
  }

  // Around each v of the file: a seam in texture coordinates makes no crease.
  std::vector<glm::dvec3> area_normals() const {
    std::vector<glm::dvec3> sums(total_.v, glm::dvec3(0));
    for (const auto& c : chunks_)
      add_area_normals<Vec3>(
          c.corners.size() / 3,
          [&](std::size_t t, std::size_t k) { return static_cast<std::size_t>(c.corners[3 * t + k].v); },
          positions_, sums, ctx_);
    return sums;
  }

  // sRGB, as the programs that write colours there do.
  Ref<Column> color_column() {
    auto column = Column::make<Vec3>("color", Domain::vertex, vertex_count());
    const auto out = column->template values<Vec3>();
    vertices_.for_each([&](std::size_t i, std::size_t v, const obj::Variant&) {
      for (glm::length_t k = 0; k < 3; ++k)
        out[i][k] = static_cast<R>(kernels::decode(kernels::Curve::srgb, static_cast<double>(colors_[v][k])));
    });
    return column;
  }

  void add_names(Mesh& m) {
    obj::FaceNames names = obj::name_faces<R>(chunks_, total_.triangles);
    if (names.group) m.columns.push_back(std::move(names.group));
    if (!names.material) return;
    const Ref<Column> material = names.material;
    m.columns.push_back(material);
    std::vector<std::string_view> libraries;
    for (const auto& c : chunks_) libraries.insert(libraries.end(), c.libraries.begin(), c.libraries.end());
    FileMaterials from = read_materials(libraries, file_, names.materials, m.find("uv") != nullptr, ctx_);
    if (auto clear = transparency_by_material<R>(material->values<std::uint32_t>(), from.opacity))
      m.columns.push_back(std::move(clear));
    m.materials = std::make_shared<const MaterialSet>(std::move(from.set));
  }

  void report() {
    std::map<std::string_view, std::uint64_t> other;
    for (const auto& c : chunks_)
      for (const auto& [key, n] : c.other) other[key] += n;
    ctx_.count("triangles", total_.triangles);
    ctx_.count("vertices", vertex_count());
    std::uint64_t groups = 0;
    for (const auto& c : chunks_)
      for (const obj::FaceChange& change : c.changes) groups += change.kind != obj::FaceChange::material;
    ctx_.count("groups", groups);
    other.erase("s");
    std::vector<std::string> skipped;
    for (const auto& [key, n] : other) skipped.push_back(fmt::format("{} x {}", n, key));
    const auto warn = [&](std::uint64_t n, const char* code, std::string_view what) {
      if (n != 0) ctx_.warn(code, fmt::format("{}: {} {}", file_.written, n, what));
    };
    warn(normals_computed_, "normals_computed",
         "vertices have no normal; it is the area-weighted mean of the faces around");
    warn(uv_missing_, "uv_missing", "vertices have no texture coordinates; they are 0, 0");
    warn(fans_, "polygon_fan", "polygons cross themselves or have no area; they became fans");
    if (!skipped.empty())
      ctx_.warn("statements_skipped", fmt::format("{}: skipped {}", file_.written, fmt::join(skipped, ", ")));
    if (total_.triangles == 0) ctx_.warn("no_faces", fmt::format("{} has no faces", file_.written));
  }

  std::string_view text_;
  const FilePath& file_;
  Context& ctx_;
  std::vector<obj::Chunk<R>> chunks_;
  std::vector<Base> bases_;
  Base total_;
  std::vector<Vec3> positions_, normals_, colors_;
  std::vector<Vec2> uvs_;
  obj::VertexSet vertices_{0};
  std::uint64_t fans_ = 0, uv_missing_ = 0, normals_computed_ = 0;
  bool has_colors_ = false;
};

}  // namespace

Mesh read_obj(std::string_view text, const FilePath& file, Context& ctx) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return ctx.real([&]<class R>() { return Assembler<R>(text, file, ctx).run(); });
}

}  // namespace frustum
