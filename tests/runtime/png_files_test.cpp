// PNG files that are cut off, damaged or made to lie: one message each, and no word of libpng on stderr.
#include "runtime/core/error.h"
#include "runtime/io/image_files.h"
#include "tests/support/temp_file.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace frustum {
namespace {

using namespace std::string_literals;

std::string number(std::uint32_t v) {
  return {static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8),
          static_cast<char>(v)};
}

// With its right checksum.
std::string chunk(const std::string& type, const std::string& data) {
  std::uint32_t sum = 0xffffffff;
  for (const char c : type + data) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ ((sum & 1) != 0 ? 0xedb88320 : 0);
  }
  return number(static_cast<std::uint32_t>(data.size())) + type + data + number(~sum);
}

// Bytes as one block of a zlib stream that is not compressed.
std::string stored(const std::string& data) {
  std::uint32_t a = 1, b = 0;
  for (const char c : data) a = (a + static_cast<unsigned char>(c)) % 65521, b = (b + a) % 65521;
  const auto n = static_cast<std::uint16_t>(data.size());
  const auto little = [](std::uint16_t v) {
    return std::string{static_cast<char>(v), static_cast<char>(v >> 8)};
  };
  return "\x78\x01\x01"s + little(n) + little(static_cast<std::uint16_t>(~n)) + data + number(b << 16 | a);
}

const std::string begin = "\x89PNG\r\n\x1a\n", end = chunk("IEND", "");
const std::string header = number(7) + number(5) + "\x08\x00\x00\x00\x00"s;        // 7 x 5, 8 bits, grey
const std::string pixels = chunk("IDAT", stored(std::string(5 * (1 + 7), '\0')));  // rows without a filter
const std::string whole = begin + chunk("IHDR", header) + chunk("tEXt", "Software\0x"s) + pixels + end;

std::string error_of(const std::string& bytes) {
  testing::internal::CaptureStderr();
  std::string message;
  try {
    read_image_bytes(bytes, "p");
  } catch (const NodeError& e) {
    message = e.code + ": " + e.what();
  }
  return message + testing::internal::GetCapturedStderr();
}

bool is_one_message(const std::string& text) {
  return text.starts_with("malformed_file: p: ") && text.find('\n') == std::string::npos &&
         text.find("libpng") == std::string::npos;
}

TEST(PngFiles, ThatAreWholeAreRead) {
  EXPECT_EQ(error_of(whole), "");
  EXPECT_EQ(read_image_bytes(whole, "p").raster.frame().window, (Rect{0, 0, 7, 5}));
  EXPECT_EQ(error_of(whole + "what follows the end is not the picture's"), "");
}

TEST(PngFiles, ThatAreCutOffOrDamagedAreSaidInOneMessage) {
  for (std::size_t n = 8; n < whole.size(); ++n)
    EXPECT_EQ(error_of(whole.substr(0, n)),
              "malformed_file: p: it is cut off after " + std::to_string(n) + " bytes");
  for (std::size_t i = 8; i < whole.size(); ++i)
    for (const int bit : {0, 5, 7}) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(damaged[i] ^ 1 << bit);
      EXPECT_PRED1(is_one_message, error_of(damaged)) << "byte " << i << ", bit " << bit;
    }
}

TEST(PngFiles, OnDiskAreCheckedToo) {
  const test::TempFolder folder;
  const std::string cut = folder.write("cut.png", whole.substr(0, 60));
  testing::internal::CaptureStderr();
  EXPECT_THROW(read_image(cut, "cut.png"), NodeError);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(PngFiles, ThatLieAreSaidInOneMessage) {
  const auto with = [](std::size_t at, char value) {
    std::string h = header;
    h[at] = value;
    return begin + chunk("IHDR", h) + pixels + end;
  };
  const std::string first = begin + chunk("IHDR", header);
  const std::vector<std::pair<std::string, std::string>> lies{
      {begin + end, "chunk IEND: IHDR comes before it"},
      {begin + pixels + end, "chunk IDAT: IHDR comes before it"},
      {begin + chunk("IHDR", header + "\0"s) + pixels + end, "chunk IHDR: it is not 13 bytes long"},
      {first + chunk("IHDR", header) + pixels + end, "chunk IHDR: there is one already"},
      {first + end, "chunk IEND: IDAT comes before it"},
      {first + pixels + chunk("tEXt", "a\0b"s) + pixels + end, "chunk IDAT: another chunk has come between"},
      {first + chunk("a\0bc"s, "") + pixels + end, "byte 37: this is no chunk"},
      {first + "\xff\xff\xff\xffIDAT" + end, "byte 33: a chunk of 4294967295 bytes"},
      {with(3, 0), "the picture has no pixels"},
      {with(0, 1), "16777223 x 5 pixels; 1000000 a side is the most that is read"},
      {with(8, 3), "there are no PNGs of colour type 0 with 3 bits"},
      {with(9, 3), "chunk IDAT: PLTE comes before it"},
      {with(9, 7), "there are no PNGs of colour type 7 with 8 bits"},
      {with(10, 1), "its compression, filter or interlacing is unknown"},
      {with(11, 1), "its compression, filter or interlacing is unknown"},
      {with(12, 2), "its compression, filter or interlacing is unknown"}};
  for (const auto& [bytes, message] : lies) EXPECT_EQ(error_of(bytes), "malformed_file: p: " + message);
}

}  // namespace
}  // namespace frustum
