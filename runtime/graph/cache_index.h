// The keys that the nodes of a graph had in its last run with a cache on disk: why a node is not found this time.
#pragma once

#include "runtime/graph/disk_cache.h"
#include "runtime/graph/keys.h"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

class CacheIndex {
 public:
  // What is known of the graph; empty for one without a file, for one never run, and where the file says no sense.
  CacheIndex(DiskCache& disk, const Graph& graph);

  struct Reason {
    std::string_view code;  // "never_seen", "params_changed", ... (docs/cache.md lists them)
    std::string detail;     // which parameters, which inputs
  };
  // Why the key is another one than last time; for the same key, what became of the buffer then.
  Reason why_missing(const std::string& node, const NodeKey& key) const;

  // Notes the key of a node, and what became of its buffers ("stored", "cheap", ...).
  void note(const std::string& node, const NodeKey& key, std::string_view kept);
  void save();

 private:
  struct Entry {
    std::string build, key, type, how, files, kept;
    std::map<std::string, std::string> params, inputs;
  };
  void read(const std::string& text);

  DiskCache& disk_;
  std::string graph_;
  std::map<std::string, Entry> nodes_;
};

}  // namespace frustum
