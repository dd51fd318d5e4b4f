#include "nodes/texture/sample.h"

#include "nodes/kernels/any_seen.h"
#include "nodes/texture.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/minification.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/buffers/texels.h"
#include "runtime/buffers/texture_facts.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <algorithm>

namespace frustum {

using kernels::Lookup;

namespace {

struct Inputs {
  Tiled<Image> points;
  std::optional<Ref<Texture>> texture;
  std::optional<Ref<Mesh>> mesh;
  std::optional<Ref<Material>> material;
};
struct Params {
  Lookup filter = Lookup::trilinear;
  double max_anisotropy = 16;
};
struct Outputs {
  Tiled<Image> image;
};

// What is looked up for some faces: no texture is white.
struct Skin {
  Ref<Texture> texture;
  std::optional<std::array<float, 4>> constant;  // every texel of every level has these bits
  std::vector<kernels::TexelLevel> levels;       // of a pyramid
  std::array<RealPlane, 6> uv{};                 // u v du_dx dv_dx du_dy dv_dy
  std::optional<glm::dmat3> texture_from_uv;
  double alpha_cutoff = 0;
};

struct State {
  Precision precision;
  kernels::Filtering filter;
  std::vector<Skin> skins;             // at least one
  std::vector<std::uint32_t> skin_of;  // by face; empty: all have the first
  std::array<RealPlane, 4> color{};    // of the vertices; the last one, opacity, where they have it
  int id = -1;
};

static_assert(static_cast<int>(Wrap::repeat) == static_cast<int>(kernels::EdgeRule::repeat) &&
              static_cast<int>(Wrap::clamp) == static_cast<int>(kernels::EdgeRule::clamp) &&
              static_cast<int>(Wrap::mirror) == static_cast<int>(kernels::EdgeRule::mirror) &&
              static_cast<int>(Wrap::border) == static_cast<int>(kernels::EdgeRule::border));
constexpr kernels::EdgeRule edge_rule(Wrap w) { return static_cast<kernels::EdgeRule>(w); }

// ----- preparation

// What was decided about the effects of the node, and what a skin is made from.
struct Wish {
  const Inputs& in;
  Lookup filter;
  Precision precision;
  bool lookup, all_lookups, levels, all_levels;  // simulated; forced
};

constexpr std::string_view lookup_name = "texture_lookup", levels_name = "mip_levels";

Wish wish_of(const Inputs& in, const Params& p, const Context& ctx) {
  return {in,
          p.filter,
          ctx.precision,
          ctx.simulates(lookup_name),
          ctx.forces(lookup_name),
          ctx.simulates(levels_name),
          ctx.forces(levels_name)};
}

constexpr std::array uv_planes{".u", ".v", ".du_dx", ".dv_dx", ".du_dy", ".dv_dy"};

// Whether read_real() would take the planes of a set of coordinates. What is known without them is still
// refused where they are not there, so that whether a graph is right does not depend on what a texture holds.
bool readable(const Wish& w, const std::string& uv, std::size_t planes) {
  const Frame& f = w.in.points.frame();
  for (std::size_t i = 0; i < planes; ++i) {
    const auto at = f.find(uv + uv_planes[i]);
    if (!at) return false;
    const PlaneKind kind = f.planes[static_cast<std::size_t>(*at)].kind;
    if (kind == PlaneKind::u32 || (kind == PlaneKind::f64 && w.precision == Precision::single)) return false;
  }
  return true;
}

Skin skin_of_texture(const Wish& w, Ref<Texture> texture, std::uint32_t uv_set) {
  Skin s{
      .texture = texture, .constant = {}, .levels = texel_levels(*texture), .uv = {}, .texture_from_uv = {}};
  if (const auto* pyramid = std::get_if<MipPyramid>(&texture->source)) s.alpha_cutoff = pyramid->alpha_cutoff;
  const std::string uv = uv_column_name(uv_set);
  const bool board = std::holds_alternative<Checker>(texture->source);
  const bool filters = w.filter > Lookup::bilinear || (board && w.filter == Lookup::bilinear);
  const std::size_t planes = filters ? 6 : 2;
  const bool known = readable(w, uv, planes);
  if (known && !w.all_lookups) s.constant = constant_color(*texture);
  if (known && !w.lookup && !s.constant) s.constant = {1, 1, 1, 1};
  if (s.constant) return s;
  // Of a pyramid of one level, or one that is asked not to be used, that level is read, and derivatives by
  // ewa alone.
  const bool base_only = known && !board && !w.all_levels && (!w.levels || s.levels.size() == 1);
  if (base_only) s.levels.resize(1);
  for (std::size_t i = 0; i < (base_only && w.filter != Lookup::ewa ? 2 : planes); ++i)
    s.uv[i] = read_real(w.in.points, uv + uv_planes[i], w.precision);
  return s;
}

// What is not there is white. Forced, it is looked up like any texture: in one texel, at the points' first
// coordinates.
Skin white_skin(const Wish& w) {
  const std::string uv = uv_column_name(0);
  if (!w.all_lookups || !readable(w, uv, uv_planes.size())) return {};
  static const auto texel = std::make_shared<const Texture>(MipPyramid{.levels = {{1, 1, {1, 1, 1, 1}}}});
  return skin_of_texture(w, texel, 0);
}

Skin skin_of_material(const Wish& w, const Material& m) {
  const Inputs& in = w.in;
  if (!m.texture) return white_skin(w);
  if (!in.points.frame().find(uv_column_name(m.uv_set) + ".u"))
    throw NodeError("missing_uv",
                    fmt::format("material \"{}\" has a texture, but the mesh has no texture coordinates "
                                "for it: column {}",
                                m.name, uv_column_name(m.uv_set)),
                    at_input("points"));
  Skin s = skin_of_texture(w, m.texture, m.uv_set);
  if (m.texture_from_uv != glm::dmat3(1)) s.texture_from_uv = m.texture_from_uv;
  return s;
}

// The skins of the materials that faces have, and which each face takes.
void dress_faces(const Wish& w, const Mesh& mesh, State& s) {
  const auto& materials = mesh.materials->materials;
  const Column* column = mesh.find("material");
  if (column == nullptr) {
    s.skins = {skin_of_material(w, materials[0])};
    return;
  }
  constexpr std::uint32_t unused = ~std::uint32_t{0}, used = unused - 1;
  std::vector<std::uint32_t> skin(materials.size(), unused);
  const auto of = column->values<std::uint32_t>();
  for (const std::uint32_t m : of) {
    if (m >= skin.size())
      throw NodeError("bad_material", "a face has a material that the mesh does not have");
    skin[m] = used;
  }
  std::optional<std::uint32_t> white;  // one for all that have no texture
  for (std::size_t m = 0; m < skin.size(); ++m) {
    if (skin[m] == unused) continue;
    const bool plain = materials[m].texture == nullptr;
    if (plain && white) {
      skin[m] = *white;
      continue;
    }
    skin[m] = static_cast<std::uint32_t>(s.skins.size());
    if (plain) white = skin[m];
    s.skins.push_back(skin_of_material(w, materials[m]));
  }
  if (s.skins.empty()) s.skins.push_back(white_skin(w));
  if (s.skins.size() == 1) return;
  s.skin_of.resize(of.size());
  for (std::size_t f = 0; f < of.size(); ++f) s.skin_of[f] = skin[of[f]];
}

void dress(const Wish& w, State& s) {
  const Inputs& in = w.in;
  if (in.mesh && (*in.mesh)->faces() == 0) {  // nothing is seen, and nothing needs coordinates
    s.skins = {white_skin(w)};
    return;
  }
  if (in.texture) {
    s.skins = {skin_of_texture(w, *in.texture, 0)};
    return;
  }
  if (!in.mesh && !in.material)
    throw NodeError("missing_texture", "link a texture, or the mesh or material that has one");
  const Mesh* mesh = in.mesh ? in.mesh->get() : nullptr;
  if (in.material)
    s.skins = {skin_of_material(w, **in.material)};
  else if (mesh->materials && !mesh->materials->materials.empty())
    dress_faces(w, *mesh, s);
  else
    s.skins = {white_skin(w)};
  if (in.points.frame().find("color.x"))
    s.color = {read_real(in.points, "color.x", s.precision), read_real(in.points, "color.y", s.precision),
               read_real(in.points, "color.z", s.precision)};
  if (in.points.frame().find("color.w")) s.color[3] = read_real(in.points, "color.w", s.precision);
}

bool is_white(const Skin& s) {
  if (s.alpha_cutoff > 1) return false;  // nothing is there
  return s.constant ? *s.constant == std::array<float, 4>{1, 1, 1, 1} : !s.texture;
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Wish wish = wish_of(in, p, ctx);
  State s{ctx.precision, {p.filter, p.max_anisotropy}, {}, {}, {}, -1};
  dress(wish, s);
  s.id = s.skin_of.empty() ? in.points.try_read("id").value_or(-1) : in.points.read("id");
  const PlaneKind kind = real_kind(ctx.precision);
  const Frame& from = in.points.frame();
  const bool white = !s.color[0] && s.skins.size() == 1 && is_white(s.skins[0]) && !wish.all_lookups;
  return {std::move(s),
          {Frame{.window = from.window,
                 .pattern = from.pattern,
                 .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
                 .color_space = std::string(linear_rec709),
                 .alpha = Alpha::premultiplied,
                 .white = white}}};
}

// ----- effects

std::uint64_t samples_of(const Inputs& in) {
  const Frame& f = in.points.frame();
  return static_cast<std::uint64_t>(f.window.area()) * static_cast<std::uint64_t>(f.samples());
}

// The textures that points may show, each with the name of what has it, and how it lies on the mesh.
struct Shown {
  std::string name;
  const Texture* texture;
  Skinning skin;
};

std::vector<Shown> textures_of(const Inputs& in) {
  if (in.texture) return {{"the texture", in.texture->get(), {}}};
  std::vector<Shown> all;
  const auto add = [&](const Material& m, std::optional<std::uint32_t> of) {
    if (m.texture)
      all.push_back({m.name.empty() ? "the texture of a material"
                                    : fmt::format("the texture of material \"{}\"", m.name),
                     m.texture.get(),
                     {m.uv_set, m.texture_from_uv, of}});
  };
  if (in.material)
    add(**in.material, {});
  else if (in.mesh && (*in.mesh)->materials)
    for (std::uint32_t m = 0; m < (*in.mesh)->materials->materials.size(); ++m)
      add((*in.mesh)->materials->materials[m], m);
  return all;
}

Verdict texture_lookup(const Inputs& in, const Params&, const Context&) {
  const std::uint64_t samples = samples_of(in);
  const auto textures = textures_of(in);
  for (const Shown& shown : textures)
    if (!constant_color(*shown.texture))
      return on(fmt::format("{} is not of one colour", shown.name), samples);
  if (textures.empty()) return off_exact("no material has a texture", samples);
  return off_exact("every texel of every level has the same colour", samples);
}

// Level 0 is all that is read where no pixel sees more than a texel: 0.98 leaves room for the level's own
// rounding.
Verdict mip_levels(const Inputs& in, const Params& p, const Context&) {
  constexpr double one_texel = 0.98;
  if (p.filter <= Lookup::bilinear) return off_user("the graph asks for a filter that reads level 0 only");
  const std::uint64_t samples = samples_of(in);
  bool pyramids = false, any = false;
  for (const Shown& shown : textures_of(in)) {
    const auto* pyramid = std::get_if<MipPyramid>(&shown.texture->source);
    if (pyramid == nullptr || constant_color(*shown.texture)) continue;
    pyramids = true;
    if (pyramid->levels.size() < 2) continue;
    any = true;
    const auto has = fmt::format("{} has {} levels", shown.name, pyramid->levels.size());
    if (!in.mesh) return on(has, samples);
    const auto face = first_minified_face(**in.mesh, *pyramid, shown.skin, one_texel);
    if (face)
      return on(fmt::format("{}, and a pixel of face {} may see more than one texel", has, *face), samples);
  }
  if (any) return off_exact("no pixel of the mesh sees more than one texel of level 0", samples);
  // Where there is no pyramid at all, nothing is done if it is forced.
  return off_exact("no texture that is looked up has a second level", pyramids ? samples : 0);
}

// Whether colours are other than opaque; what is behind is another node's to know.
Verdict transparency(const Inputs& in, const Params&, const Context&) {
  for (const Shown& shown : textures_of(in))
    if (may_be_clear(*shown.texture))
      return on(fmt::format("{} has an opacity of {:.3g}", shown.name, least_opacity(*shown.texture)));
  const Column* color = in.mesh && !in.texture ? (*in.mesh)->find("color") : nullptr;
  if (color != nullptr && color->width() == 4) {
    const Ref<Column> rgba = (*in.mesh)->real<double>("color");
    const auto rows = rgba->values<glm::dvec4>();
    const auto row = std::find_if(rows.begin(), rows.end(), [](const glm::dvec4& c) { return c.a < 1; });
    if (row != rows.end())
      return on(
          fmt::format("the vertex colour in row {} has an opacity of {:.3g}", row - rows.begin(), row->a));
  }
  return off_exact("every texel and every vertex colour is opaque");
}

// ----- tiles

template <class R>
class Sampler {
 public:
  Sampler(const State& s, const Tile& points, const Tile& out, Arena& arena)
      : s_(s), points_(points), out_(out), n_(static_cast<std::size_t>(out.rect().width())) {
    const auto take = [&] { return arena.take<R>(n_); };
    if constexpr (sizeof(R) == 8)
      for (auto& row : wide_) row = take();
    tests_ = std::any_of(s.skins.begin(), s.skins.end(), [](const Skin& k) { return k.alpha_cutoff > 0; });
    if (tests_) alpha_ = take();
    const bool moves =
        std::any_of(s.skins.begin(), s.skins.end(), [](const Skin& k) { return k.texture_from_uv; });
    for (std::size_t i = 0; i < moved_.size() && moves; ++i) moved_[i] = take();
    if (s.skin_of.empty()) return;
    for (auto& row : apart_) row = take();
    tag_ = arena.take<std::uint32_t>(n_), masked_ = arena.take<std::uint32_t>(n_);
    present_.resize(s.skins.size());
  }

  void fill() {
    for (int k = 0; k < out_.samples(); ++k)
      for (int y = out_.rect().y0; y < out_.rect().y1; ++y) fill_row(k, y);
  }

 private:
  void fill_row(int sample, int y) {
    const auto* id = s_.id < 0 ? nullptr : points_.row<const std::uint32_t>(s_.id, sample, y);
    kernels::RgbaRows<R> to;
    for (std::size_t c = 0; c < 4; ++c) to.plane[c] = out_row<R>(out_, static_cast<int>(c), sample, y);
    if (id != nullptr && !kernels::any_seen(id, n_)) {
      for (R* plane : to.plane)
        if (plane != nullptr) std::fill_n(plane, n_, R(0));
      return;
    }
    if (tests_ && to.plane[3] == nullptr) to.plane[3] = alpha_.data();
    if (s_.skin_of.empty())
      look_up(s_.skins[0], sample, y, id, to);
    else
      look_up_each(sample, y, id, to);
    for (std::size_t c = 0; c < 3 && s_.color[0]; ++c) scale(to.plane[c], s_.color[c], sample, y);
    for (std::size_t c = 0; c < 4 && s_.color[3]; ++c) scale(to.plane[c], s_.color[3], sample, y);
    if (tests_) test_opacity(id, to);
  }

  void scale(R* row, RealPlane by, int sample, int y) {
    if (row == nullptr) return;
    const R* factor = real_row<R>(points_, by, sample, y, wide_[0]);
    for (std::size_t x = 0; x < n_; ++x) row[x] = row[x] * factor[x];
  }

  // glTF 2.0, 3.9.4: at least the cutoff is opaque, the rest is not there. Colours become those of the straight ones.
  void test_opacity(const std::uint32_t* id, const kernels::RgbaRows<R>& to) const {
    for (std::size_t x = 0; x < n_; ++x) {
      const std::size_t face = s_.skin_of.empty() ? 0 : id[x];
      if (!s_.skin_of.empty() && face >= s_.skin_of.size()) continue;
      const R cutoff = static_cast<R>(s_.skins[s_.skin_of.empty() ? 0 : s_.skin_of[face]].alpha_cutoff);
      if (!(cutoff > 0)) continue;
      const R alpha = to.plane[3][x];
      const bool there = alpha >= cutoff;
      for (std::size_t c = 0; c < 3; ++c)
        if (to.plane[c] != nullptr) to.plane[c][x] = there ? to.plane[c][x] / alpha : R(0);
      to.plane[3][x] = there ? R(1) : R(0);
    }
  }

  // Every skin that the row shows, merged. A row that shows one skin, as most do, is written at once.
  void look_up_each(int sample, int y, const std::uint32_t* id, const kernels::RgbaRows<R>& to) {
    std::fill(present_.begin(), present_.end(), std::uint8_t{0});
    const std::size_t faces = s_.skin_of.size();
    std::size_t shown = 0;
    std::uint32_t only = 0;
    for (std::size_t x = 0; x < n_; ++x) {
      tag_[x] = id[x] < faces ? s_.skin_of[id[x]] : kernels::no_point;
      if (tag_[x] == kernels::no_point || present_[tag_[x]] != 0) continue;
      present_[tag_[x]] = 1, only = tag_[x], ++shown;
    }
    if (shown <= 1) return look_up(s_.skins[only], sample, y, tag_.data(), to);
    for (R* plane : to.plane)
      if (plane != nullptr) std::fill_n(plane, n_, R(0));
    kernels::RgbaRows<R> apart;
    for (std::size_t c = 0; c < 4; ++c) apart.plane[c] = to.plane[c] == nullptr ? nullptr : apart_[c].data();
    for (std::uint32_t skin = 0; skin < present_.size(); ++skin) {
      if (present_[skin] == 0) continue;
      for (std::size_t x = 0; x < n_; ++x) masked_[x] = tag_[x] == skin ? skin : kernels::no_point;
      look_up(s_.skins[skin], sample, y, masked_.data(), apart);
      for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t x = 0; x < n_ && to.plane[c] != nullptr; ++x)
          to.plane[c][x] = tag_[x] == skin ? apart.plane[c][x] : to.plane[c][x];
    }
  }

  void look_up(const Skin& skin, int sample, int y, const std::uint32_t* id, const kernels::RgbaRows<R>& to) {
    if (skin.constant || !skin.texture) {
      for (std::size_t c = 0; c < 4; ++c)
        if (to.plane[c] != nullptr)
          fill_constant(skin.constant ? static_cast<R>((*skin.constant)[c]) : R(1), id, to.plane[c]);
      return;
    }
    std::array<const R*, 6> row{};
    for (std::size_t i = 0; i < 6; ++i) row[i] = real_row<R>(points_, skin.uv[i], sample, y, wide_[i]);
    if (skin.texture_from_uv) move(*skin.texture_from_uv, row);
    const kernels::UvRows<R> uv{row[0], row[1], row[2], row[3], row[4], row[5], id};
    if (const auto* board = std::get_if<Checker>(&skin.texture->source))
      return look_up_row<R>(checker_colors<R>(*board), s_.filter, uv, n_, to);
    kernels::Filtering filter = s_.filter;
    if (row[2] == nullptr && filter.kind == Lookup::trilinear) filter.kind = Lookup::bilinear;
    const auto& pyramid = std::get<MipPyramid>(skin.texture->source);
    look_up_row<R>(kernels::TexelPyramid{skin.levels, edge_rule(pyramid.wrap_u), edge_rule(pyramid.wrap_v)},
                   filter, uv, n_, to);
  }

  void fill_constant(R value, const std::uint32_t* id, R* to) const {
    for (std::size_t x = 0; x < n_; ++x) to[x] = id == nullptr || id[x] != kernels::no_point ? value : R(0);
  }

  // (u, v) goes through the whole map, its derivatives through the linear part.
  void move(const glm::dmat3& m, std::array<const R*, 6>& row) {
    for (std::size_t i = 0; i < 6 && row[i] != nullptr; i += 2) {
      const R *u = row[i], *v = row[i + 1];
      for (std::size_t k = 0; k < 2; ++k) {
        const auto r = static_cast<glm::length_t>(k);
        const R a = static_cast<R>(m[0][r]), b = static_cast<R>(m[1][r]),
                c = i == 0 ? static_cast<R>(m[2][r]) : R(0);
        for (std::size_t x = 0; x < n_; ++x) moved_[i + k][x] = a * u[x] + b * v[x] + c;
        row[i + k] = moved_[i + k].data();
      }
    }
  }

  const State& s_;
  const Tile &points_, &out_;
  std::size_t n_;
  std::array<std::span<R>, 6> wide_, moved_;
  std::array<std::span<R>, 4> apart_;
  std::span<std::uint32_t> tag_, masked_;
  std::vector<std::uint8_t> present_;
  bool tests_ = false;  // some skin has a cutoff
  std::span<R> alpha_;  // where nobody reads the plane
};

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& image = out[&Outputs::image];
  const Tile points = in[&Inputs::points].part(image.rect());
  if (s.precision == Precision::single)
    Sampler<float>(s, points, image, arena).fill();
  else
    Sampler<double>(s, points, image, arena).fill();
}

Rect seen_without_ids(const State& s, Rect rect) { return s.id < 0 ? rect : Rect{}; }  // all, even at (0, 0)

}  // namespace

NodeType nodes::texture_sample() {
  return pixel_node("texture.sample", prepare, tile)
      .doc(
          "Looks textures up at the (u, v) of visible points and scales them by vertex colours; a NaN u or v "
          "is 0.")
      .cite("Williams 1983, Pyramidal parametrics, doi:10.1145/800059.801126")
      .cite("Mitchell & Netravali 1988 (cubics); Greene & Heckbert 1986; Heckbert 1989 (ewa)")
      .covers(30, 33)
      .input("points", &Inputs::points,
             "Visible points with the planes of their texture coordinates; transparent black where none is.")
      .input("texture", &Inputs::texture,
             "One texture for everything, by uv, instead of the materials' own and the vertex colours.")
      .input("mesh", &Inputs::mesh,
             "The mesh the points were seen on: each face takes its material's texture, white where it has "
             "none.")
      .input("material", &Inputs::material, "One material for everything, instead of the mesh's own.")
      .param(
          "filter", &Params::filter,
          "What stands for a pixel: a texel, four, two levels of four (or of 16, the cubics), or an ellipse.")
      .knob({"nearest", "bilinear", "trilinear", "ewa"},
            "nearest and bilinear alias where the texture is minified; trilinear blurs at a slant, ewa does "
            "not.")
      .param(
          "max_anisotropy", &Params::max_anisotropy,
          "Of ewa: how slender an ellipse may be; raising it keeps more at a slant, and reads more texels.",
          {.range = between(1, 64)})
      .knob({"1", "2", "4", "8", "16", "32"},
            "A plane seen at a slant of 1 to k blurs k / max_anisotropy-fold beyond it.")
      .effect(lookup_name, texture_lookup, "Textures are read at the (u, v) of every point.",
              {"sample", 20})  // tests/bench/effects_bench.cpp, one thread: 8 to 30
      .effect(levels_name, mip_levels,
              "A level of the pyramid is chosen by the footprint of every point, and two blended.",
              {"sample", 3.5})
      .effect("transparency", transparency, "Colours carry the opacity of textures and vertices.")
      .output("image", &Outputs::image, "Colour at every sample, linear Rec.709, premultiplied.")
      .seen(seen_without_ids)
      .blank_where(&Inputs::points);
}

}  // namespace frustum
