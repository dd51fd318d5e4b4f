// Accepted results: one book per suite that names the digest of each, and for what is compared with a
// tolerance a file to measure against.
#pragma once

#include "runtime/core/buffer.h"

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

struct Golden {
  std::string digest;   // of the buffer, 32 hexadecimal digits
  std::string version;  // of the frustum that made it
  std::string reason;   // what --accept was told
};

class GoldenBook {
 public:
  // The book FOLDER/NAME.json; a missing one is empty. Throws WorldError where it cannot be read or is no
  // book.
  GoldenBook(std::filesystem::path folder, std::string name);

  const std::filesystem::path& folder() const { return folder_; }
  const Golden* find(std::string_view key) const;

  // FOLDER/DIGEST.exr: pixels as floats and ids, several samples of a pixel below each other. They are read
  // back with the samples, colour space and alpha of `like`, where the size fits. Throws WorldError where
  // the file cannot be read.
  bool has_pixels(const Golden& golden) const;
  Raster pixels(const Golden& golden, const Frame& like) const;
  static void save_pixels(const Raster& raster, const std::string& path);
  // FOLDER/DIGEST.values.json: the numbers of anything else.
  bool has_values(const Golden& golden) const;
  Json values(const Golden& golden) const;

  // Records a digest under `key`, with this version; `staged` (may be empty) is the file with its numbers,
  // which becomes FOLDER/DIGEST with the same extension.
  void accept(const std::string& key, const std::string& digest, const std::string& reason,
              const std::filesystem::path& staged);
  // Writes the book where something was accepted, and removes the stored numbers that it replaced and no book
  // of the folder names any more; other files of the folder are left alone.
  void save();

 private:
  std::filesystem::path folder_;
  std::string name_;
  std::map<std::string, Golden, std::less<>> entries_;
  std::set<std::string> replaced_;  // digests that entries had before
  bool changed_ = false;
};

}  // namespace frustum
