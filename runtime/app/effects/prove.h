// The proof that what a plan leaves out changes nothing: the graph runs as planned and with what is off forced, and
// every bit of every layer that is asked for is compared.
#pragma once

#include "runtime/app/session.h"

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace frustum {

struct ProveOptions {
  int repeats = 3;  // timed runs of each variant, in turns
  int threads = 0;
  const CancelFlag* cancel = nullptr;
};

// A port that is asked for by itself or as a layer of a file.
struct ProvedLayer {
  std::string name;  // "aov:Z = hits.depth"
  PortRef port;
  Digest digest = {};    // as planned
  std::string left_out;  // why it is not compared; empty: it is
};

// One layer that came out different when something was forced.
struct LayerDifference {
  std::string layer;
  std::uint64_t bits = 0;  // that differ
  std::string worst;       // where the numbers are furthest apart
};

// One way of running the graph.
struct ProvedRun {
  std::string forced;              // an effect's name, "all", or empty: as planned
  std::vector<std::string> nodes;  // whose effect it is that was off; empty of "all" and of the planned run
  std::vector<LayerDifference> differences = {};
  std::vector<std::chrono::nanoseconds> times = {};
  std::chrono::nanoseconds median_time() const;
};

struct Proof {
  std::vector<NodeVerdict> verdicts;  // of the planned run
  std::vector<ProvedLayer> layers;
  std::vector<ProvedRun> runs;  // as planned, all forced, then each effect that was off
  Diagnostics problems;         // that ended a run
  RunResult::End end = RunResult::End::done;

  std::size_t skipped() const;  // effects of nodes that were off by certificate
  std::uint64_t differing_bits() const;
  bool holds() const { return end == RunResult::End::done && differing_bits() == 0; }
};

// Runs without caches; files are not written, their layers are held in memory. A shortcut (faces outside the view) changes
// the geometry that follows it and no picture: pixels are compared for it, other buffers after it are not.
Proof prove_effects(Session&, const Graph&, const Demand&, const ProveOptions&);

// Bits of the content that differ; for buffers of other sizes those of the longer one too.
std::uint64_t differing_bits(const Buffer& a, const Buffer& b);

// {"skipped", "bits_differ", "times_faster", "layers": [...], "runs": [{"forced", "nodes", "median_ms", "differences"}]}
Json to_json(const Proof&);
std::string proof_text(const Proof&);

}  // namespace frustum
