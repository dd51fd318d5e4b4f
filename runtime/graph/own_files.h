// The files that a graph was read from, which nothing made from it may take the place of.
#pragma once

#include "runtime/core/diagnostic.h"
#include "runtime/graph/graph.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// The graph's own file and those of the graphs used as nodes in it, each once. Cost: one pass over the nodes.
std::vector<std::string> own_files(const Graph&);

// An error that names `what` ("--trace", "output 'z'") where `path` is one of the files: by the file itself, not
// by its name. Cost: a look at the disk, and one for each file where there is something at `path`.
std::optional<Diagnostic> overwriting(const std::vector<std::string>& files, const std::string& path,
                                      std::string_view what);

}  // namespace frustum
