// The pixel nodes that find which face is seen at each sample, in whatever way: what they hold, prepare and fill.
//
//   using State = FaceFinders<Scanner<float>, Scanner<double>>;
//   prepare:  return prepare_finder<State, Outputs>(in, ctx, [&]<class R>(const FinderScene<R>& s) { return ...; });
//   tile:     fill_faces(state, out, arena);
// with Inputs of `mesh` and an optional `pattern`, Outputs of `visibility` and `depth`, and finders that have
//   void fill(kernels::PixelRect, kernels::PlaneView<std::uint32_t> id, kernels::PlaneView<R> z) const;
#pragma once

#include "runtime/buffers/pattern.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/core/node_type.h"

#include <functional>
#include <optional>
#include <variant>

namespace frustum {

// What a finder is made from.
template <class R>
struct FinderScene {
  kernels::ScreenMesh<R> mesh;
  kernels::SamplePositions pattern;
  kernels::PixelRect window;
  kernels::DepthOrder order;
  std::function<void(std::uint64_t bytes)> claim;  // told of memory before it is taken
};

// A finder and what it looks at.
template <class R, class Finder>
struct FaceFinder {
  ScreenView<R> view;
  Ref<SamplePattern> pattern;
  Finder finder;
};

// The state of such a node: its finder in either precision.
template <class Single, class Double>
using FaceFinders = std::variant<FaceFinder<float, Single>, FaceFinder<double, Double>>;

// Calls make.operator()<R>(scene), which gives the finder, for the precision of the run.
template <class Finders, class Outputs, class Inputs, class Make>
Prepared<Finders, Outputs> prepare_finder(const Inputs& in, Context& ctx, const Make& make) {
  const Rect window = picture_window(*in.mesh);
  return ctx.real([&]<class R>() -> Prepared<Finders, Outputs> {
    ScreenView<R> view(in.mesh);
    Ref<SamplePattern> pattern = in.pattern.value_or(nullptr);
    auto finder = make.template operator()<R>(
        FinderScene<R>{view.triangles(), sample_positions(pattern.get()), pixel_rect(window),
                       depth_order(*in.mesh), [&ctx](std::uint64_t bytes) { ctx.claim(bytes); }});
    Frame visibility = visibility_frame<R>(window, pattern), depth = depth_frame<R>(window, pattern);
    return {FaceFinder<R, decltype(finder)>{std::move(view), std::move(pattern), std::move(finder)},
            {std::move(visibility), std::move(depth)}};
  });
}

// For finders with bins: the part of `rect` that some face may be seen in.
template <class Finders>
Rect seen_faces(const Finders& finders, Rect rect) {
  return std::visit([&](const auto& f) { return seen_part(f.finder.bins(), rect); }, finders);
}

template <class Finders, class Outputs>
void fill_faces(const Finders& finders, const TilesOf<Outputs>& out, Arena& arena) {
  std::visit(
      [&]<class R, class Finder>(const FaceFinder<R, Finder>& f) {
        fill_visibility<R>(out[&Outputs::visibility], out[&Outputs::depth], arena,
                           [&](kernels::PixelRect rect, kernels::PlaneView<std::uint32_t> id,
                               kernels::PlaneView<R> z) { f.finder.fill(rect, id, z); });
      },
      finders);
}

}  // namespace frustum
