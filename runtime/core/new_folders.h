// Folders that were made for files which then were not.
#pragma once

#include <set>
#include <string>

namespace frustum {

// Remembers folders before they are made, and removes those that hold nothing at its end.
class NewFolders {
 public:
  NewFolders() = default;
  ~NewFolders();  // removes them, innermost first, unless keep() was called
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;

  void above(const std::string& file);  // those that lead to the file and are not there yet
  void keep() { folders_.clear(); }

 private:
  std::set<std::string> folders_;
};

}  // namespace frustum
