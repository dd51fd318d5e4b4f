// Accepted results: one book per suite that names the digest of each, and for pixels a file to measure
// against.
#pragma once

#include "runtime/core/buffer.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

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

  const Golden* find(std::string_view key) const;
  // The stored pixels of an entry, as floats; throws WorldError where the file is missing.
  Raster pixels(const Golden& golden) const;

  // Records `buffer` under `key`; pixels with one value each are also stored, as FOLDER/DIGEST.exr.
  void accept(const std::string& key, const Buffer& buffer, const std::string& reason);
  // Writes the book where something was accepted, and removes stored pixels that no book of the folder
  // names any more.
  void save();

 private:
  std::filesystem::path folder_;
  std::string name_;
  std::map<std::string, Golden, std::less<>> entries_;
  bool changed_ = false;
};

}  // namespace frustum
