// From the text of a graph file to a checked, flattened Graph, or to every problem it has.
#pragma once

#include "runtime/core/param.h"
#include "runtime/core/sink.h"
#include "runtime/graph/graph.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace frustum {

// One --set ADDR=VALUE: a graph parameter ("samples"), or a node's ("lit:interpolation", "draw/lit:interpolation").
// The value is JSON; text that is no JSON stands for itself.
struct Setting {
  std::string address;
  std::string value;
};

struct LoadOptions {
  std::vector<Setting> settings = {};
  std::optional<Precision> precision = {};        // above the graph's own
  std::vector<std::string> library_folders = {};  // where "lib:name" looks for name.json, in order
  ParamReader::ToLinear to_linear = {};           // colours written in a named space
  SavedAs saved_as = {};                          // which outputs are no pictures; empty: none
  std::optional<int> frame = {};                  // sets the graph parameter "frame", where it has one
  bool look_for_files = false;                    // whether files that parameters name have to be there
};

struct Loaded {
  std::optional<Graph> graph;  // empty where a problem is an error
  Diagnostics problems;        // with file, line and column
};

// Never throws for what stands in the file; WorldError where the file cannot be read.
Loaded load_graph(const std::string& path, const Registry&, const LoadOptions& = {});

// The same from text; `path` is what relative files start from and what messages name. Cost: linear in the text.
Loaded load_graph_text(const std::string& text, const std::string& path, const Registry&,
                       const LoadOptions& = {});

}  // namespace frustum
