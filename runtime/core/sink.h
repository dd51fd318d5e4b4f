// Where finished pixels and whole buffers go: an interface here, writers in runtime/io, handed in by the application.
#pragma once

#include "runtime/core/buffer.h"
#include "runtime/core/raster.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum {

// Told a code and a sentence about a file that is made all the same; called before it is begun or while it is.
using FileWarning = std::function<void(std::string_view code, const std::string& message)>;

// One layer of an output: "" is the main one (R, G, B, A); others prefix their planes ("N" gives N.X, N.Y, N.Z).
struct SinkLayer {
  std::string name;
  Frame frame;  // without a pattern: sinks take one value a pixel
};

// Takes the bands of a picture from top to bottom. Nothing is visible under the final name before finish().
class Sink {
 public:
  virtual ~Sink() = default;  // without finish(): removes what was written
  // Full-width rows of the region, one tile a layer, all with the same rectangle; bands come in order without gaps.
  virtual void write(std::span<const Tile> layers) = 0;
  virtual void finish() = 0;
};

// An entry of a graph's "outputs", ready to be written.
struct SinkRequest {
  std::string path;     // where the finished file goes
  Rect region;          // what will be written, within the display window
  Rect display_window;  // the whole picture
  std::vector<SinkLayer> layers;
  int bits = 0;             // 0: the format's usual depth
  std::string compression;  // empty: the format's usual one
  std::vector<std::pair<std::string, std::string>> metadata;
  FileWarning warn = {};  // may be empty
};

// Throws WorldError where the file cannot be made, NodeError where the format cannot hold the layers.
using MakeSink = std::function<std::unique_ptr<Sink>(const SinkRequest&)>;

// A whole buffer as a file, in the format of the path's extension.
struct SaveRequest {
  std::string path;  // where the finished file goes; nothing is visible there before it is whole
  std::vector<std::pair<std::string, std::string>> metadata = {};
  FileWarning warn = {};  // may be empty
  // Told all bytes that the writer will have taken, before it takes more; throws to refuse. May be empty.
  std::function<void(std::uint64_t all)> admit = {};
};

// Throws WorldError where the file cannot be made, NodeError where the format cannot hold the buffer.
using SaveBuffer = std::function<void(const Buffer&, const SaveRequest&)>;

// Extensions of the files that SaveBuffer can make of a kind of buffer, without dots: what graphs are checked against.
using SavedAs = std::function<std::vector<std::string>(const BufferType&)>;

}  // namespace frustum
