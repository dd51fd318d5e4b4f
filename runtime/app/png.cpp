#include "runtime/app/png.h"

#include "runtime/core/error.h"

#include <zlib.h>

#include <vector>

namespace frustum {
namespace {

void add_u32(std::string& out, std::uint32_t v) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(v >> shift & 0xFF);
}

// Length, name, data, and the checksum of the last two.
void add_chunk(std::string& out, const char* name, std::string_view data) {
  add_u32(out, static_cast<std::uint32_t>(data.size()));
  std::string body = name;
  body += data;
  out += body;
  add_u32(out, static_cast<std::uint32_t>(
                   crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()))));
}

std::string deflated(const std::vector<std::uint8_t>& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, bytes.data(), bytes.size(), 4) != Z_OK)
    throw WorldError("out_of_memory", "no memory left to compress a picture");
  out.resize(size);
  return out;
}

}  // namespace

std::string png_file(int width, int height, std::span<const std::uint8_t> rgb) {
  constexpr std::uint8_t minus_above = 2;
  const std::size_t row = 3 * static_cast<std::size_t>(width);
  std::vector<std::uint8_t> filtered;
  filtered.reserve((row + 1) * static_cast<std::size_t>(height));
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    filtered.push_back(minus_above);
    for (std::size_t i = 0; i < row; ++i)
      filtered.push_back(static_cast<std::uint8_t>(rgb[y * row + i] - (y > 0 ? rgb[(y - 1) * row + i] : 0)));
  }
  std::string header;
  add_u32(header, static_cast<std::uint32_t>(width));
  add_u32(header, static_cast<std::uint32_t>(height));
  header += {8, 2, 0, 0, 0};  // bits, RGB, deflate, filters by row, not interlaced
  std::string out = "\x89PNG\r\n\x1a\n";
  add_chunk(out, "IHDR", header);
  add_chunk(out, "sRGB", std::string(1, '\0'));  // perceptual intent
  add_chunk(out, "IDAT", deflated(filtered));
  add_chunk(out, "IEND", "");
  return out;
}

}  // namespace frustum
