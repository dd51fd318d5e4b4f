#include "runtime/app/golden.h"

#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/core/error.h"
#include "runtime/core/version.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace frustum {
namespace fs = std::filesystem;
namespace {

constexpr const char* format = "frustum.golden/1";
constexpr const char* pixels_end = ".exr";
constexpr const char* values_end = ".values.json";

// The same numbers in a frame that has as many: rows of all samples in one sequence, sample by sample.
Raster restacked(const Raster& from, const Frame& frame) {
  Raster out(frame);
  const Rect &a = from.frame().window, &b = frame.window;
  const int rows = a.height() * from.frame().samples();
  const auto copy_plane = [&]<class T>(int plane, T) {
    for (int row = 0; row < rows && !a.empty(); ++row)
      std::copy_n(from.view().row<T>(plane, row / a.height(), a.y0 + row % a.height()), a.width(),
                  out.view().row<T>(plane, row / b.height(), b.y0 + row % b.height()));
  };
  for (std::size_t p = 0; p < frame.planes.size(); ++p) switch (frame.planes[p].kind) {
      case PlaneKind::f32: copy_plane(static_cast<int>(p), float{}); break;
      case PlaneKind::f64: copy_plane(static_cast<int>(p), double{}); break;
      case PlaneKind::u32: copy_plane(static_cast<int>(p), std::uint32_t{}); break;
    }
  return out;
}

// The book is a file that people edit: what it names is not trusted to be a name in this folder.
bool is_digest(const std::string& text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

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

bool GoldenBook::has_pixels(const Golden& golden) const {
  std::error_code none;
  return fs::exists(folder_ / (golden.digest + pixels_end), none);
}

bool GoldenBook::has_values(const Golden& golden) const {
  std::error_code none;
  return fs::exists(folder_ / (golden.digest + values_end), none);
}

Raster GoldenBook::pixels(const Golden& golden, const Frame& like) const {
  const Raster stored = load_raster((folder_ / (golden.digest + pixels_end)).string());
  Frame frame = stored.frame();
  frame.color_space = like.color_space, frame.alpha = like.alpha;
  if (like.pattern && frame.window.height() == like.window.height() * like.samples() &&
      frame.window.width() == like.window.width())
    frame.window = like.window, frame.pattern = like.pattern;
  return restacked(stored, frame);
}

void GoldenBook::save_pixels(const Raster& raster, const std::string& path) {
  Frame frame = raster.frame();
  frame.window.y1 = frame.window.y0 + frame.window.height() * frame.samples();
  frame.pattern = nullptr;
  save_raster(restacked(raster, frame), path);
}

Json GoldenBook::values(const Golden& golden) const {
  const fs::path path = folder_ / (golden.digest + values_end);
  Json values = Json::parse(read_text(path), nullptr, false);
  if (values.is_discarded())
    throw WorldError("bad_golden", fmt::format("{} is no JSON", path.generic_string()));
  return values;
}

void GoldenBook::accept(const std::string& key, const std::string& digest, const std::string& reason,
                        const fs::path& staged) {
  if (const auto old = entries_.find(key); old != entries_.end()) replaced_.insert(old->second.digest);
  entries_[key] = {digest, std::string(version), reason};
  changed_ = true;
  if (staged.empty()) return;
  const std::string name = staged.filename().string();
  fs::create_directories(folder_);
  fs::rename(staged, folder_ / (digest + name.substr(name.find('.'))));
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
    if (book.string().ends_with(values_end)) continue;
    const Json read = read_book(book);
    for (const auto& [key, entry] : read["entries"].items()) named.insert(entry.value("digest", ""));
  }
  for (const std::string& digest : replaced_)
    if (!named.contains(digest) && is_digest(digest))
      for (const char* end : {pixels_end, values_end}) fs::remove(folder_ / (digest + end));
  replaced_.clear();
}

}  // namespace frustum
