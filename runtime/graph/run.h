// Runs a plan: geometry in parallel, pixels in fused passes over tiles, finished bands to sinks.
#pragma once

#include "runtime/core/sink.h"
#include "runtime/graph/cache.h"
#include "runtime/graph/disk_cache.h"
#include "runtime/graph/events.h"
#include "runtime/graph/plan.h"

#include <map>
#include <optional>
#include <string>

namespace frustum {

struct RunOptions {
  Demand demand = {};
  std::optional<Rect> region = {};  // of every pixel root; same bytes as that part of the whole
  std::string out_folder = "out";
  MakeSink make_sink = {};      // required where demand.outputs has pictures
  SaveBuffer save_buffer = {};  // required where it has other files
  int threads = 0;              // 0: all processors
  int tile_edge = 0;  // 0: chosen so that live planes stay within 1 MB; -1: one tile, the whole frame
  bool fuse = true;
  std::uint64_t memory = 0;  // bytes of buffers that may be live at once; 0: no limit
  const CancelFlag* cancel = nullptr;
  Observer* observer = nullptr;
  MemoryCache* cache = nullptr;  // null: nothing is kept in memory
  DiskCache* disk = nullptr;     // null: nothing is kept on disk
  bool check_cache = false;  // nothing is taken from disk; what is there is compared with what is computed
  std::optional<int> frame = {};  // replaces {frame} in output names
  EffectPolicy effects =
      {};                   // which are simulated whether the scene calls for them or not; in the cache keys
  bool only_facts = false;  // geometry runs and pixel nodes are prepared; no pixel is filled, no file written
};

struct Culprit {
  std::string node, port;  // the first node, in running order, that made a NaN or an infinity
  std::string where;       // "plane R, pixel 3,4, sample 0", "column position, vertex 17"
  std::string inputs;      // its inputs there, as text; empty where they are no numbers
  Health health;
};

// What a node decided about one of its effects.
struct NodeVerdict {
  std::string node, effect;
  Verdict verdict;
};

struct RunResult {
  std::map<PortRef, Buffer> buffers;  // of demand.ports: all at the end `done`, else those that were made
  std::vector<std::string> files;     // written, in order of the outputs
  Diagnostics problems;               // runtime errors and warnings, each at its node's place
  std::optional<Culprit> culprit;
  std::uint64_t peak_bytes = 0;       // of live buffers, prepared nodes and tiles
  std::vector<NodeVerdict> verdicts;  // of the nodes that ran, in the graph's order
  std::vector<NodeCaching> caching;   // one a node that was looked at; empty without a cache
  bool cache_differs = false;         // options.check_cache: some buffer on disk was not what the node makes
  enum class End { done, failed, world_failed, cancelled } end = End::done;
};

// Where an output's file goes: under the output folder, {frame} replaced by four digits.
std::string output_path(const GraphOutput&, const RunOptions&);

// Never throws for what a graph or the world does; everything ends as a RunResult.
RunResult run_graph(const Graph&, const RunOptions&);

}  // namespace frustum
