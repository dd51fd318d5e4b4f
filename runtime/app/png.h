// Small pictures as PNG, without the library that reads and writes all formats: loading that takes longer than a
// sweep's judging of ten settings.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace frustum {

// A PNG file of 8-bit RGB marked as sRGB, by libpng.
//   rgb  height rows of width pixels of 3 bytes; both sizes from 1 to 2^15
// Throws WorldError where no memory is left. Cost: linear.
std::string png_file(int width, int height, std::span<const std::uint8_t> rgb);

}  // namespace frustum
