// What a run knows while it runs: published buffers, prepared pixel nodes, problems. Used by run.cpp and run_pass.cpp.
#pragma once

#include "runtime/graph/ledger.h"
#include "runtime/graph/memory_need.h"
#include "runtime/graph/run.h"
#include "runtime/graph/run_cache.h"

#include <atomic>
#include <map>
#include <mutex>
#include <set>

namespace frustum {

// A prepared pixel node and the planes of its inputs that it reads. Kept in the cache as it is.
struct ReadyNode {
  PreparedNode node;
  std::vector<std::vector<bool>> planes_read;  // one an input; empty for whole inputs
  std::uint64_t bytes = 0;                     // that it claimed
};

class RunState {
 public:
  RunState(const Graph& graph, const RunOptions& options);

  const Graph& graph;
  const RunOptions& options;
  Plan plan;
  RunCache caches;
  Ledger ledger;

  // ----- published results
  Buffer buffer(PortRef p) const {
    return buffers_[p.node][p.port];
  }  // empty where not there (yet, or any more)
  void publish(PortRef p, Buffer b);
  // Only for the caller: the pixels of the region, which no node reads, nor looks whether they are there.
  void publish_part(PortRef p, Buffer b);
  std::shared_ptr<const ReadyNode> ready(std::size_t node) const { return ready_[node]; }
  void set_ready(std::size_t node, std::shared_ptr<const ReadyNode> r) {
    ledger.add_bytes(r->bytes);
    frames_[node] = r->node.frames;
    ready_[node] = std::move(r);
  }
  // Of a prepared node, to the end of the run: its readers may be prepared when its pass is long over.
  const std::shared_ptr<const Frame>& frame(PortRef p) const { return frames_[p.node][p.port]; }

  // A step that had announced to use the port is over; after the last one the buffer is freed.
  void announce_use(PortRef p) { ++uses_[p.node][p.port]; }
  void end_use(PortRef p);
  void announce_ready_use(std::size_t node) { ++ready_uses_[node]; }
  void end_ready_use(std::size_t node);

  // ----- reports, from any thread
  void problem(Diagnostic d, std::size_t order);
  // Of a node, at a part of it (NodeError::part).
  Diagnostic at_node(std::size_t node, const std::string& code, const std::string& message, Severity severity,
                     const std::string& part = {}) const;
  void warning(std::size_t node, const std::string& code,
               const std::string& message);  // to the observer as well
  void culprit(Culprit c, std::size_t order);
  // The file of an output cannot be made or written: what ends its pass is told at the output.
  void output_failed(std::size_t output);
  bool has_failed(std::size_t output);
  void decided(std::size_t node, const std::vector<std::pair<std::string, Verdict>>& verdicts);
  // What every file of this run says of where it comes from: program and version, title and digest of the graph.
  std::vector<std::pair<std::string, std::string>> metadata() const;

  void check_memory(std::uint64_t further) const;  // throws NodeError("memory") over the limit

  template <class F>
  void observe(F&& f) {
    if (options.observer == nullptr) return;
    const std::lock_guard lock(observer_mutex_);
    f(*options.observer);
  }
  void tell(const MemoryNeed& need);  // an observer that asks for it
  std::chrono::nanoseconds now() const { return std::chrono::steady_clock::now() - start_; }

  void take_results(RunResult& result);

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::vector<std::vector<Buffer>> buffers_;
  std::map<PortRef, Buffer> parts_;
  std::vector<std::shared_ptr<const ReadyNode>> ready_;
  std::vector<std::vector<std::shared_ptr<const Frame>>> frames_;
  std::vector<std::vector<std::atomic<int>>> uses_;
  std::vector<std::atomic<int>> ready_uses_;

  std::mutex mutex_, observer_mutex_;
  std::vector<std::pair<std::size_t, Diagnostic>> problems_;
  std::vector<std::pair<std::size_t, Culprit>> culprits_;
  std::vector<std::pair<std::size_t, NodeVerdict>> verdicts_;
  std::set<std::size_t> failed_outputs_;
};

// Pixels that a node read whole are there in full; who asked for a region gets that of them, which may be empty.
Buffer cut_to_region(const Buffer&, const std::optional<Rect>& region);

// run_pass.cpp: walks the tiles of one pass of the plan, makes its roots whole and writes its outputs.
void run_pass(RunState&, std::size_t pass);
// Only says which planes of the pass nobody reads.
void decide_pass(RunState&, std::size_t pass);

}  // namespace frustum
