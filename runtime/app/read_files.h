// The files that a command reads, which it may not write over.
#pragma once

#include "runtime/app/suite/suite.h"
#include "runtime/graph/graph.h"

#include <string>
#include <vector>

namespace frustum {

class Session;

// Suites, their books of goldens and the stored numbers beside these, the graphs of all cases and of the runs that
// they are compared with, and what those graphs read. Graphs that cannot be loaded count with their own file. Cost:
// loads every graph once, whatever the number of its cases.
std::vector<std::string> files_read_by(Session&, const std::vector<Suite>&);

// An error (overwrites_graph) for the first of `targets` that is there and is one of the files.
std::optional<Diagnostic> overwriting_one(const std::vector<std::string>& files,
                                          const std::vector<std::string>& targets, std::string_view what);

}  // namespace frustum
