#include "runtime/graph/own_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace frustum {

std::vector<std::string> own_files(const Graph& graph) {
  std::set<std::string> files;
  if (!graph.file.empty()) files.insert(graph.file);
  for (const GraphNode& n : graph.nodes) {
    if (!n.place.file.empty()) files.insert(n.place.file);
    if (!n.type->params.files || !n.params) continue;
    n.type->params.files(n.params.get(), [&](const FilePath& f) {
      if (!f.resolved.empty()) files.insert(f.resolved);
    });
  }
  return {files.begin(), files.end()};
}

std::optional<Diagnostic> overwriting(const std::vector<std::string>& files, const std::string& path,
                                      std::string_view what) {
  namespace fs = std::filesystem;
  std::error_code none;
  if (path.empty() || !fs::exists(path, none)) return std::nullopt;
  const auto own = std::find_if(files.begin(), files.end(),
                                [&](const std::string& f) { return fs::equivalent(f, path, none); });
  if (own == files.end()) return std::nullopt;
  return Diagnostic{.code = "overwrites_graph",
                    .pointer = "",
                    .message = fmt::format("{} would write over {}, which is read", what, *own),
                    .expected = "another file",
                    .got = path};
}

std::optional<Diagnostic> overwriting(const Graph& graph, const std::string& path, std::string_view what) {
  std::error_code none;
  if (path.empty() || !std::filesystem::exists(path, none)) return std::nullopt;
  return overwriting(own_files(graph), path, what);
}

}  // namespace frustum
