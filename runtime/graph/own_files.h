// The files that a graph reads, which nothing made from it may take the place of.
#pragma once

#include "runtime/core/diagnostic.h"
#include "runtime/graph/graph.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// The graph's own file, those of the graphs used as nodes in it, and those that its nodes read (meshes, pictures, what
// these name beside themselves), each once. Cost: one pass over the nodes, and a look into the files that name others.
std::vector<std::string> own_files(const Graph&);

// An error that names `what` ("--trace", "output 'z'") where `path` is one of the files: by the file itself, not
// by its name. Cost: a look at the disk, and one for each file where there is something at `path`.
std::optional<Diagnostic> overwriting(const std::vector<std::string>& files, const std::string& path,
                                      std::string_view what);
// The same of the files of a graph, which are only looked for where there is something at `path`.
std::optional<Diagnostic> overwriting(const Graph&, const std::string& path, std::string_view what);

}  // namespace frustum
