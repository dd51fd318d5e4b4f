// What an image file will hold: decided before any library is asked.
#pragma once

#include "runtime/core/sink.h"

#include <string>
#include <string_view>
#include <vector>

namespace frustum {

struct SinkChannel {
  enum class Type : std::uint8_t { u8, u16, half, f32, u32 };
  std::string name;  // in the file
  int layer = 0, plane = 0;
  Type type = Type::u8;
};

struct SinkPlan {
  std::string format;  // "png", "exr", "tiff", "jpeg", "hdr"
  std::vector<SinkChannel> channels;
  int alpha = -1;           // the channel that is alpha, or -1
  int lost_alpha = -1;      // the plane of alpha for which the format has no channel, or -1
  bool straighten = false;  // premultiplied colours are divided by alpha
  bool windows = false;     // the format knows data and display windows
  std::string compression;  // empty: the format's usual one
};

// Throws NodeError as open_image_sink says.
SinkPlan plan_sink(const SinkRequest&);

std::string_view format_of_extension(
    std::string_view path);  // "tiff" of "a.TIF"; empty for one that is not written

}  // namespace frustum
