#include "nodes/texture/sample.h"

#include "nodes/texture.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/buffers/texture.h"
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
};
struct Outputs {
  Tiled<Image> image;
};

// What is looked up for some faces: no texture is white.
struct Skin {
  Ref<Texture> texture;
  std::vector<kernels::TexelLevel> levels;  // of a pyramid
  std::array<RealPlane, 6> uv{};            // u v du_dx dv_dx du_dy dv_dy
  std::optional<glm::dmat3> texture_from_uv;
};

struct State {
  Precision precision;
  Lookup filter;
  std::vector<Skin> skins;             // at least one
  std::vector<std::uint32_t> skin_of;  // by face; empty: all have the first
  std::array<RealPlane, 3> color{};    // of the vertices
  int id = -1;
};

static_assert(static_cast<int>(Wrap::repeat) == static_cast<int>(kernels::EdgeRule::repeat) &&
              static_cast<int>(Wrap::clamp) == static_cast<int>(kernels::EdgeRule::clamp) &&
              static_cast<int>(Wrap::mirror) == static_cast<int>(kernels::EdgeRule::mirror));
constexpr kernels::EdgeRule edge_rule(Wrap w) { return static_cast<kernels::EdgeRule>(w); }

// ----- preparation

std::vector<kernels::TexelLevel> texel_levels(const Texture& texture) {
  std::vector<kernels::TexelLevel> levels;
  const auto* pyramid = std::get_if<MipPyramid>(&texture.source);
  if (pyramid == nullptr) return levels;
  if (pyramid->levels.empty() || pyramid->levels.size() > 32)
    throw NodeError("empty_texture", "the texture has no level or too many", at_input("texture"));
  for (const MipPyramid::Level& l : pyramid->levels) {
    if (l.width < 1 || l.height < 1)
      throw NodeError("empty_texture", "the texture has no texels", at_input("texture"));
    levels.push_back({l.width, l.height, l.rgba.data()});
  }
  return levels;
}

Skin skin_of_texture(const Inputs& in, Ref<Texture> texture, std::uint32_t uv_set, Lookup filter,
                     Precision precision) {
  Skin s{.texture = texture, .levels = texel_levels(*texture), .uv = {}, .texture_from_uv = {}};
  const std::string uv = uv_column_name(uv_set);
  const bool board = std::holds_alternative<Checker>(texture->source);
  const bool slopes = filter == Lookup::trilinear || (board && filter == Lookup::bilinear);
  constexpr std::array names{".u", ".v", ".du_dx", ".dv_dx", ".du_dy", ".dv_dy"};
  for (std::size_t i = 0; i < (slopes ? 6u : 2u); ++i)
    s.uv[i] = read_real(in.points, uv + names[i], precision);
  return s;
}

Skin skin_of_material(const Inputs& in, const Material& m, Lookup filter, Precision precision) {
  if (!m.texture) return {};
  if (!in.points.frame().find(uv_column_name(m.uv_set) + ".u"))
    throw NodeError("missing_uv",
                    fmt::format("material \"{}\" has a texture, but the mesh has no texture coordinates "
                                "for it: column {}",
                                m.name, uv_column_name(m.uv_set)),
                    at_input("points"));
  Skin s = skin_of_texture(in, m.texture, m.uv_set, filter, precision);
  if (m.texture_from_uv != glm::dmat3(1)) s.texture_from_uv = m.texture_from_uv;
  return s;
}

// The skins of the materials that faces have, and which each face takes.
void dress_faces(const Inputs& in, const Mesh& mesh, State& s) {
  const auto& materials = mesh.materials->materials;
  const Column* column = mesh.find("material");
  if (column == nullptr) {
    s.skins = {skin_of_material(in, materials[0], s.filter, s.precision)};
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
    s.skins.push_back(skin_of_material(in, materials[m], s.filter, s.precision));
  }
  if (s.skins.empty()) s.skins.emplace_back();
  if (s.skins.size() == 1) return;
  s.skin_of.resize(of.size());
  for (std::size_t f = 0; f < of.size(); ++f) s.skin_of[f] = skin[of[f]];
}

void dress(const Inputs& in, State& s) {
  if (in.texture) {
    s.skins = {skin_of_texture(in, *in.texture, 0, s.filter, s.precision)};
    return;
  }
  if (!in.mesh && !in.material)
    throw NodeError("missing_texture", "link a texture, or the mesh or material that has one");
  const Mesh* mesh = in.mesh ? in.mesh->get() : nullptr;
  if (in.material)
    s.skins = {skin_of_material(in, **in.material, s.filter, s.precision)};
  else if (mesh->materials && !mesh->materials->materials.empty())
    dress_faces(in, *mesh, s);
  else
    s.skins = {Skin{}};
  if (in.points.frame().find("color.x"))
    s.color = {read_real(in.points, "color.x", s.precision), read_real(in.points, "color.y", s.precision),
               read_real(in.points, "color.z", s.precision)};
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  State s{ctx.precision, p.filter, {}, {}, {}, -1};
  dress(in, s);
  s.id = s.skin_of.empty() ? in.points.try_read("id").value_or(-1) : in.points.read("id");
  const PlaneKind kind = real_kind(ctx.precision);
  const Frame& from = in.points.frame();
  const bool white = s.skins.size() == 1 && !s.skins[0].texture && !s.color[0];
  return {std::move(s),
          {Frame{.window = from.window,
                 .pattern = from.pattern,
                 .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
                 .color_space = std::string(linear_rec709),
                 .alpha = Alpha::premultiplied,
                 .white = white}}};
}

// ----- tiles

template <class R>
kernels::CheckerColors<R> checker_colors(const Checker& c) {
  const auto narrow = [](const glm::dvec3& v) {
    return std::array{static_cast<R>(v.r), static_cast<R>(v.g), static_cast<R>(v.b)};
  };
  return {static_cast<R>(c.scale), narrow(c.even), narrow(c.odd)};
}

template <class R>
class Sampler {
 public:
  Sampler(const State& s, const Tile& points, const Tile& out, Arena& arena)
      : s_(s), points_(points), out_(out), n_(static_cast<std::size_t>(out.rect().width())) {
    const auto take = [&] { return arena.take<R>(n_); };
    if constexpr (sizeof(R) == 8)
      for (auto& row : wide_) row = take();
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
    if (s_.skin_of.empty())
      look_up(s_.skins[0], sample, y, id, to);
    else
      look_up_each(sample, y, id, to);
    for (std::size_t c = 0; c < 3 && s_.color[0]; ++c) {
      if (to.plane[c] == nullptr) continue;
      const R* color = real_row<R>(points_, s_.color[c], sample, y, wide_[0]);
      for (std::size_t x = 0; x < n_; ++x) to.plane[c][x] = to.plane[c][x] * color[x];
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
    if (!skin.texture) {
      for (R* plane : to.plane)
        for (std::size_t x = 0; x < n_ && plane != nullptr; ++x)
          plane[x] = id == nullptr || id[x] != kernels::no_point ? R(1) : R(0);
      return;
    }
    std::array<const R*, 6> row{};
    for (std::size_t i = 0; i < 6; ++i) row[i] = real_row<R>(points_, skin.uv[i], sample, y, wide_[i]);
    if (skin.texture_from_uv) move(*skin.texture_from_uv, row);
    const kernels::UvRows<R> uv{row[0], row[1], row[2], row[3], row[4], row[5], id};
    if (const auto* board = std::get_if<Checker>(&skin.texture->source))
      return look_up_row<R>(checker_colors<R>(*board), s_.filter, uv, n_, to);
    const auto& pyramid = std::get<MipPyramid>(skin.texture->source);
    look_up_row<R>(kernels::TexelPyramid{skin.levels, edge_rule(pyramid.wrap_u), edge_rule(pyramid.wrap_v)},
                   s_.filter, uv, n_, to);
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
};

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& image = out[&Outputs::image];
  const Tile points = in[&Inputs::points].part(image.rect());
  if (s.precision == Precision::single)
    Sampler<float>(s, points, image, arena).fill();
  else
    Sampler<double>(s, points, image, arena).fill();
}

}  // namespace

NodeType nodes::texture_sample() {
  return pixel_node("texture.sample", prepare, tile)
      .doc(
          "Looks textures up at the (u, v) of visible points and scales them by vertex colours; a NaN u or v "
          "is 0.")
      .cite("Williams 1983, Pyramidal parametrics, doi:10.1145/800059.801126")
      .covers(30, 33)
      .input("points", &Inputs::points,
             "Visible points with the planes of their texture coordinates; transparent black where none is.")
      .input("texture", &Inputs::texture,
             "One texture for everything, by uv, instead of the materials' own and the vertex colours.")
      .input("mesh", &Inputs::mesh,
             "The mesh the points were seen on: each face takes its material's texture, white where it has "
             "none.")
      .input("material", &Inputs::material, "One material for everything, instead of the mesh's own.")
      .param("filter", &Params::filter,
             "What stands for a pixel: one texel, four of level 0, or two levels by footprint.")
      .knob({"nearest", "bilinear", "trilinear"},
            "nearest and bilinear alias where the texture is minified; trilinear reads eight texels and "
            "blurs a little.")
      .output("image", &Outputs::image, "Colour at every sample, linear Rec.709, premultiplied.");
}

}  // namespace frustum
