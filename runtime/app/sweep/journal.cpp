#include "runtime/app/sweep/journal.h"

#include "runtime/app/files.h"
#include "runtime/core/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <cstring>

namespace frustum {
namespace {

constexpr const char* format = "frustum.sweep_journal/1";
constexpr std::chrono::seconds sync_interval{5};

[[noreturn]] void cannot_write(const std::filesystem::path& file) {
  throw WorldError("cannot_write_file",
                   fmt::format("cannot write {}: {}", file.string(), std::strerror(errno)));
}

// The whole lines that are JSON, up to the first that is not.
std::vector<Json> whole_lines(const std::string& text) {
  std::vector<Json> out;
  std::size_t begin = 0;
  for (auto end = text.find('\n'); end != std::string::npos; begin = end + 1, end = text.find('\n', begin)) {
    Json line = Json::parse(text.begin() + static_cast<std::ptrdiff_t>(begin),
                            text.begin() + static_cast<std::ptrdiff_t>(end), nullptr, false);
    if (line.is_discarded() || !line.is_object()) break;
    out.push_back(std::move(line));
  }
  return out;
}

}  // namespace

// A descriptor that keeps the folder of `file` as long as it is open, or until the program ends, however it does.
// Where the file system has no such locks, nothing is kept.
SweepJournal::Folder::Folder(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) cannot_write(file);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw NodeError(
      "folder_in_use",
      fmt::format("another sweep is writing to {}: choose another folder, or wait", folder.string()));
}
SweepJournal::Folder::~Folder() { ::close(descriptor_); }

SweepJournal::SweepJournal(std::filesystem::path file, const std::string& sweep, bool resume)
    : file_(std::move(file)), folder_(file_) {
  std::error_code none;
  if (resume && std::filesystem::is_regular_file(file_, none)) {
    entries_ = whole_lines(read_text(file_));
    if (entries_.empty() || entries_.front().value("format", "") != format ||
        entries_.front().value("sweep", "") != sweep)
      throw NodeError("other_sweep",
                      fmt::format("{} is of another sweep, graph or build: resume with the same arguments, "
                                  "choose another folder, or leave --resume out",
                                  file_.string()));
  }
  std::string text = Json{{"format", format}, {"sweep", sweep}}.dump() + "\n";
  for (std::size_t i = 1; i < entries_.size(); ++i) text += entries_[i].dump() + "\n";
  if (!entries_.empty()) entries_.erase(entries_.begin());
  write_text(file_, text);
  descriptor_ = ::open(file_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor_ < 0) cannot_write(file_);
}

SweepJournal::~SweepJournal() {
  if (descriptor_ < 0) return;
  ::fdatasync(descriptor_);
  ::close(descriptor_);
}

void SweepJournal::append(const Json& entry) {
  const std::string line = entry.dump() + "\n";
  if (::write(descriptor_, line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    cannot_write(file_);
  if (const auto now = std::chrono::steady_clock::now(); now - synced_ >= sync_interval) {
    if (::fdatasync(descriptor_) != 0) cannot_write(file_);
    synced_ = now;
  }
}

}  // namespace frustum
