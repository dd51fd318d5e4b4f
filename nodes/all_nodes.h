// Every node type of this build. Its body is generated from the folders of nodes/, as are the headers
// "nodes/<family>.h" that declare one function for each node of a family: adding a node compiles its family
// anew and no other.
#pragma once
#include <vector>

namespace frustum {
class NodeType;

// Sorted by file name.
std::vector<NodeType> all_node_types();

}  // namespace frustum
