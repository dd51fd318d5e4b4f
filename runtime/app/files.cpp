#include "runtime/app/files.h"

#include "runtime/core/partial_file.h"
#include "runtime/core/read_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

namespace frustum {
namespace fs = std::filesystem;
namespace {

void add_unique(std::vector<std::string>& list, const fs::path& folder) {
  std::error_code none;
  const fs::path real = fs::weakly_canonical(folder, none);
  if (!fs::is_directory(real, none)) return;
  if (std::find(list.begin(), list.end(), real.string()) == list.end()) list.push_back(real.string());
}

// Whether `name` matches a pattern in which `*` stands for any run of characters. A star that matched too
// little is widened; only the last one ever has to be, so the cost is |name| |pattern|.
bool matches(std::string_view name, std::string_view pattern) {
  constexpr auto none = std::string_view::npos;
  std::size_t n = 0, p = 0, star = none, star_end = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++, star_end = n;
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++p, ++n;
    } else if (star != none) {
      p = star + 1, n = ++star_end;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == none;
}

}  // namespace

std::string read_text(const fs::path& path) { return read_file(path.string()); }

void write_text(const fs::path& path, std::string_view text) {
  PartialFile file(path.string());
  file.add(text);
  file.commit();
}

void require_writable(const fs::path& path) { const PartialFile never_finished(path.string()); }

bool write_if_changed(const fs::path& path, std::string_view text) {
  std::error_code none;
  if (fs::is_regular_file(path, none) && read_text(path) == text) return false;
  write_text(path, text);
  return true;
}

fs::path executable_path() {
  std::error_code none;
  return fs::read_symlink("/proc/self/exe", none);
}

std::optional<fs::path> source_root(const fs::path& start) {
  std::error_code none;
  for (fs::path at = fs::weakly_canonical(fs::absolute(start, none), none);; at = at.parent_path()) {
    if (fs::is_directory(at / "graphs" / "lib", none) && fs::is_directory(at / "nodes", none)) return at;
    if (at == at.parent_path()) return std::nullopt;
  }
}

std::vector<std::string> library_folders(const fs::path& graph) {
  std::vector<std::string> folders;
  // Read once, before any thread that could change the environment.
  if (const char* list = std::getenv("FRUSTUM_LIB")) {  // NOLINT(concurrency-mt-unsafe)
    std::string_view rest = list;
    while (!rest.empty()) {
      const auto colon = rest.find(':');
      if (colon != 0) add_unique(folders, fs::path(rest.substr(0, colon)));
      rest.remove_prefix(colon == std::string_view::npos ? rest.size() : colon + 1);
    }
  }
  const fs::path program = executable_path().parent_path();
  if (!program.empty()) {
    add_unique(folders, program.parent_path() / "share" / "frustum" / "graphs" / "lib");
    if (const auto root = source_root(program)) add_unique(folders, *root / "graphs" / "lib");
  }
  if (const auto root = source_root(graph.has_parent_path() ? graph.parent_path() : fs::path(".")))
    add_unique(folders, *root / "graphs" / "lib");
  return folders;
}

std::vector<fs::path> matching_files(const fs::path& pattern) {
  if (pattern.string().find('*') == std::string::npos) return {pattern};
  std::vector<fs::path> found{pattern.root_path()};
  for (const fs::path& part : pattern.relative_path()) {
    std::vector<fs::path> deeper;
    for (const fs::path& at : found) {
      if (part.string().find('*') == std::string::npos) {
        deeper.push_back(at / part);
        continue;
      }
      std::error_code none;
      for (const auto& entry : fs::directory_iterator(at.empty() ? fs::path(".") : at, none))
        if (matches(entry.path().filename().string(), part.string()))
          deeper.push_back(at / entry.path().filename());
    }
    found = std::move(deeper);
  }
  std::error_code none;
  std::erase_if(found, [&](const fs::path& p) { return !fs::exists(p, none); });
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace frustum
