// Planar pixel data: whole rasters, and views of their rectangles.
#pragma once

#include "runtime/core/frame.h"
#include "runtime/core/pages.h"

#include <cassert>
#include <cstddef>
#include <memory>
#include <span>

namespace frustum {

// A rectangle of a frame's planes, owned by somebody else. Layout: planes x samples x rows; a row is contiguous in x.
// A plane that nobody reads has no storage: has(plane) is false and its rows must not be touched.
class Tile {
 public:
  Tile() = default;
  // `planes` points, for each plane of the frame, to the element of sample 0 at the top left pixel of `stored`.
  Tile(const Frame* frame, Rect rect, Rect stored, std::ptrdiff_t row_stride, std::ptrdiff_t sample_stride,
       std::span<std::byte* const> planes)
      : frame_(frame),
        rect_(rect),
        stored_(stored),
        row_stride_(row_stride),
        sample_stride_(sample_stride),
        planes_(planes) {}

  const Frame& frame() const { return *frame_; }
  const Rect& rect() const { return rect_; }
  const Rect& stored() const { return stored_; }  // what may be addressed; rect() lies within it
  int samples() const { return frame_->samples(); }
  bool empty() const {
    return frame_ == nullptr;
  }  // an optional input left out, or an output that nobody reads
  bool has(int plane) const { return planes_[static_cast<std::size_t>(plane)] != nullptr; }
  std::ptrdiff_t row_stride() const { return row_stride_; }        // elements
  std::ptrdiff_t sample_stride() const { return sample_stride_; }  // elements

  // The row `y` (absolute) of one sample of one plane; element 0 is pixel rect().x0.
  template <class T>
  T* row(int plane, int sample, int y) const {
    assert(has(plane) &&
           frame_->planes[static_cast<std::size_t>(plane)].kind == plane_kind_of<std::remove_const_t<T>>);
    return reinterpret_cast<T*>(planes_[static_cast<std::size_t>(plane)]) + sample * sample_stride_ +
           (y - stored_.y0) * row_stride_ + (rect_.x0 - stored_.x0);
  }

  bool shares_storage(const Tile& other) const { return planes_.data() == other.planes_.data(); }

  // The same storage seen through another rectangle of stored().
  Tile part(Rect rect) const {
    assert(stored_.contains(rect));
    Tile t = *this;
    t.rect_ = rect;
    return t;
  }

 private:
  const Frame* frame_ = nullptr;
  Rect rect_, stored_;
  std::ptrdiff_t row_stride_ = 0, sample_stride_ = 0;
  std::span<std::byte* const> planes_;
};

// Elements from one row to the next that keep every row of a plane on a 64-byte boundary.
constexpr std::ptrdiff_t padded_row(int width) { return (std::ptrdiff_t{width} + 15) / 16 * 16; }

// A whole frame in memory: planes x samples x rows, every plane and row on a 64-byte boundary.
// Immutable once published; copies share the storage.
class Raster {
 public:
  Raster() : Raster(Frame{}) {}
  // Zero, unless the maker writes every pixel; throws WorldError("out_of_memory") where the pages cannot be had.
  explicit Raster(Frame frame, Contents = Contents::zero);

  const Frame& frame() const;
  std::size_t bytes() const;  // of pixel storage

  // A view of a rectangle within the window. Writing through it is for the maker, before publication.
  Tile view() const;
  Tile view(Rect rect) const { return view().part(rect); }

  template <class T>
  T at(int plane, int sample, int x, int y) const {
    return view().template row<T>(plane, sample, y)[x - frame().window.x0];
  }
  // The value of any kind of plane as a double (exact: u32 and f32 are widened).
  double value(int plane, int sample, int x, int y) const;

 private:
  struct Storage;
  std::shared_ptr<const Storage> storage_;
};

// Fills what of a tile lies outside of `inner` with what shows nothing: 0, and all bits set in planes of integers, which
// is no face. `inner` lies within the tile's rectangle, or is empty.
void blank_around(const Tile&, const Rect& inner);

// Copies every plane that both tiles store over the intersection of their rectangles. Both frames have the same planes.
void copy(const Tile& from, const Tile& to);

}  // namespace frustum
