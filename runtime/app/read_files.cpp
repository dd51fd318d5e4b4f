#include "runtime/app/read_files.h"

#include "runtime/app/session.h"
#include "runtime/app/suite/run.h"
#include "runtime/core/error.h"
#include "runtime/graph/own_files.h"

#include <algorithm>
#include <filesystem>
#include <set>

namespace frustum {
namespace {

namespace fs = std::filesystem;

void add_files_of(const Graph& graph, std::set<std::string>& files) {
  for (const std::string& f : own_files(graph)) files.insert(f);
}

void add_files_below(const fs::path& folder, std::set<std::string>& files) {
  std::error_code none;
  for (fs::directory_iterator at(folder, none), end; !none && at != end; at.increment(none))
    if (at->is_regular_file(none)) files.insert(at->path().string());
}

}  // namespace

std::vector<std::string> files_read_by(Session& session, const std::vector<Suite>& suites) {
  std::set<std::string> files, graphs;
  for (const Suite& suite : suites) {
    files.insert(suite.file);
    add_files_below(golden_folder(suite), files);
    for (const SuiteCase& c : suite.cases) {
      graphs.insert(c.graph);
      for (const SuiteCheck& check : c.checks)
        for (const OtherRun* other : {check.same_as ? &*check.same_as : nullptr,
                                      check.metamorphic ? &check.metamorphic->run : nullptr})
          if (other != nullptr && !other->graph.empty()) graphs.insert(other->graph);
    }
  }
  for (const std::string& path : graphs) {
    files.insert(path);
    try {
      if (const Loaded loaded = session.load(path); loaded.graph) add_files_of(*loaded.graph, files);
    } catch (const WorldError&) {  // its case says so
    }
  }
  return {files.begin(), files.end()};
}

std::optional<Diagnostic> overwriting_one(const std::vector<std::string>& files,
                                          const std::vector<std::string>& targets, std::string_view what) {
  for (const std::string& target : targets)
    if (auto d = overwriting(files, target, what)) return d;
  return std::nullopt;
}

}  // namespace frustum
