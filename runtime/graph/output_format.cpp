#include "runtime/graph/output_format.h"

#include <algorithm>
#include <filesystem>

namespace frustum {

const std::vector<PictureFormat>& picture_formats() {
  static const std::vector<std::string> tiff = {"none", "lzw", "zip", "packbits"};
  static const std::vector<PictureFormat> formats = {
      {"exr", {16, 32}, {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}, true},
      {"png", {8, 16}, {}, false},
      {"tif", {16, 8, 32}, tiff, false},
      {"tiff", {16, 8, 32}, tiff, false},
      {"hdr", {32}, {}, false},
      {"jpg", {8}, {}, false, true},
      {"jpeg", {8}, {}, false, true}};
  return formats;
}

const PictureFormat* find_picture_format(std::string_view extension) {
  const auto& all = picture_formats();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const PictureFormat& f) { return f.extension == extension; });
  return found == all.end() ? nullptr : &*found;
}

std::string extension_of(const std::string& file) {
  std::string out = std::filesystem::path(file).extension().string();
  if (!out.empty()) out.erase(0, 1);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

}  // namespace frustum
