// Files that a file names beside itself.
#pragma once

#include "runtime/core/param.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace frustum {

// The file `name` (either kind of slash) seen from the folder of `from`; nothing where it is absolute, has a
// drive or climbs out of that folder.
inline std::optional<FilePath> near_path(const FilePath& from, std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '\\', '/');
  const std::filesystem::path path = std::filesystem::path(text).lexically_normal();
  const bool has_zero = text.find('\0') != std::string::npos;
  if (text.empty() || has_zero || path.is_absolute() || (text.size() > 1 && text[1] == ':') ||
      *path.begin() == "..")
    return {};
  const auto in_folder = [&](const std::string& of) {
    return (std::filesystem::path(of).parent_path() / path).string();
  };
  return FilePath{in_folder(from.written), in_folder(from.resolved)};
}

}  // namespace frustum
