#include "nodes/color/convert.h"

#include "nodes/color.h"
#include "runtime/buffers/image.h"
#include "runtime/core/node_type.h"
#include "runtime/io/color.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace frustum {
namespace {

struct Inputs {
  Tiled<Image> image;
};
struct Params {
  std::string to = "srgb";
  std::string from;
  FilePath config;
  ColorEngine engine = ColorEngine::exact;
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  ColorConversion conversion;
  std::array<int, 3> color = {};  // planes R, G, B; unused where nothing is converted
  std::optional<int> alpha = {};  // set where colours are divided by it
  bool simulated = true;
  bool converts(int plane) const {
    return simulated && std::find(color.begin(), color.end(), plane) != color.end();
  }
};

// Names of a configuration that is a file are looked up when it is read.
void check(const Params& p) {
  if (p.to.empty()) throw NodeError("unknown_color_space", "no colour space is named", at_param("to"));
  if (!p.config.empty()) return;
  const Ref<ColorConfig> config = ColorConfig::open(p.config);
  for (const auto& [param, name] : {std::pair{"to", &p.to}, std::pair{"from", &p.from}}) try {
      if (!name->empty()) config->resolve(*name);
    } catch (const NodeError& e) {
      throw NodeError(e.code, e.what(), at_param(param));
    }
}

PlaneKind kind_of(const Frame& f, int plane) { return f.planes[static_cast<std::size_t>(plane)].kind; }

std::string space_of(const Inputs& in, const Params& p) {
  if (!p.from.empty()) return p.from;
  const std::string& own = in.image.frame().color_space;
  return own.empty() ? std::string(linear_rec709) : own;
}

Verdict conversion(const Inputs& in, const Params& p, const Context&) {
  const Ref<ColorConfig> config = ColorConfig::open(p.config);
  const std::string from = space_of(in, p);
  const Frame& frame = in.image.frame();
  const auto samples =
      static_cast<std::uint64_t>(frame.window.area()) * static_cast<std::uint64_t>(frame.samples());
  if (config->conversion(from, p.to, p.engine).identity())
    return off_exact(fmt::format("{} and {} are one colour space", from, p.to), samples);
  return on(fmt::format("the image is {}, {} is asked for", from, p.to), samples);
}

// An identity that is forced changes no bit: it is applied without dividing by alpha and back. Images without
// the planes of a colour have nothing to force it on.
Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Ref<ColorConfig> config = ColorConfig::open(p.config);
  Frame frame = in.image.frame();
  State state{.conversion = config->conversion(space_of(in, p), p.to, p.engine)};
  const bool has_color = frame.find("R") && frame.find("G") && frame.find("B");
  state.simulated = ctx.simulates("color_conversion") && (!state.conversion.identity() || has_color);
  if (state.simulated) {
    state.color = {in.image.read("R"), in.image.read("G"), in.image.read("B")};
    if (frame.alpha == Alpha::premultiplied && !state.conversion.linear() && !state.conversion.identity())
      state.alpha = in.image.try_read("A");
    const PlaneKind kind = kind_of(frame, state.color[0]);
    for (const int plane :
         {state.color[0], state.color[1], state.color[2], state.alpha.value_or(state.color[0])})
      if (kind == PlaneKind::u32 || kind_of(frame, plane) != kind)
        throw NodeError("wrong_plane_kind", "R, G, B and A must be real numbers of one precision");
  }
  in.image.read_all();
  frame.color_space = config->resolve(p.to);
  return {std::move(state), {Tiled<Image>(std::move(frame))}};
}

template <class T>
void pass_plane(const Tile& in, const Tile& out, int plane) {
  const Rect& r = out.rect();
  for (int s = 0; s < out.samples(); ++s)
    for (int y = r.y0; y < r.y1; ++y)
      std::copy_n(in.row<const T>(plane, s, y), r.width(), out.row<T>(plane, s, y));
}

// Converts batches of whole rows, so that a call of the library has some thousand pixels however narrow the
// tile is.
template <class R>
void convert_tile(const State& state, const Tile& in, const Tile& out, Arena& arena) {
  const Rect& r = out.rect();
  const int rows = std::clamp(1024 / r.width(), 1, r.height());
  const auto width = static_cast<std::size_t>(r.width());
  std::array<std::span<R>, 4> scratch;
  for (auto& s : scratch) s = arena.take<R>(width * static_cast<std::size_t>(rows));
  const auto gather = [&](int plane, int sample, int y0, int y1, R* to) {
    for (int y = y0; y < y1; ++y, to += width) std::copy_n(in.row<const R>(plane, sample, y), width, to);
  };
  for (int sample = 0; sample < out.samples(); ++sample)
    for (int y0 = r.y0; y0 < r.y1; y0 += rows) {
      const int y1 = std::min(y0 + rows, r.y1);
      const std::size_t n = width * static_cast<std::size_t>(y1 - y0);
      R* const alpha = scratch[3].data();
      if (state.alpha) gather(*state.alpha, sample, y0, y1, alpha);
      for (std::size_t c = 0; c < 3; ++c) {
        gather(state.color[c], sample, y0, y1, scratch[c].data());
        if (state.alpha) divide_by_alpha(alpha, scratch[c].data(), n);
      }
      state.conversion.apply(scratch[0].data(), scratch[1].data(), scratch[2].data(), n);
      for (std::size_t c = 0; c < 3; ++c) {
        if (!out.has(state.color[c])) continue;
        const R* from = scratch[c].data();
        if (state.alpha) multiply_by_alpha(alpha, scratch[c].data(), n);
        for (int y = y0; y < y1; ++y, from += width)
          std::copy_n(from, width, out.row<R>(state.color[c], sample, y));
      }
    }
}

void tile(const State& state, const TilesOf<Inputs>& inputs, const TilesOf<Outputs>& outputs, Arena& arena) {
  const Tile out = outputs[&Outputs::image], in = inputs[&Inputs::image].part(out.rect());
  bool wanted = false;
  for (int p = 0; p < static_cast<int>(out.frame().planes.size()); ++p) {
    if (!out.has(p)) continue;
    if (state.converts(p)) {
      wanted = true;
      continue;
    }
    switch (kind_of(out.frame(), p)) {
      case PlaneKind::f32: pass_plane<float>(in, out, p); break;
      case PlaneKind::f64: pass_plane<double>(in, out, p); break;
      case PlaneKind::u32: pass_plane<std::uint32_t>(in, out, p); break;
    }
  }
  if (!wanted) return;
  if (kind_of(out.frame(), state.color[0]) == PlaneKind::f64)
    convert_tile<double>(state, in, out, arena);
  else
    convert_tile<float>(state, in, out, arena);
}

}  // namespace

NodeType nodes::color_convert() {
  NodeType type =
      pixel_node("color.convert", prepare, tile)
          .doc("Converts colours from one colour space to another.")
          .cite(
              "IEC 61966-2-1:1999; ITU-R BT.709-6, BT.2020-2; Adobe RGB (1998); SMPTE ST 2065-1; OpenColorIO "
              "2")
          .covers(105)
          .foreign()
          .input("image", &Inputs::image,
                 "Planes R, G and B, divided by A where that needs it; other planes pass.")
          .param("to", &Params::to,
                 "Colour space of the result: srgb, display_p3, rec2020, acescg ... or one of the "
                 "configuration.")
          .param("from", &Params::from,
                 "Colour space of the input; empty: the image's own, and lin_rec709 where it has none.")
          .param("config", &Params::config,
                 "OpenColorIO configuration; empty: the file that $OCIO names, else the embedded one.")
          .param("engine", &Params::engine,
                 "Who converts between embedded spaces: frustum's exact curves, or OpenColorIO.")
          .knob({"ocio", "exact"},
                "OpenColorIO's optimised curves are off by up to 7.6e-7, in the toe relatively 2.5e-4.")
          .check(check)
          .effect("color_conversion", conversion, "Every colour is converted.",
                  {"pixel",
                   4})  // tests/bench/effects_bench.cpp, one thread, an identity that is forced: 4.1 to 4.5
          .output("image", &Outputs::image,
                  "The same window, samples and planes, in the colour space asked for.");
  depend_on_color_environment(type);
  return type;
}

}  // namespace frustum
