// The files that a run can write, as far as a graph is checked against them before anything runs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// What a file of pixels can hold. Bits are a channel's; the first is the format's usual depth.
struct PictureFormat {
  std::string_view extension;
  std::vector<int> bits;
  std::vector<std::string> compressions;
  bool layers, quality = false;  // quality: its compression is "quality:N"
};

const std::vector<PictureFormat>& picture_formats();
const PictureFormat* find_picture_format(std::string_view extension);  // null where there is none

// The extension of a path in lower case without its dot.
std::string extension_of(const std::string& file);

}  // namespace frustum
