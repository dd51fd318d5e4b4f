// Pixel buffers that stream: at preparation a Tiled<T> is the shape of what will flow, at run time a Tile.
#pragma once

#include "runtime/core/error.h"
#include "runtime/core/raster.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum {

// As an input of prepare(): the upstream frame, in which the node names the planes it will read.
// As an output of prepare(): the frame that tile() will fill.
template <class T>
class Tiled {
 public:
  Tiled() = default;
  Tiled(Frame frame) : frame_(std::make_shared<const Frame>(std::move(frame))) {}
  Tiled(std::shared_ptr<const Frame> frame, std::shared_ptr<std::vector<bool>> read)
      : frame_(std::move(frame)), read_(std::move(read)) {}

  const Frame& frame() const { return *frame_; }
  const std::shared_ptr<const Frame>& shared_frame() const { return frame_; }

  // The index of a plane that tile() will read; planes that nobody reads are neither stored nor worth computing.
  // Throws NodeError("missing_plane") where the frame has none of that name.
  int read(std::string_view plane) const {
    const auto i = try_read(plane);
    if (!i) throw NodeError("missing_plane", "the pixels have no plane '" + std::string(plane) + "'");
    return *i;
  }
  std::optional<int> try_read(std::string_view plane) const {
    const auto i = frame_->find(plane);
    if (i && read_) (*read_)[static_cast<std::size_t>(*i)] = true;
    return i;
  }
  void read_all() const {
    if (read_) read_->assign(read_->size(), true);
  }

 private:
  std::shared_ptr<const Frame> frame_ = std::make_shared<const Frame>();
  std::shared_ptr<std::vector<bool>> read_;
};

template <class State, class Outputs>
struct Prepared {
  State state;
  Outputs outputs;
};

// Scratch memory of one thread for the time of one tile() call: bump allocation, 64-byte aligned, never shrunk.
class Arena {
 public:
  template <class T>
  std::span<T> take(std::size_t count) {
    return {static_cast<T*>(take_bytes(count * sizeof(T))), count};
  }
  void reset();
  std::size_t capacity() const;

 private:
  void* take_bytes(std::size_t size);
  struct Block {
    std::unique_ptr<std::byte, void (*)(std::byte*)> data;
    std::size_t size;
  };
  std::vector<Block> blocks_;
  std::size_t used_ = 0;
};

// The tiles of a node's inputs or outputs, found by member: `in[&Inputs::points].row<float>(plane, sample, y)`.
// An optional input left out, and an output that nobody reads, is an empty() tile.
template <class Ports>
class TilesOf {
 public:
  TilesOf(std::span<const Tile> tiles, std::span<const std::size_t> offsets)
      : tiles_(tiles), offsets_(offsets) {}

  template <class M>
  const Tile& operator[](M Ports::*member) const {
    static const Ports probe{};
    static const Tile none;
    const auto offset = static_cast<std::size_t>(reinterpret_cast<const char*>(&(probe.*member)) -
                                                 reinterpret_cast<const char*>(&probe));
    for (std::size_t i = 0; i < offsets_.size(); ++i)
      if (offsets_[i] == offset) return tiles_[i];
    return none;
  }

 private:
  std::span<const Tile> tiles_;
  std::span<const std::size_t> offsets_;
};

}  // namespace frustum
