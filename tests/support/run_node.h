// Runs one node type without a graph: parameters from JSON, inputs from buffers.
#pragma once

#include "runtime/core/node_type.h"

#include <string>
#include <vector>

namespace frustum::test {

using NodeInputs = std::vector<std::vector<Buffer>>;  // one list a declared input, in order; empty: left out

// The node's outputs in declared order. `folder` is what relative files start from. Throws
// std::runtime_error with the diagnostics where the parameters are wrong. A pixel node fills its whole
// frame in tiles of `tile_edge` (0: one tile).
std::vector<Buffer> run_node(const NodeType&, const Json& params, const NodeInputs& = {}, Context* = nullptr,
                             const std::string& folder = {}, int tile_edge = 0);

// The code of the NodeError or WorldError that running ends with, and its message; "" where there is none.
std::pair<std::string, std::string> run_error(const NodeType&, const Json& params, const NodeInputs& = {},
                                              const std::string& folder = {});

}  // namespace frustum::test
