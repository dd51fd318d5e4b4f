#include "runtime/io/ply.h"

#include "runtime/buffers/material.h"
#include "runtime/io/column_names.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/file_colors.h"
#include "runtime/io/normals.h"
#include "runtime/io/ply_body.h"
#include "runtime/io/ply_faces.h"
#include "runtime/io/printable.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <set>
#include <utility>

namespace frustum {
namespace {

using ply::Cut;
using ply::Element;
using ply::Piece;
using ply::Property;

template <class R>
class PlyReader {
 public:
  PlyReader(std::string_view bytes, const FilePath& file, Context& ctx)
      : bytes_(bytes), file_(file), ctx_(ctx), header_(ply::read_header(bytes, file)) {}

  Mesh run() {
    find_elements();
    cut();
    plan_vertices();
    plan_faces();
    decode();
    make_triangles();
    finish_normals();
    finish_colors();
    report();
    return collect();
  }

 private:
  using Vec2 = glm::vec<2, R>;
  using Vec3 = glm::vec<3, R>;
  using Slot = ply::Slot<R>;
  using Use = typename Slot::Use;
  using Names = std::initializer_list<std::string_view>;

  // ----- what the file has

  [[noreturn]] void fail(std::string_view what) const {
    throw NodeError("malformed_file", fmt::format("{}: {}", file_.written, what));
  }

  void find_elements() {
    const auto vertex = header_.find("vertex");
    if (!vertex) fail("it has no element 'vertex'");
    vertex_ = *vertex;
    faces_ = header_.find("face");
    strips_ = header_.find("tristrips");
    for (std::size_t e = 0; e < header_.elements.size(); ++e)
      if (e != vertex_ && e != faces_ && e != strips_)
        skipped_.push_back(fmt::format("element {}", header_.elements[e].name));
    for (const std::string& name : header_.textures) skipped_.push_back("TextureFile " + printable(name, 80));
    vertices_ = header_.elements[vertex_].rows;
  }

  [[noreturn]] void too_large() const {
    throw NodeError("too_large", fmt::format("{} has more than 2^31 corners or vertices", file_.written));
  }

  void cut() {
    std::vector<bool> wanted(header_.elements.size());
    wanted[vertex_] = true;
    if (faces_) wanted[*faces_] = true;
    if (strips_) wanted[*strips_] = true;
    pieces_ = ply::cut_rows(header_, bytes_, wanted, file_, ctx_, tail_);
    if (vertices_ > std::uint64_t{1} << 31) too_large();
    lists_.resize(pieces_.size());
  }

  // ----- what becomes of each property

  std::vector<Slot> slots_of(const Element& e) const {
    std::vector<Slot> slots;
    for (const Property& p : e.properties) slots.push_back({.type = p.type, .count = p.count});
    return slots;
  }

  // A column of `names`, where the element has all of them as numbers.
  std::shared_ptr<Column> take(const Element& e, std::vector<Slot>& slots,
                               std::initializer_list<std::string_view> names, std::string_view column_name,
                               bool finite, Space space = Space::none) {
    std::vector<std::size_t> at;
    for (const std::string_view name : names) {
      const auto p = e.find(name);
      if (!p || e.properties[*p].count || slots[*p].use != Use::skip) return nullptr;
      at.push_back(*p);
    }
    const Domain domain = &e == &header_.elements[vertex_] ? Domain::vertex : Domain::face;
    auto column = std::make_shared<Column>(column_name, domain, number_kind_of<R>,
                                           static_cast<int>(at.size()), e.rows, space);
    for (std::size_t k = 0; k < at.size(); ++k) {
      Slot& slot = slots[at[k]];
      slot.use = Use::real, slot.finite = finite;
      slot.real = static_cast<R*>(column->data()) + k, slot.stride = at.size();
    }
    return column;
  }

  void plan_vertices() {
    const Element& e = header_.elements[vertex_];
    slots_.resize(header_.elements.size());
    auto& slots = slots_[vertex_] = slots_of(e);
    position_ = take(e, slots, {"x", "y", "z"}, "position", true, Space::object);
    if (!position_) fail("its element 'vertex' has no x, y and z");
    normal_ = take(e, slots, {"nx", "ny", "nz"}, "normal", false);
    for (const Names names :
         {Names{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}})
      if (!uv_) uv_ = take(e, slots, names, "uv", true);
    color_ = take_color(e, slots, color_scale_);
    take_more_uv(e, slots);
    take_others(e, slots, Domain::vertex);
  }

  // What write_ply makes of columns uv1, uv2 ...
  void take_more_uv(const Element& e, std::vector<Slot>& slots) {
    constexpr std::uint32_t most_uv_sets = 16;  // as many as are read of glTF
    for (std::uint32_t set = 1; set < most_uv_sets; ++set) {
      const std::string name = uv_column_name(set), u = name + "_x", v = name + "_y";
      if (auto column = take(e, slots, {u, v}, name, true)) vertex_others_.push_back(std::move(column));
    }
  }

  //   scale  becomes what stands for 1; 0: linear
  std::shared_ptr<Column> take_color(const Element& e, std::vector<Slot>& slots, int& scale) {
    for (const Names names : {Names{"red", "green", "blue", "alpha"},
                              {"red", "green", "blue"},
                              {"diffuse_red", "diffuse_green", "diffuse_blue"}}) {
      const auto first = e.find(*names.begin());
      auto column = take(e, slots, names, "color", true);
      if (!column) continue;
      const ply::Number type = e.properties[*first].type;
      scale = is_real(type) ? 0 : type == ply::Number::u16 ? 65535 : 255;
      return column;
    }
    return nullptr;
  }

  // Columns of a mesh have different names, and elements may have properties of the same.
  std::string own_name(const std::string& property, Domain domain) {
    std::string name = (has_meaning(property) ? "ply_" : "") + property;
    if (taken_.contains(name) && domain == Domain::face) name.insert(0, "face_");
    const std::size_t length = name.size();
    for (int n = 2; !taken_.insert(name).second; ++n) name.replace(length, name.npos, fmt::format("_{}", n));
    return name;
  }

  // Numbers without a meaning here, as columns of their own.
  void take_others(const Element& e, std::vector<Slot>& slots, Domain domain) {
    for (std::size_t p = 0; p < slots.size(); ++p) {
      Slot& slot = slots[p];
      const Property& property = e.properties[p];
      if (slot.use != Use::skip) continue;
      if (slot.count) {
        skipped_.push_back(fmt::format("{}.{}", e.name, property.name));
        continue;
      }
      const std::string name = own_name(property.name, domain);
      const bool is_signed =
          slot.type == ply::Number::i8 || slot.type == ply::Number::i16 || slot.type == ply::Number::i32;
      const NumberKind kind = is_real(slot.type) ? number_kind_of<R>
                              : is_signed        ? NumberKind::i32
                                                 : NumberKind::u32;
      auto column = std::make_shared<Column>(name, domain, kind, 1, e.rows);
      slot.use = is_real(slot.type) ? Use::real : Use::whole;
      if (slot.use == Use::real)
        slot.real = static_cast<R*>(column->data());
      else
        slot.whole = static_cast<std::uint32_t*>(column->data());
      (domain == Domain::vertex ? vertex_others_ : face_others_).push_back(std::move(column));
    }
  }

  void plan_faces() {
    for (const auto element : {faces_, strips_}) {
      if (!element) continue;
      const Element& e = header_.elements[*element];
      auto& slots = slots_[*element] = slots_of(e);
      auto indices = e.find("vertex_indices");
      if (!indices) indices = e.find("vertex_index");
      if (!indices || !slots[*indices].count) {
        if (e.rows != 0) fail(fmt::format("its element '{}' has no list vertex_indices", e.name));
        continue;
      }
      slots[*indices].use = Use::indices;
      if (element == strips_) continue;
      const auto corners = e.find("texcoord");
      if (corners && slots[*corners].count && is_real(slots[*corners].type) && !uv_) {
        slots[*corners].use = Use::corner_uv;
        has_corner_uv_ = true;
      }
      // Triangles of strips have none, and would be black.
      if (!color_ && !strips_) face_color_ = take_color(e, slots, color_scale_);
      take_others(e, slots, Domain::face);
    }
  }

  // ----- reading

  void decode() {
    tbb::parallel_for(std::size_t{0}, pieces_.size(), [&](std::size_t i) {
      if (ctx_.cancel != nullptr && ctx_.cancel->cancelled()) return;
      const std::size_t e = pieces_[i].element;
      ply::decode<R>(header_, pieces_[i], slots_[e], vertices_, e == strips_, lists_[i]);
    });
    ctx_.poll();
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      if (!lists_[i].error.empty()) fail_row(i);
  }

  [[noreturn]] void fail_row(std::size_t piece) const {
    const std::size_t at =
        static_cast<std::size_t>(pieces_[piece].bytes.data() - bytes_.data()) + lists_[piece].byte;
    const std::string place = header_.encoding == ply::Encoding::ascii && header_.line_end == '\n'
                                  ? place_in(file_, bytes_, at)
                                  : fmt::format("{}: byte {}", file_.written, at);
    throw NodeError("malformed_file",
                    fmt::format("{}: {} {}: {}", place, header_.elements[pieces_[piece].element].name,
                                lists_[piece].row, lists_[piece].error));
  }

  // ----- triangles

  void make_triangles() {
    const auto positions = std::as_const(*position_).template values<Vec3>();
    std::vector<Cut> cuts(pieces_.size());
    tbb::parallel_for(std::size_t{0}, pieces_.size(), [&](std::size_t i) {
      if (pieces_[i].element == faces_)
        ply::cut_faces<R>(lists_[i], pieces_[i].first, positions,
                          {has_corner_uv_, !face_others_.empty() || face_color_}, cuts[i]);
      else if (pieces_[i].element == strips_)
        ply::cut_strips(lists_[i].sizes, lists_[i].indices, cuts[i]);
    });
    ctx_.poll();
    std::vector<std::size_t> first(pieces_.size());
    std::size_t total = 0;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      first[i] = total, total += cuts[i].triangles.size();
      fans_ += cuts[i].fans, faces_skipped_ += cuts[i].skipped, uv_missing_ += lists_[i].odd_uv;
    }
    if (3 * total > std::size_t{1} << 31) too_large();
    triangle_ = Column::make<glm::uvec3>("triangle", Domain::face, total);
    const auto out = triangle_->values<glm::uvec3>();
    tbb::parallel_for(std::size_t{0}, cuts.size(), [&](std::size_t i) {
      std::copy(cuts[i].triangles.begin(), cuts[i].triangles.end(),
                out.begin() + static_cast<std::ptrdiff_t>(first[i]));
    });
    if (has_corner_uv_) uv_ = ply::gather_corner_uv<R>(cuts, first, lists_, total);
    for (Ref<Column>& column : face_others_) column = ply::gather_face_column(*column, cuts, first, total);
    if (face_color_) color_ = of_corners(*ply::gather_face_column(*face_color_, cuts, first, total));
  }

  // Colours stand at vertices or corners here.
  std::shared_ptr<Column> of_corners(const Column& faces) const {
    const std::size_t row = bytes_of(faces.kind()) * static_cast<std::size_t>(faces.width());
    ctx_.claim(3 * faces.rows() * row);
    auto out =
        std::make_shared<Column>(faces.name(), Domain::corner, faces.kind(), faces.width(), 3 * faces.rows());
    const auto* from = static_cast<const std::byte*>(faces.data());
    auto* to = static_cast<std::byte*>(out->data());
    for (std::size_t c = 0; c < out->rows(); ++c) std::copy_n(from + c / 3 * row, row, to + c * row);
    return out;
  }

  // ----- finishing

  void finish_normals() {
    if (!normal_ && triangle_->rows() == 0) return;
    const bool stated = normal_ != nullptr;
    if (!stated) normal_ = Column::make<Vec3>("normal", Domain::vertex, vertices_);
    if (!stated) std::fill_n(normal_->template values<Vec3>().begin(), vertices_, Vec3(0));
    normals_computed_ = finish_vertex_normals<R>(*normal_, std::as_const(*triangle_).values<glm::uvec3>(),
                                                 std::as_const(*position_).template values<Vec3>(), ctx_);
  }

  void finish_colors() {
    if (!color_ || color_scale_ == 0) return;
    decode_srgb<R>(*color_, color_scale_, ctx_);
  }

  void report() {
    ctx_.count("triangles", triangle_->rows());
    ctx_.count("vertices", vertices_);
    const auto warn = [&](std::uint64_t n, const char* code, std::string_view what) {
      if (n != 0) ctx_.warn(code, fmt::format("{}: {} {}", file_.written, n, what));
    };
    warn(normals_computed_, "normals_computed",
         "vertices have no normal; it is the area-weighted mean of the faces around");
    warn(uv_missing_, "uv_missing",
         "faces have a list of texture coordinates of another length; they are 0, 0");
    warn(fans_, "polygon_fan", "polygons cross themselves or have no area; they became fans");
    warn(faces_skipped_, "faces_skipped", "faces have fewer than 3 corners");
    warn(tail_, "trailing_bytes", "bytes stand after the last row");
    if (!skipped_.empty()) ctx_.warn("properties_skipped", skipped_text());
    if (triangle_->rows() == 0) ctx_.warn("no_faces", fmt::format("{} has no faces", file_.written));
  }

  std::string skipped_text() const {
    constexpr std::size_t most = 10;
    const std::size_t shown = std::min(skipped_.size(), most);
    return fmt::format(
        "{}: skipped {}{}", file_.written,
        fmt::join(skipped_.begin(), skipped_.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
        shown < skipped_.size() ? fmt::format(" and {} more", skipped_.size() - shown) : "");
  }

  Mesh collect() {
    Mesh m;
    m.columns = {triangle_, position_};
    for (const Ref<Column>& c : {Ref<Column>(normal_), Ref<Column>(uv_), Ref<Column>(color_)})
      if (c) m.columns.push_back(c);
    m.columns.insert(m.columns.end(), vertex_others_.begin(), vertex_others_.end());
    m.columns.insert(m.columns.end(), face_others_.begin(), face_others_.end());
    return m;
  }

  std::string_view bytes_;
  const FilePath& file_;
  Context& ctx_;
  ply::Header header_;
  std::size_t vertex_ = 0, tail_ = 0;
  std::optional<std::size_t> faces_, strips_;
  std::uint64_t vertices_ = 0;
  std::vector<Piece> pieces_;
  std::vector<ply::Lists<R>> lists_;
  std::vector<std::vector<Slot>> slots_;  // by element
  std::shared_ptr<Column> position_, normal_, uv_, color_, face_color_, triangle_;
  std::vector<Ref<Column>> vertex_others_, face_others_;
  std::set<std::string> taken_;  // their names
  int color_scale_ = 0;          // 0: linear
  bool has_corner_uv_ = false;
  std::uint64_t fans_ = 0, faces_skipped_ = 0, uv_missing_ = 0, normals_computed_ = 0;
  std::vector<std::string> skipped_;
};

}  // namespace

Mesh read_ply(std::string_view bytes, const FilePath& file, Context& ctx) {
  return ctx.real([&]<class R>() { return PlyReader<R>(bytes, file, ctx).run(); });
}

}  // namespace frustum
