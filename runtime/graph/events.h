// What a run says about itself while it runs. The progress bar, the event stream, the trace and the studio listen.
#pragma once

#include "runtime/core/buffer.h"

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum {

// not_needed: what reads the node's buffers was found, so they were not looked for.
enum class CacheVerdict : std::uint8_t { off, miss, hit, not_needed };
std::string_view name_of(CacheVerdict);

// What the caches did for one node.
struct NodeCaching {
  std::string node;
  CacheVerdict verdict = CacheVerdict::off;
  std::string from = {};              // of a hit: "memory" or "disk"
  std::string why = {}, detail = {};  // of a miss, where the cache on disk knows: "params_changed", "samples"
  std::string kept = {};              // of a miss: "stored", "cheap", "not_whole", ...; with check: "same"
  std::uint64_t bytes = 0;            // of the buffers found on disk, or computed
};

// One piece of work that ended: a geometry node, the preparation of a pixel node, or a pass over tiles.
struct WorkDone {
  enum class Kind : std::uint8_t { node, prepare, pixels };
  Kind kind = Kind::node;
  std::vector<std::string> nodes;              // ids: one, or for `pixels` all that were fused
  std::chrono::nanoseconds start{0}, time{0};  // since the run began; wall time
  std::uint64_t bytes = 0;                     // of the buffers that it published
  CacheVerdict cache = CacheVerdict::off;
  int thread = 0;  // a small number, 0 is the one that started the run
  std::vector<std::pair<std::string, std::uint64_t>> counters;
};

// Within a pass over tiles, the share of each fused node (summed over all threads).
struct PixelNodeTime {
  std::string node;
  std::chrono::nanoseconds time{0};
  std::uint64_t pixels = 0;   // filled, margins included
  std::uint64_t samples = 0;  // the same times the samples of a pixel
};

// Called from several threads, one call at a time.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void planned(std::size_t /*work_items*/) {}
  virtual void started(std::string_view /*node*/) {}
  virtual void progress(std::string_view /*node*/, double /*fraction*/) {}
  virtual void done(const WorkDone&) {}
  virtual void pixel_times(const std::vector<PixelNodeTime>&) {}
  virtual void cached(const NodeCaching&) {}  // at the end, one a node that was looked at
  virtual void warned(std::string_view /*node*/, std::string_view /*code*/, std::string_view /*message*/) {}
};

}  // namespace frustum
