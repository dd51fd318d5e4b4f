#include "runtime/core/missing_file.h"

#include "runtime/core/diagnostic.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace frustum {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_names = 1000, longest_name = 255;

// A name that no file can have, rather than one that cannot be reached now.
bool is_impossible(const std::error_code& error) {
  return error == std::errc::filename_too_long || error == std::errc::too_many_symbolic_link_levels ||
         error == std::errc::invalid_argument;
}

}  // namespace

std::string why_missing(const std::string& path, std::string_view written) {
  std::error_code error;
  switch (fs::status(path, error).type()) {
    case fs::file_type::regular: return {};
    case fs::file_type::directory: return fmt::format("'{}' is a folder, not a file", written);
    case fs::file_type::not_found: return fmt::format("there is no file '{}'", written);
    case fs::file_type::none:
      return is_impossible(error) ? fmt::format("'{}' cannot be a file: {}", written, error.message()) : "";
    default: return fmt::format("'{}' is not a regular file", written);
  }
}

std::vector<std::string> near_files(const std::string& path, std::string_view written) {
  const fs::path folder = fs::path(path).parent_path();
  const std::string name = fs::path(path).filename().string();
  if (name.empty() || name.size() > longest_name) return {};
  std::vector<std::string> names;
  std::error_code error, kind;
  for (fs::directory_iterator at(folder.empty() ? fs::path(".") : folder, error), end;
       !error && at != end && names.size() < most_names; at.increment(error))
    if (at->is_regular_file(kind)) names.push_back(at->path().filename().string());
  std::sort(names.begin(), names.end());  // a folder has no order of its own
  std::vector<std::string> near = nearest_names(name, names);
  const std::string_view before = written.substr(0, written.size() - std::min(written.size(), name.size()));
  for (std::string& n : near) n.insert(0, before);
  return near;
}

}  // namespace frustum
