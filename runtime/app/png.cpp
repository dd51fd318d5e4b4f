#include "runtime/app/png.h"

#include "runtime/core/error.h"

#include <fmt/format.h>
#include <png.h>

namespace frustum {

std::string png_file(int width, int height, std::span<const std::uint8_t> rgb) {
  png_image picture{};
  picture.version = PNG_IMAGE_VERSION;
  picture.width = static_cast<png_uint_32>(width), picture.height = static_cast<png_uint_32>(height);
  picture.format = PNG_FORMAT_RGB;
  picture.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(picture);
  std::string out(size, '\0');
  if (png_image_write_to_memory(&picture, out.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
    throw WorldError("out_of_memory", fmt::format("no picture could be made: {}", picture.message));
  out.resize(size);
  return out;
}

}  // namespace frustum
