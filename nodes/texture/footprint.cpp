#include "nodes/texture/footprint.h"

#include "nodes/texture.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/buffers/texture.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  Tiled<Image> points;
  Ref<Texture> texture;
};
struct Params {
  double max_anisotropy = 16;
};
struct Outputs {
  Tiled<Image> footprint;
};

struct State {
  texture::TextureSize size;
  std::array<RealPlane, 6> uv;
  int id;
  Precision precision;
};

constexpr std::array uv_planes{"uv.u", "uv.v", "uv.du_dx", "uv.dv_dx", "uv.du_dy", "uv.dv_dy"};

// A checkerboard counts by its squares, and has no levels.
texture::TextureSize size_of(const Texture& t, double max_anisotropy) {
  if (const auto* pyramid = std::get_if<MipPyramid>(&t.source)) {
    if (pyramid->levels.empty())
      throw NodeError("empty_texture", "the texture has no level", at_input("texture"));
    return {pyramid->levels[0].width, pyramid->levels[0].height, static_cast<int>(pyramid->levels.size()) - 1,
            max_anisotropy};
  }
  throw NodeError("no_texels",
                  "a checkerboard has no texels: its filter has no footprint but the pixel's box",
                  at_input("texture"));
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  State s{size_of(*in.texture, p.max_anisotropy), {}, in.points.try_read("id").value_or(-1), ctx.precision};
  for (std::size_t i = 0; i < uv_planes.size(); ++i)
    s.uv[i] = read_real(in.points, uv_planes[i], ctx.precision);
  const Frame& from = in.points.frame();
  Frame frame{.window = from.window, .pattern = from.pattern, .planes = {}};
  for (const char* name : texture::footprint_planes) frame.planes.push_back({name, real_kind(ctx.precision)});
  return {s, {std::move(frame)}};
}

template <class R>
void fill(const State& s, const Tile& points, const Tile& out, Arena& arena) {
  const auto n = static_cast<std::size_t>(out.rect().width());
  std::array<std::span<R>, 6> wide;
  if constexpr (sizeof(R) == 8)
    for (auto& row : wide) row = arena.take<R>(n);
  for (int k = 0; k < out.samples(); ++k)
    for (int y = out.rect().y0; y < out.rect().y1; ++y) {
      std::array<const R*, 6> uv;
      for (std::size_t i = 0; i < 6; ++i) uv[i] = real_row<R>(points, s.uv[i], k, y, wide[i]);
      texture::FootprintRows<R> rows;
      for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = out_row<R>(out, static_cast<int>(i), k, y);
      const auto* id = s.id < 0 ? nullptr : points.row<const std::uint32_t>(s.id, k, y);
      texture::measure_footprints<R>(s.size, {uv[0], uv[1], uv[2], uv[3], uv[4], uv[5], id}, n, rows);
    }
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& to = out[&Outputs::footprint];
  const Tile points = in[&Inputs::points].part(to.rect());
  if (s.precision == Precision::single)
    fill<float>(s, points, to, arena);
  else
    fill<double>(s, points, to, arena);
}

}  // namespace

NodeType nodes::texture_footprint() {
  return pixel_node("texture.footprint", prepare, tile)
      .doc(
          "Measures what each pixel sees of a texture: the ellipse's axes, its area, and the level it asks "
          "for.")
      .cite("Heckbert 1989, Fundamentals of Texture Mapping and Image Warping, section 3.5")
      .covers(33)
      .input("points", &Inputs::points, "Visible points with uv and its derivatives; zeros where none is.")
      .input("texture", &Inputs::texture, "The texture of images whose texels are counted.")
      .param("max_anisotropy", &Params::max_anisotropy,
             "What texture.sample's is; raising it lowers ewa_level at a slant.", {.range = between(1, 64)})
      .output(
          "footprint", &Outputs::footprint,
          "major, minor, axis (texels a pixel), area |det J|, ratio, level of trilinear and of ewa lookup.");
}

}  // namespace frustum
