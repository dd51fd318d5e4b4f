#include "nodes/color/mix.h"

#include "nodes/color.h"
#include "runtime/core/node_type.h"
#include "runtime/io/color_pixels.h"

namespace frustum {
namespace {

enum class Model { additive, subtractive };
constexpr auto choices(Model) {
  return std::array{std::pair{Model::additive, "additive"}, std::pair{Model::subtractive, "subtractive"}};
}

struct Inputs {
  Tiled<Image> image, with;
};
struct Params {
  Model model = Model::additive;
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  Precision precision;
  Model model;
  std::array<RealPlane, 4> a, b;
};

std::array<RealPlane, 4> planes_of(const Tiled<Image>& image, const char* port, Precision precision) {
  const Frame& frame = image.frame();
  if (frame.alpha == Alpha::straight)
    throw NodeError("straight_alpha", "the colours have to be premultiplied by A", at_input(port));
  std::array<RealPlane, 4> planes{};
  for (std::size_t c = 0; c < 3; ++c) planes[c] = read_real(image, std::array{"R", "G", "B"}[c], precision);
  if (frame.alpha == Alpha::premultiplied && frame.find("A")) planes[3] = read_real(image, "A", precision);
  return planes;
}

void require_alike(const Frame& a, const Frame& b) {
  const auto period = [](const Frame& f) { return f.pattern ? f.pattern->period : 1; };
  if (a.window != b.window || a.samples() != b.samples() || period(a) != period(b))
    throw NodeError(
        "frames_differ",
        fmt::format("the pictures are {} x {} with {} and {} x {} with {} samples a pixel", a.window.width(),
                    a.window.height(), a.samples(), b.window.width(), b.window.height(), b.samples()),
        at_input("with"));
  if (color_space_of(a) != color_space_of(b))
    throw NodeError("spaces_differ",
                    fmt::format("one picture is {}, the other {}: color.convert makes them one",
                                color_space_of(a), color_space_of(b)),
                    at_input("with"));
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame& from = in.image.frame();
  State s{ctx.precision, p.model, planes_of(in.image, "image", ctx.precision),
          planes_of(in.with, "with", ctx.precision)};
  require_alike(from, in.with.frame());
  const std::string space = color_space_of(from);
  if (const auto known = ColorConfig::embedded().find(space); known && linear_space_of(*known) != *known)
    ctx.warn("encoded_colors",
             fmt::format("light adds and ink multiplies in linear light; the pictures are {}", space));
  Frame to = from;
  to.planes.clear();
  for (const char* name : {"R", "G", "B", "A"}) to.planes.push_back({name, real_kind(ctx.precision)});
  to.color_space = space, to.alpha = Alpha::premultiplied;
  return {std::move(s), {std::move(to)}};
}

template <class R>
void fill(const State& s, const Tile& a, const Tile& b, const Tile& out, Arena& arena) {
  const auto n = static_cast<std::size_t>(out.rect().width());
  const auto ones = arena.take<R>(n);
  std::fill(ones.begin(), ones.end(), R(1));
  std::array<std::span<R>, 4> scratch;
  for (auto& row : scratch) row = arena.take<R>(n);
  for (int k = 0; k < out.samples(); ++k)
    for (int y = out.rect().y0; y < out.rect().y1; ++y) {
      const R* alpha_a = s.a[3] ? real_row<R>(a, s.a[3], k, y, scratch[0]) : ones.data();
      const R* alpha_b = s.b[3] ? real_row<R>(b, s.b[3], k, y, scratch[1]) : ones.data();
      for (std::size_t c = 0; c < 4; ++c) {
        R* const to = out_row<R>(out, static_cast<int>(c), k, y);
        if (to == nullptr) continue;
        const R* of_a = c == 3 ? alpha_a : real_row<R>(a, s.a[c], k, y, scratch[2]);
        const R* of_b = c == 3 ? alpha_b : real_row<R>(b, s.b[c], k, y, scratch[3]);
        const bool adds = s.model == Model::additive;
        for (std::size_t x = 0; x < n; ++x)
          if (c == 3)
            to[x] =
                adds ? color::added_coverage(of_a[x], of_b[x]) : color::filtered_coverage(of_a[x], of_b[x]);
          else
            to[x] = adds ? color::added(of_a[x], of_b[x])
                         : color::filtered(of_a[x], alpha_a[x], of_b[x], alpha_b[x]);
      }
    }
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& outputs, Arena& arena) {
  const Tile out = outputs[&Outputs::image];
  const Tile a = in[&Inputs::image].part(out.rect()), b = in[&Inputs::with].part(out.rect());
  if (s.precision == Precision::single)
    fill<float>(s, a, b, out, arena);
  else
    fill<double>(s, a, b, out, arena);
}

}  // namespace

NodeType nodes::color_mix() {
  return pixel_node("color.mix", prepare, tile)
      .doc(
          "Lays two pictures on one another as lamps, whose lights add, or as inks, whose shares of light "
          "multiply.")
      .cite(
          "Porter & Duff 1984, doi:10.1145/964965.808606; W3C Compositing and Blending Level 1, multiply; "
          "errata E57")
      .covers(104)
      .input("image", &Inputs::image, "R, G, B, premultiplied by A; without A it is opaque.")
      .input("with", &Inputs::with, "The other one, of the same size, samples and colour space.")
      .param("model", &Params::model,
             "additive: lamps on a screen; subtractive: inks, which paper keeps from white.")
      .output("image", &Outputs::image, "Both as one, premultiplied; additive colours may go above 1.");
}

}  // namespace frustum
