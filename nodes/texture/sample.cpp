#include "nodes/texture/sample.h"

#include "nodes/texture.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/buffers/texture.h"
#include "runtime/core/node_type.h"

namespace frustum {

using kernels::Lookup;

namespace {

struct Inputs {
  Tiled<Image> points;
  Ref<Texture> texture;
};
struct Params {
  Lookup filter = Lookup::trilinear;
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  Precision precision;
  Lookup filter;
  Ref<Texture> texture;
  std::vector<kernels::TexelLevel> levels;  // of a pyramid
  RealPlane u, v, du_dx, dv_dx, du_dy, dv_dy;
  int id = -1;
};

static_assert(static_cast<int>(Wrap::repeat) == static_cast<int>(kernels::EdgeRule::repeat) &&
              static_cast<int>(Wrap::clamp) == static_cast<int>(kernels::EdgeRule::clamp) &&
              static_cast<int>(Wrap::mirror) == static_cast<int>(kernels::EdgeRule::mirror));
constexpr kernels::EdgeRule edge_rule(Wrap w) { return static_cast<kernels::EdgeRule>(w); }

std::vector<kernels::TexelLevel> texel_levels(const Texture& texture) {
  std::vector<kernels::TexelLevel> levels;
  const auto* pyramid = std::get_if<MipPyramid>(&texture.source);
  if (pyramid == nullptr) return levels;
  if (pyramid->levels.empty() || pyramid->levels.size() > 32)
    throw NodeError("empty_texture", "the texture has no level or too many");
  for (const MipPyramid::Level& l : pyramid->levels) {
    if (l.width < 1 || l.height < 1) throw NodeError("empty_texture", "the texture has no texels");
    levels.push_back({l.width, l.height, l.rgba.data()});
  }
  return levels;
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  State s{ctx.precision, p.filter, in.texture, texel_levels(*in.texture), {}, {}, {}, {}, {}, {}};
  s.u = read_real(in.points, "uv.u", ctx.precision), s.v = read_real(in.points, "uv.v", ctx.precision);
  const bool board = std::holds_alternative<Checker>(in.texture->source);
  if (p.filter == Lookup::trilinear || (board && p.filter == Lookup::bilinear)) {
    s.du_dx = read_real(in.points, "uv.du_dx", ctx.precision),
    s.dv_dx = read_real(in.points, "uv.dv_dx", ctx.precision);
    s.du_dy = read_real(in.points, "uv.du_dy", ctx.precision),
    s.dv_dy = read_real(in.points, "uv.dv_dy", ctx.precision);
  }
  s.id = in.points.try_read("id").value_or(-1);
  const PlaneKind kind = real_kind(ctx.precision);
  const Frame& from = in.points.frame();
  return {std::move(s),
          {Frame{.window = from.window,
                 .pattern = from.pattern,
                 .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
                 .color_space = std::string(linear_rec709),
                 .alpha = Alpha::premultiplied}}};
}

template <class R>
kernels::CheckerColors<R> checker_colors(const Checker& c) {
  const auto narrow = [](const glm::dvec3& v) {
    return std::array{static_cast<R>(v.r), static_cast<R>(v.g), static_cast<R>(v.b)};
  };
  return {static_cast<R>(c.scale), narrow(c.even), narrow(c.odd)};
}

template <class R>
void fill(const State& s, const Tile& points, const Tile& out, Arena& arena) {
  const auto n = static_cast<std::size_t>(out.rect().width());
  std::array<std::span<R>, 6> scratch;
  if constexpr (sizeof(R) == 8)
    for (auto& row : scratch) row = arena.take<R>(n);

  const auto each_row = [&](const auto& source) {
    for (int k = 0; k < out.samples(); ++k)
      for (int y = out.rect().y0; y < out.rect().y1; ++y) {
        const auto row = [&](RealPlane plane, std::size_t i) {
          return real_row<R>(points, plane, k, y, scratch[i]);
        };
        const kernels::UvRows<R> in{row(s.u, 0),
                                    row(s.v, 1),
                                    row(s.du_dx, 2),
                                    row(s.dv_dx, 3),
                                    row(s.du_dy, 4),
                                    row(s.dv_dy, 5),
                                    s.id < 0 ? nullptr : points.row<const std::uint32_t>(s.id, k, y)};
        look_up_row<R>(source, s.filter, in, n,
                       {{out_row<R>(out, 0, k, y), out_row<R>(out, 1, k, y), out_row<R>(out, 2, k, y),
                         out_row<R>(out, 3, k, y)}});
      }
  };
  if (const auto* board = std::get_if<Checker>(&s.texture->source))
    return each_row(checker_colors<R>(*board));
  const auto& pyramid = std::get<MipPyramid>(s.texture->source);
  each_row(kernels::TexelPyramid{s.levels, edge_rule(pyramid.wrap_u), edge_rule(pyramid.wrap_v)});
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& image = out[&Outputs::image];
  const Tile points = in[&Inputs::points].part(image.rect());
  if (s.precision == Precision::single)
    fill<float>(s, points, image, arena);
  else
    fill<double>(s, points, image, arena);
}

}  // namespace

NodeType nodes::texture_sample() {
  return pixel_node("texture.sample", prepare, tile)
      .doc("Looks a texture up at the (u, v) of visible points; NaN and infinite coordinates count as 0.")
      .cite("Williams 1983, Pyramidal parametrics, doi:10.1145/800059.801126")
      .covers(30, 33)
      .input("points", &Inputs::points,
             "Visible points with planes uv.*; black and transparent where there is none.")
      .input("texture", &Inputs::texture, "A checkerboard or a pyramid of images.")
      .param("filter", &Params::filter,
             "What stands for a pixel: one texel, four of level 0, or two levels by footprint.")
      .output("image", &Outputs::image, "Colour at every sample, linear Rec.709, premultiplied.");
}

}  // namespace frustum
