#include "runtime/core/new_folders.h"

#include <limits.h>
#include <unistd.h>

#include <filesystem>

namespace frustum {

void NewFolders::above(const std::string& file) {
  if (file.size() >= PATH_MAX) return;  // the system makes none of these
  std::error_code none;
  auto folder = std::filesystem::path(file).parent_path();
  while (!folder.empty() && !folders_.contains(folder.string()) && !std::filesystem::exists(folder, none)) {
    folders_.insert(folder.string());
    folder = folder.parent_path();
  }
}

NewFolders::~NewFolders() {
  // A folder's name begins those of what is in it, so they come after it. Folders that hold something stay.
  for (auto folder = folders_.rbegin(); folder != folders_.rend(); ++folder) rmdir(folder->c_str());
}

}  // namespace frustum
