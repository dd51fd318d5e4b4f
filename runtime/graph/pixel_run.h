// Walks the tiles of a pixel program: on all cores, into whole rasters and, band by band, into sinks.
#pragma once

#include "runtime/core/context.h"
#include "runtime/core/health.h"
#include "runtime/core/sink.h"
#include "runtime/graph/tile_program.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace frustum {

// A layer of a sink: a root of the program, or pixels that are whole already.
struct SinkSource {
  std::variant<std::size_t, Raster> from;  // index into the program's roots, or the raster
};

struct SinkJob {
  Sink* sink = nullptr;
  Rect region = {};  // what it is written; others of the pass may have more
  std::vector<SinkSource> layers;
};

struct PixelJob {
  const TileProgram* program = nullptr;
  std::vector<std::optional<Raster>> whole;  // one a root: where it is made whole, if it is
  std::vector<SinkJob> sinks;
  Rect region;        // what is filled; for whole rasters cut to their windows
  int tile_edge = 0;  // as in RunOptions
  const CancelFlag* cancel = nullptr;
  std::function<void(double)> progress;  // from any thread, at most every 50 ms
};

// The first operation that made a NaN or infinity, in the first tile (in reading order) that holds one.
struct PixelCulprit {
  std::size_t op = 0, port = 0;
  Health health;
  std::string inputs;
};

struct PixelOutcome {
  TileCosts costs;
  int tile_edge = 0;
  std::size_t worker_bytes = 0;  // of all threads' tiles at their peak
  std::optional<PixelCulprit> culprit;
};

// Throws Cancelled, NodeError, WorldError. The same bytes for every tile edge and number of threads.
PixelOutcome run_pixels(const PixelJob&);

// One value a pixel: that of the sample nearest to the pixel's centre (the first of equals). `out` has no pattern.
void pick_central_samples(const Tile& sampled, const Tile& out);

// The frame that a sink sees of a root's frame: cut to a region, one value a pixel.
Frame sink_frame(const Frame& frame, Rect region);

}  // namespace frustum
