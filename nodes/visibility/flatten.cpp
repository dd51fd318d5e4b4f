#include "nodes/visibility/flatten.h"

#include "nodes/visibility.h"
#include "runtime/buffers/fragments.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

constexpr std::array<const char*, 4> channels{"R", "G", "B", "A"};

struct Inputs {
  Ref<Fragments> fragments;
};
struct Params {};
struct Outputs {
  Tiled<Image> image;
};

template <class R>
struct Lists {
  Ref<Fragments> fragments;
  std::array<Ref<Column>, 4> columns;
};
using State = std::variant<Lists<float>, Lists<double>>;

template <class R>
Lists<R> lists_of(const Ref<Fragments>& fragments) {
  Lists<R> lists{fragments, {}};
  bool any = false;
  for (const Ref<Column>& c : fragments->channels)
    for (std::size_t k = 0; k < 4; ++k) {
      if (c->name() != channels[k]) continue;
      if (c->kind() == NumberKind::u32)
        throw NodeError("wrong_plane", "channel " + c->name() + " holds integers", at_input("fragments"));
      lists.columns[k] = as_real<R>(c);
      any = any || k < 3;
    }
  if (!any)
    throw NodeError("missing_plane", "the fragments have no colours: no channel is named R, G or B",
                    at_input("fragments"));
  return lists;
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  const Fragments& f = *in.fragments;
  const PlaneKind kind = real_kind(ctx.precision);
  Frame to{.window = f.window,
           .pattern = f.pattern,
           .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
           .color_space = f.color_space,
           .alpha = Alpha::premultiplied};
  return ctx.real([&]<class R>() -> Prepared<State, Outputs> {
    return {lists_of<R>(in.fragments), {std::move(to)}};
  });
}

template <class R>
void fill(const Lists<R>& lists, const Tile& out) {
  flattening::Channels<R> from{};
  for (std::size_t c = 0; c < 4; ++c)
    if (lists.columns[c]) from[c] = lists.columns[c]->template values<R>().data();
  const Rect& r = out.rect();
  for (int sample = 0; sample < out.samples(); ++sample)
    for (int y = r.y0; y < r.y1; ++y) {
      std::array<R*, 4> to{};
      for (int c = 0; c < 4; ++c) to[static_cast<std::size_t>(c)] = out_row<R>(out, c, sample, y);
      for (int x = r.x0; x < r.x1; ++x) {
        const auto [begin, end] = lists.fragments->of_list(lists.fragments->list(sample, x, y));
        const auto sum = flattening::flatten(from, begin, end);
        for (std::size_t c = 0; c < 4; ++c)
          if (to[c] != nullptr) to[c][x - r.x0] = static_cast<R>(sum[c]);
      }
    }
}

void tile(const State& state, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena&) {
  std::visit([&](const auto& lists) { fill(lists, out[&Outputs::image]); }, state);
}

}  // namespace

NodeType nodes::visibility_flatten() {
  return pixel_node("visibility.flatten", prepare, tile)
      .doc("Makes a picture of lists of fragments: each over what lies behind it.")
      .cite("Porter & Duff 1984, Compositing digital images, doi:10.1145/964965.808606")
      .cite("Kainz 2013, Interpreting OpenEXR deep pixels (fragments that fill a range count at its front)")
      .covers(42)
      .input("fragments", &Inputs::fragments,
             "Lists from the front to the back with R, G, B, premultiplied by A.")
      .output("image", &Outputs::image, "One colour a list, premultiplied; without A, the first fragment's.");
}

}  // namespace frustum
