// What the caches, in memory and on disk, do for one run: what is found before it, what is kept of it, and why.
#pragma once

#include "runtime/graph/cache.h"
#include "runtime/graph/cache_index.h"
#include "runtime/graph/keys.h"
#include "runtime/graph/run.h"

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace frustum {

// What a node says when it runs; a node that is found in a cache says it again.
struct NodeNotes {
  std::vector<std::pair<std::string, std::string>> warnings;  // code, message
  std::optional<Culprit> culprit;
};

// Storing on disk pays where loading is faster than computing anew. The cost of having a node's buffer again is its own
// time and the greatest cost among its inputs, which is nothing but a load for those that are on disk. It is stored where
// that is at least 1 ms and twice the expected time of the load: 0.2 ms a file and 1 ms per MB.
class RunCache {
 public:
  RunCache(const Graph& graph, const RunOptions& options);

  bool any() const { return options_.cache != nullptr || disk_ != nullptr; }

  // Walks back from what is demanded and gives `publish` each port that is there, from memory or from disk; what feeds
  // only ports that were found is not looked up. `publish` answers whether the run has room for it.
  void look_up(const std::function<bool(PortRef, const Buffer&)>& publish);

  // Prepared pixel nodes are kept in memory only.
  std::shared_ptr<const void> find_prepared(std::size_t node, std::uint64_t wanted_outputs) const;
  void keep_prepared(std::size_t node, std::uint64_t wanted_outputs, std::shared_ptr<const void> prepared,
                     std::uint64_t bytes) const;

  // ----- while running: from the thread that ran the node; readers of its buffers come after
  void ran(std::size_t node, std::chrono::nanoseconds time);
  void ran_pass(const std::vector<std::size_t>& nodes, std::chrono::nanoseconds time);
  void said(std::size_t node, const std::string& code, const std::string& message);
  void said(std::size_t node, const Culprit& culprit);
  // A complete buffer of a port that was computed: kept where it pays, or compared where that is asked for.
  void keep(PortRef port, const Buffer& buffer);
  // Whether a picture that only streams into files is worth holding whole, so that the next run finds it.
  bool wants_whole(PortRef port, std::uint64_t bytes) const;

  // ----- the end
  NodeNotes notes(std::size_t node) const;  // of an earlier run with the same key
  // One a node that was looked at, in the graph's order. `completed`: the run came to its end.
  std::vector<NodeCaching> finish(bool completed);
  Diagnostics take_problems();  // of the folder, and buffers that differ
  bool differs() const { return differs_; }

 private:
  bool usable(PortRef port) const;
  Buffer find(PortRef port, NodeCaching& said);
  void explain(std::size_t node, NodeCaching& said) const;
  std::string_view store(PortRef port, const Buffer& buffer, const Digest& key);
  std::string_view compare(PortRef port, const Buffer& buffer, const Digest& key);
  double cost_ms(std::size_t node);
  void flush_notes(std::size_t node);  // with the lock held

  const Graph& graph_;
  const RunOptions& options_;
  DiskCache* disk_;
  std::vector<NodeKey> keys_;
  std::optional<CacheIndex> index_;
  std::vector<double> cost_ms_;  // of having a node's buffers again
  std::vector<NodeCaching> caching_;
  std::vector<std::uint8_t> looked_at_;  // bytes, not bits: several threads write
  std::vector<NodeNotes> notes_;
  std::mutex mutex_;
  Diagnostics problems_;
  std::atomic<bool> differs_{false};
};

}  // namespace frustum
