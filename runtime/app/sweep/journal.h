// What a sweep has finished so far, one JSON object a line, so that a cut-off sweep goes on where it stopped.
#pragma once

#include "runtime/core/diagnostic.h"

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace frustum {

class SweepJournal {
 public:
  // Opens `file`, and holds its folder: throws NodeError("folder_in_use") where another sweep writes there now. With `resume` and a file of the same sweep, its entries are read, and a last line that was
  // cut off is dropped; otherwise the file begins anew. Throws NodeError("other_sweep") where `resume` meets
  // another sweep, WorldError("cannot_write_file").
  SweepJournal(std::filesystem::path file, const std::string& sweep, bool resume);
  ~SweepJournal();
  SweepJournal(const SweepJournal&) = delete;
  SweepJournal& operator=(const SweepJournal&) = delete;

  const std::vector<Json>& entries() const { return entries_; }

  // One line in one write: when it returns, the line survives the end of the program, and some seconds later that of
  // the machine (waiting for the disk at each line was 1.7 % of a sweep).
  void append(const Json& entry);

 private:
  // Held from its constructor to its destructor.
  class Folder {
   public:
    explicit Folder(const std::filesystem::path& file);
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

   private:
    int descriptor_ = -1;
  };

  std::filesystem::path file_;
  Folder folder_;
  std::vector<Json> entries_;
  int descriptor_ = -1;
  std::chrono::steady_clock::time_point synced_ = {};
};

}  // namespace frustum
