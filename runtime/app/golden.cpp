#include "runtime/app/golden.h"

#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/core/error.h"
#include "runtime/core/version.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <set>

namespace frustum {
namespace fs = std::filesystem;
namespace {

constexpr const char* format = "frustum.golden/1";

Json read_book(const fs::path& path) {
  Json book = Json::parse(read_text(path), nullptr, false);
  if (!book.is_object() || book.value("format", "") != format || !book.contains("entries") ||
      !book["entries"].is_object())
    throw WorldError("bad_golden", fmt::format("{} is no book of accepted results", path.generic_string()));
  return book;
}

}  // namespace

GoldenBook::GoldenBook(fs::path folder, std::string name)
    : folder_(std::move(folder)), name_(std::move(name)) {
  const fs::path path = folder_ / (name_ + ".json");
  std::error_code none;
  if (!fs::exists(path, none)) return;
  const Json book = read_book(path);
  for (const auto& [key, entry] : book["entries"].items())
    entries_[key] = {entry.value("digest", ""), entry.value("version", ""), entry.value("reason", "")};
}

const Golden* GoldenBook::find(std::string_view key) const {
  const auto found = entries_.find(key);
  return found != entries_.end() ? &found->second : nullptr;
}

Raster GoldenBook::pixels(const Golden& golden) const {
  return load_raster((folder_ / (golden.digest + ".exr")).string());
}

void GoldenBook::accept(const std::string& key, const Buffer& buffer, const std::string& reason) {
  const std::string digest = to_hex(buffer.digest());
  entries_[key] = {digest, std::string(version), reason};
  changed_ = true;
  if (!buffer.type().is_pixels()) return;
  const Raster& raster = buffer.type().raster(buffer.data());
  if (raster.frame().pattern) return;  // many samples: judged by digest alone
  fs::create_directories(folder_);
  save_raster(raster, (folder_ / (digest + ".exr")).string());
}

void GoldenBook::save() {
  if (!changed_) return;
  Json entries = Json::object();
  for (const auto& [key, g] : entries_)
    entries[key] = {{"digest", g.digest}, {"version", g.version}, {"reason", g.reason}};
  write_text(folder_ / (name_ + ".json"), Json{{"format", format}, {"entries", entries}}.dump(2) + "\n");
  changed_ = false;

  std::set<std::string> named;
  for (const fs::path& book : matching_files(folder_ / "*.json")) {
    const Json read = read_book(book);
    for (const auto& [key, entry] : read["entries"].items()) named.insert(entry.value("digest", ""));
  }
  for (const fs::path& stored : matching_files(folder_ / "*.exr"))
    if (!named.contains(stored.stem().string())) fs::remove(stored);
}

}  // namespace frustum
