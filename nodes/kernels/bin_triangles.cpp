#include "nodes/kernels/bin_triangles.h"

#include <memory>
#include <numeric>

#include "nodes/kernels/parallel.h"
#include "nodes/kernels/simd/box_triangles.h"

namespace frustum::kernels {
namespace {

// A stretch of the triangles in drawing order; its boxes are boxed[begin, begin + counts.boxed).
struct Chunk {
  std::size_t begin = 0, end = 0;
  BoxCounts counts;
};

template <class R>
class Binner {
 public:
  Binner(const ScreenMesh<R>& mesh, const SamplePositions& pattern, PixelRect window,
         const std::function<void(std::uint64_t)>& claim)
      : mesh_(mesh), box_(sample_box(pattern)), window_(window), claim_(claim) {
    bins_.window = window;
    bins_.columns = (window.x1 - window.x0 + TriangleBins::size - 1) / TriangleBins::size;
    bins_.rows = (window.y1 - window.y0 + TriangleBins::size - 1) / TriangleBins::size;
    order_by_origin();
    this->claim(mesh.face.size() * sizeof(BoxedTriangle));
    boxed_.reset(new BoxedTriangle[mesh.face.size()]);
  }

  TriangleBins run() {
    split_into_chunks();
    each_chunk([this](std::size_t c) { box_chunk(c); });
    allot();
    each_chunk([this](std::size_t c) { scatter_chunk(c); });
    for (const Chunk& c : chunks_) {
      bins_.out_of_range += c.counts.out_of_range;
      bins_.without_area += c.counts.without_area;
    }
    return std::move(bins_);
  }

 private:
  void claim(std::uint64_t bytes) const {
    if (claim_) claim_(bytes);
  }

  // Faces are drawn by ascending (origin, face), so that of equal depths the first drawn is the one to keep.
  void order_by_origin() {
    if (std::is_sorted(mesh_.origin.begin(), mesh_.origin.end())) return;
    order_.resize(mesh_.face.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::stable_sort(order_.begin(), order_.end(),
                     [this](std::uint32_t a, std::uint32_t b) { return mesh_.origin[a] < mesh_.origin[b]; });
  }

  // A chunk has a counter for each bin, so there are as many chunks as keep all counters within O(faces +
  // bins).
  void split_into_chunks() {
    const std::size_t faces = mesh_.face.size(), bins = bin_count();
    const std::size_t count = std::clamp<std::size_t>(faces / std::max<std::size_t>(bins, 4096), 1, 64);
    chunks_.resize(count);
    for (std::size_t c = 0; c < count; ++c) {
      chunks_[c].begin = faces * c / count;
      chunks_[c].end = faces * (c + 1) / count;
    }
    cursor_.assign(count * bins, 0);
  }

  template <class F>
  void each_chunk(const F& f) {
    parallel_each(chunks_.size(), f);
  }

  std::size_t bin_count() const {
    return static_cast<std::size_t>(bins_.columns) * static_cast<std::size_t>(bins_.rows);
  }

  void box_chunk(std::size_t c) {
    Chunk& chunk = chunks_[c];
    BoxedTriangle* boxed = &boxed_[chunk.begin];
    const auto begin = static_cast<std::uint32_t>(chunk.begin), end = static_cast<std::uint32_t>(chunk.end);
    if (!order_.empty())
      for (std::uint32_t i = begin; i < end; ++i)
        box_triangle(mesh_, order_[i], box_, window_, boxed, chunk.counts);
    else if constexpr (std::is_same_v<R, float>)
      chunk.counts = simd::box_triangles(mesh_, begin, end, box_, window_, boxed);
    else
      chunk.counts = box_triangles(mesh_, begin, end, box_, window_, boxed);
    std::uint64_t* count = &cursor_[c * bin_count()];
    for (std::size_t i = 0; i < chunk.counts.boxed; ++i)
      each_bin(boxed[i], [count](std::size_t bin, const BinEntry&) { ++count[bin]; });
  }

  // Calls visit(bin, entry) for the bins that the triangle may touch.
  template <class F>
  void each_bin(const BoxedTriangle& t, F&& visit) const {
    constexpr int size = TriangleBins::size;
    const int column0 = t.x0 / size, column1 = t.x1 / size, row0 = t.y0 / size, row1 = t.y1 / size;
    const bool may_miss = column1 > column0 && row1 > row0;
    const std::array<Edge, 3> edges =
        may_miss ? screen_triangle(mesh_, t.face, R(1))->edge : std::array<Edge, 3>{};
    for (int row = row0; row <= row1; ++row)
      for (int column = column0; column <= column1; ++column) {
        if (may_miss && misses(edges, column, row)) continue;
        const int x = column * size, y = row * size;
        const auto local = [](int v) { return static_cast<std::uint8_t>(std::clamp(v, 0, size - 1)); };
        const auto bin = static_cast<std::size_t>(row) * static_cast<std::size_t>(bins_.columns) +
                         static_cast<std::size_t>(column);
        visit(bin, BinEntry{t.face, local(t.x0 - x), local(t.y0 - y), local(t.x1 - x), local(t.y1 - y)});
      }
  }

  // Whether all samples of the bin lie outside one edge: even the one farthest to the edge's inside.
  bool misses(const std::array<Edge, 3>& edges, int column, int row) const {
    const std::int64_t x0 = window_.x0 + column * TriangleBins::size, x1 = x0 + TriangleBins::size - 1;
    const std::int64_t y0 = window_.y0 + row * TriangleBins::size, y1 = y0 + TriangleBins::size - 1;
    return std::any_of(edges.begin(), edges.end(), [&](const Edge& e) {
      const std::int64_t inmost = e.at_pixel(e.a > 0 ? x1 : x0, e.b > 0 ? y1 : y0);
      return !Edge::covers(inmost, e.at_offset(e.a > 0 ? box_.x1 : box_.x0, e.b > 0 ? box_.y1 : box_.y0));
    });
  }

  // Turns the counts into the place of each chunk's first entry in each bin.
  void allot() {
    const std::size_t bins = bin_count();
    bins_.first.resize(bins + 1);
    std::uint64_t next = 0;
    for (std::size_t bin = 0; bin < bins; ++bin) {
      bins_.first[bin] = next;
      for (std::size_t c = 0; c < chunks_.size(); ++c) next += std::exchange(cursor_[c * bins + bin], next);
    }
    bins_.first[bins] = next;
    claim(next * sizeof(BinEntry));
    bins_.entries.resize(next);
  }

  void scatter_chunk(std::size_t c) {
    std::uint64_t* cursor = &cursor_[c * bin_count()];
    const BoxedTriangle* boxed = &boxed_[chunks_[c].begin];
    for (std::size_t i = 0; i < chunks_[c].counts.boxed; ++i)
      each_bin(boxed[i],
               [&](std::size_t bin, const BinEntry& entry) { bins_.entries[cursor[bin]++] = entry; });
  }

  const ScreenMesh<R>& mesh_;
  SampleBox box_;
  PixelRect window_;
  const std::function<void(std::uint64_t)>& claim_;
  TriangleBins bins_;
  std::vector<std::uint32_t> order_;        // empty where faces already stand in drawing order
  std::unique_ptr<BoxedTriangle[]> boxed_;  // per chunk, from its begin
  std::vector<Chunk> chunks_;
  std::vector<std::uint64_t> cursor_;  // [chunk][bin]
};

}  // namespace

template <std::floating_point R>
TriangleBins bin_triangles(const ScreenMesh<R>& mesh, const SamplePositions& pattern, PixelRect window,
                           const std::function<void(std::uint64_t)>& claim) {
  return Binner<R>(mesh, pattern, window, claim).run();
}

template TriangleBins bin_triangles(const ScreenMesh<float>&, const SamplePositions&, PixelRect,
                                    const std::function<void(std::uint64_t)>&);
template TriangleBins bin_triangles(const ScreenMesh<double>&, const SamplePositions&, PixelRect,
                                    const std::function<void(std::uint64_t)>&);

}  // namespace frustum::kernels
