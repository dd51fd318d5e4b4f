#include "nodes/image/mix.h"

#include "nodes/image.h"
#include "runtime/buffers/rgba_planes.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Tiled<Image> image, other;
  std::optional<Tiled<Image>> share;
};
struct Params {
  double amount = 0.5;
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  std::array<RealPlane, 4> image{}, other{};
  RealPlane share{};
  double amount;
};

void require_alike(const Frame& a, const Frame& b, std::string_view input) {
  if (a.window != b.window || a.samples() != b.samples())
    throw NodeError("different_frames", fmt::format("image and {} have different windows or samples", input),
                    at_input(input));
}

void require_color(const Frame& of, const Frame& as, std::string_view input) {
  if (of.color_space == as.color_space && (of.alpha == as.alpha || !of.find("A") || !as.find("A"))) return;
  throw NodeError(
      "colors_differ",
      fmt::format("image and {} have colours of different spaces, or other states of alpha", input),
      at_input(input));
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame& from = in.image.frame();
  require_alike(from, in.other.frame(), "other");
  require_color(from, in.other.frame(), "other");
  State s{read_rgba(in.image, ctx.precision), read_rgba(in.other, ctx.precision), {}, p.amount};
  if (in.share) {
    require_alike(from, in.share->frame(), "share");
    s.share = read_real(*in.share, in.share->frame().planes.empty() ? "Y" : in.share->frame().planes[0].name,
                        ctx.precision);
  }
  Frame to = from;
  to.alpha = from.find("A") ? from.alpha : in.other.frame().alpha;
  to.planes.clear();
  const bool opaque = !from.find("A") && !in.other.frame().find("A");
  for (std::size_t k = 0; k < (opaque ? 3U : 4U); ++k)
    to.planes.push_back({rgba_names[k], real_kind(ctx.precision)});
  return {std::move(s), {std::move(to)}};
}

template <class R>
void fill(const State& s, const Tile& image, const Tile& other, const Tile& share, const Tile& out,
          Arena& arena) {
  const auto n = static_cast<std::size_t>(out.rect().width());
  const auto scratch = arena.take<R>(3 * n), ones = arena.take<R>(n);
  std::fill(ones.begin(), ones.end(), R(1));
  const auto row = [&](const Tile& tile, RealPlane plane, int k, int y, std::size_t part) -> const R* {
    return plane ? real_row<R>(tile, plane, k, y, scratch.subspan(part * n, n)) : ones.data();
  };
  for (int k = 0; k < out.samples(); ++k)
    for (int y = out.rect().y0; y < out.rect().y1; ++y) {
      const R* const of = s.share ? row(share, s.share, k, y, 2) : nullptr;
      for (std::size_t c = 0; c < out.frame().planes.size(); ++c)
        if (R* const to = out_row<R>(out, static_cast<int>(c), k, y))
          image::mix_row<R>(row(image, s.image[c], k, y, 0), row(other, s.other[c], k, y, 1), of,
                            static_cast<R>(s.amount), n, to);
    }
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& to = out[&Outputs::image];
  const Tile image = in[&Inputs::image].part(to.rect()), other = in[&Inputs::other].part(to.rect());
  const Tile& given = in[&Inputs::share];
  const Tile share = given.empty() ? given : given.part(to.rect());
  if (to.frame().planes[0].kind == PlaneKind::f32)
    fill<float>(s, image, other, share, to, arena);
  else
    fill<double>(s, image, other, share, to, arena);
}

}  // namespace

NodeType nodes::image_mix() {
  return pixel_node("image.mix", prepare, tile)
      .doc(
          "Goes from one picture towards another: by one amount everywhere, or by a share of its own in each "
          "sample.")
      .cite("Whitted 1980, An improved illumination model for shaded display, doi:10.1145/358876.358882")
      .input("image", &Inputs::image, "Where it starts: R, G, B and, where it is not opaque, A.")
      .input("other", &Inputs::other, "Where it goes, of the same size, samples and colour space.")
      .input("share", &Inputs::share,
             "How far each sample goes, 0 to 1: its first plane, such as trace.refract's reflectance.")
      .param("amount", &Params::amount,
             "How far all go, or what scales their shares: 0 is the image, 1 the other one.",
             {.range = between(0, 1)})
      .output("image", &Outputs::image, "image + share amount (other - image).");
}

}  // namespace frustum
