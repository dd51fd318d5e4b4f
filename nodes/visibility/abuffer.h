// The A-buffer: per sample the list of all faces there, from the nearest to the farthest, as layers of visibility.
#pragma once

#include "nodes/kernels/fragment_counts.h"
#include "nodes/kernels/parallel.h"
#include "nodes/kernels/simd/fragment_layers.h"

#include <functional>
#include <mutex>

namespace frustum {

// Keeps the spans it is given; their owner outlives it. Filling is const: many threads may fill at once.
template <std::floating_point R>
class LayerRasterizer {
 public:
  // `hides` by face, or empty; see kernels::FragmentScene.
  LayerRasterizer(const kernels::ScreenMesh<R>& mesh, const kernels::SamplePositions& pattern,
                  kernels::PixelRect window, kernels::DepthOrder order, std::span<const std::uint8_t> hides,
                  const std::function<void(std::uint64_t)>& claim = {})
      : bins_(kernels::bin_triangles(mesh, pattern, window, claim)),
        scene_{{mesh, pattern, nullptr, order}, hides} {}

  const kernels::TriangleBins& bins() const { return bins_; }
  int samples() const { return scene_.fill.pattern.samples; }

  // How many layers all fragments need, and how many fragments lie beyond the first `limit` of their sample. Costs
  // the coverage of every triangle, without its depth where none hides. The result does not depend on threads.
  //   poll  called once a bin, from any thread; may throw
  kernels::FragmentCounts count(std::uint32_t limit, const std::function<void()>& poll) const {
    const auto columns = static_cast<std::size_t>(bins_.columns),
               all = columns * static_cast<std::size_t>(bins_.rows);
    const auto scene = here();
    kernels::FragmentCounts sum;
    std::mutex mutex;
    kernels::parallel_blocks(all, 1, [&](std::size_t begin, std::size_t) {
      poll();
      const auto counts =
          count_bin(scene, static_cast<int>(begin % columns), static_cast<int>(begin / columns), limit);
      const std::scoped_lock lock(mutex);
      sum.most = std::max(sum.most, counts.most);
      sum.fragments += counts.fragments, sum.beyond += counts.beyond;
    });
    return sum;
  }

  // See kernels::fill_fragments; the same bytes for any rectangles.
  void fill(kernels::PixelRect rect, const kernels::FragmentLayers<R>& to,
            const kernels::FragmentScratch<R>& scratch) const {
    if constexpr (std::is_same_v<R, float>)
      kernels::simd::fill_fragments(here(), rect, to, scratch);
    else
      kernels::fill_fragments(here(), rect, to, scratch);
  }

 private:
  // Points to the bins where they are now: the rasterizer may have been moved.
  kernels::FragmentScene<R> here() const {
    auto scene = scene_;
    scene.fill.bins = &bins_;
    return scene;
  }
  static kernels::FragmentCounts count_bin(const kernels::FragmentScene<R>& scene, int column, int row,
                                           std::uint32_t limit) {
    if constexpr (std::is_same_v<R, float>)
      return kernels::simd::count_fragments(scene, column, row, limit);
    else
      return kernels::count_fragments(scene, column, row, limit);
  }

  kernels::TriangleBins bins_;
  kernels::FragmentScene<R> scene_;
};

// The offsets of a pattern, `layers` times over: layer l of sample s is sample l * samples + s.
inline std::vector<std::uint16_t> repeated(std::span<const std::uint16_t> offsets, int layers) {
  std::vector<std::uint16_t> out;
  out.reserve(offsets.size() * static_cast<std::size_t>(layers));
  for (int layer = 0; layer < layers; ++layer) out.insert(out.end(), offsets.begin(), offsets.end());
  return out;
}

}  // namespace frustum
