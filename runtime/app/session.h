// What the command line and the studio both hold: the node types, the libraries, the cache, load and run
// with the doors to files and colours already in place.
#pragma once

#include "runtime/graph/load.h"
#include "runtime/graph/run.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

class Session {
 public:
  Session();  // with every node type of this build
  explicit Session(Registry registry);

  const Registry& registry() const { return registry_; }
  MemoryCache& cache() { return cache_; }

  // load_graph() with this build's libraries and colours filled into `options`. Throws WorldError where
  // the file cannot be read.
  Loaded load(const std::string& path, LoadOptions options = {}) const;

  // From now on runs also keep their buffers in a folder, or compare with what is there. Throws
  // WorldError("cache_unusable").
  void use_disk(const std::string& folder, std::uint64_t limit_bytes, bool check);

  // run_graph() with sinks, and with this session's caches unless `keep` is false. While the folder is only
  // compared with, nothing is taken from memory.
  RunResult run(const Graph&, RunOptions options, bool keep = true);

 private:
  Registry registry_;
  MemoryCache cache_;
  std::optional<DiskCache> disk_;
  bool check_ = false;
};

// The ports that the graph's own outputs without a file name.
std::vector<PortRef> named_ports(const Graph&);

// The end ports of a graph: every output port of the nodes that feed no other node.
std::vector<PortRef> end_ports(const Graph&);

// What --want asks for: outputs with a file are written, other outputs and addresses of ports are kept as
// buffers. Without any, every output of the graph; of a graph without outputs, its end ports. An unknown
// name is reported with near ones.
Demand demand_of(const Graph&, std::span<const std::string> wanted, Diagnostics& problems);

// The port named by `address`, or by an output's name (its main layer, else its first); unknown names are
// reported.
std::optional<PortRef> port_of(const Graph&, std::string_view address, Diagnostics& problems);

// What is wrong with a port, at its node.
Diagnostic at_port(const Graph&, PortRef, std::string code, std::string message);

// Ports that may carry what `is_meant`, of nodes whose names are near that of the node of `port` or its own.
std::vector<std::string> near_ports(const Graph&, PortRef port, bool (*is_meant)(const BufferType&));

}  // namespace frustum
