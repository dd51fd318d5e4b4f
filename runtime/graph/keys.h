// What a node's results depend on, as a digest: the cache's keys.
#pragma once

#include "runtime/core/digest.h"
#include "runtime/graph/graph.h"

#include <vector>

namespace frustum {

// One key a node: of its type, version, resolved parameters, precision, seed, the content of the files it names, and the keys
// of its inputs. Neither names of nodes, nor threads, nor tile sizes, nor regions enter. Reads every file that is named.
std::vector<Digest> node_keys(const Graph&);

// The key of one output, for a set of outputs that were computed together.
Digest output_key(const Digest& node, std::size_t port);

}  // namespace frustum
