// What a node's results depend on, as a digest: the cache's keys.
#pragma once

#include "runtime/core/digest.h"
#include "runtime/graph/graph.h"

#include <string>
#include <utility>
#include <vector>

namespace frustum {

// One key a node: of its type, version, resolved parameters, precision, seed, the content of the files it names, the
// processor where a library computes its numbers, those of its effects that are forced or skipped, and the keys of its
// inputs. Neither names of nodes, nor threads, nor tile sizes, nor regions enter. Reads every file that is named.
std::vector<Digest> node_keys(const Graph&, const EffectPolicy& = {});

// What the graph is: all of that except the content of files, which is not read. The same for the same graph however its text
// is laid out, whatever its nodes are called.
Digest graph_digest(const Graph&);

// The same keys with what went into each, so that two of them can be told apart by their cause.
struct NodeKey {
  Digest key;
  Digest type;   // name and version
  Digest how;    // precision, seed, processor and what is asked of effects
  Digest files;  // their content
  std::vector<std::pair<std::string, Digest>> params;  // by name
  std::vector<std::pair<std::string, Digest>> inputs;  // by name; of everything linked to it
};
std::vector<NodeKey> explained_keys(const Graph&, const EffectPolicy& = {});

// The key of one output, for a set of outputs that were computed together.
Digest output_key(const Digest& node, std::size_t port);

// A key for what outlives the process: of this build's buffers only.
Digest disk_key(const Digest& key);

}  // namespace frustum
