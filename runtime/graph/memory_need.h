// What a run that fills no pixel (RunOptions::only_facts) finds out about memory.
#pragma once

#include "runtime/graph/events.h"

#include <cstdint>
#include <string>
#include <vector>

namespace frustum {

// Bytes of buffers that are live when a geometry node has run or a pixel node is prepared, or that would be live while a
// pass over tiles runs.
struct MemoryNeed {
  std::vector<std::string> nodes;  // ids: one, or all that are fused in the pass
  bool pass = false;
  std::uint64_t least = 0;  // buffers, prepared nodes and the tiles of every thread
  std::uint64_t most = 0;   // and, where files are slower than pixels, the bands on their way to them
};

// An observer that such a run tells of every node and pass it reaches; passes that read pixels which an earlier one would
// have to make whole are not reached. Called like the others: one call at a time.
class MemoryObserver : public Observer {
 public:
  virtual void needs(const MemoryNeed&) = 0;
};

}  // namespace frustum
