#include "runtime/io/oiio/png_check.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum::oiio {
namespace {

constexpr std::string_view signature = "\x89PNG\r\n\x1a\n";
constexpr std::uint32_t header_bytes = 13, most_chunk_bytes = 0x7fffffff;
constexpr std::uint32_t most_pixels = 1000000;  // a side: libpng's limit unless it is told another

std::uint32_t number_at(const unsigned char* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

// Width, height, then depth, colour type, compression, filter and interlace, a byte each.
std::string header_fault(const unsigned char* h) {
  const std::uint32_t width = number_at(h), height = number_at(h + 4);
  if (width == 0 || height == 0) return "the picture has no pixels";
  if (width > most_pixels || height > most_pixels)
    return fmt::format("{} x {} pixels; {} a side is the most that is read", width, height, most_pixels);
  const int depth = h[8], color = h[9];
  const bool depth_is_power = depth == 1 || depth == 2 || depth == 4 || depth == 8 || depth == 16;
  const bool grey = color == 0, palette = color == 3, other = color == 2 || color == 4 || color == 6;
  if (!depth_is_power || !(grey || (palette && depth <= 8) || (other && depth >= 8)))
    return fmt::format("there are no PNGs of colour type {} with {} bits", color, depth);
  if (h[10] != 0 || h[11] != 0 || h[12] > 1) return "its compression, filter or interlacing is unknown";
  return "";
}

class Chunks {
 public:
  Chunks(std::uint64_t size, const ReadBytes& read) : read_(read), size_(size) {}

  std::string fault() {
    for (at_ = signature.size(); at_ < size_;) {
      if (std::string why = next(); !why.empty()) return why;
      if (type_ == "IEND") return "";
    }
    return fmt::format("it is cut off after {} bytes", size_);
  }

 private:
  std::string next() {
    std::array<unsigned char, 8> begin{};
    if (!read(begin.data(), begin.size())) return cut_off();
    const std::uint32_t bytes = number_at(begin.data());
    type_.assign(begin.begin() + 4, begin.end());
    if (!std::all_of(type_.begin(), type_.end(), [](unsigned char c) { return std::isalpha(c) != 0; }))
      return fmt::format("byte {}: this is no chunk", at_ - 4);
    if (bytes > most_chunk_bytes) return fmt::format("byte {}: a chunk of {} bytes", at_ - 8, bytes);
    if (const char* why = out_of_place(bytes); why != nullptr) return fmt::format("chunk {}: {}", type_, why);
    std::uint32_t sum = static_cast<std::uint32_t>(crc32(0, begin.data() + 4, 4));
    for (std::uint32_t left = bytes; left > 0;) {
      const auto n = std::min<std::uint32_t>(left, block_bytes);
      if (!read(block_.data(), n)) return cut_off();
      sum = static_cast<std::uint32_t>(crc32(sum, block_.data(), n));
      left -= n;
    }
    std::array<unsigned char, 4> end{};
    if (!read(end.data(), end.size())) return cut_off();
    if (number_at(end.data()) != sum)
      return fmt::format("chunk {}: its bytes do not give its checksum", type_);
    if (type_ != "IHDR") return "";
    numbers_colors_ = block_[9] == 3;
    return header_fault(block_.data());
  }

  // Why chunk type_ of so many bytes may not be here, or null. IHDR comes first, then a palette where pixels
  // are numbers of its colours, then the pixels in one go, and IEND.
  const char* out_of_place(std::uint32_t bytes) {
    const bool first = !std::exchange(begun_, true), pixels = type_ == "IDAT";
    if (first && type_ != "IHDR") return "IHDR comes before it";
    if (first) return bytes == header_bytes ? nullptr : "it is not 13 bytes long";
    if (type_ == "IHDR") return "there is one already";
    if (pixels && numbers_colors_ && !palette_) return "PLTE comes before it";
    if (pixels && after_pixels_) return "another chunk has come between";
    if (type_ == "IEND" && !pixels_) return "IDAT comes before it";
    palette_ |= type_ == "PLTE", pixels_ |= pixels, after_pixels_ = pixels_ && !pixels;
    return nullptr;
  }

  bool read(unsigned char* to, std::size_t n) {
    if (size_ - at_ < n || read_(to, n) != n) return false;
    at_ += n;
    return true;
  }
  std::string cut_off() const { return fmt::format("it is cut off after {} bytes", size_); }

  static constexpr std::uint32_t block_bytes = 1 << 16;
  const ReadBytes& read_;
  std::uint64_t size_, at_ = 0;
  std::string type_;
  bool begun_ = false, numbers_colors_ = false, palette_ = false, pixels_ = false, after_pixels_ = false;
  std::vector<unsigned char> block_ = std::vector<unsigned char>(block_bytes);
};

}  // namespace

std::string png_fault(std::uint64_t size, const ReadBytes& read) {
  std::array<char, signature.size()> begin{};
  const std::size_t n = read(begin.data(), begin.size());
  return std::string_view(begin.data(), n) == signature ? Chunks(size, read).fault() : "";
}

}  // namespace frustum::oiio
