// The header of a PLY file: which elements there are, how many, and what each row of them holds.
#pragma once

#include "runtime/core/param.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::ply {

enum class Number : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
std::size_t bytes_of(Number);
inline bool is_real(Number n) { return n >= Number::f32; }

struct Property {
  std::string name;
  Number type = Number::f32;
  std::optional<Number> count = {};  // of a list: the type of its length
};

struct Element {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<Property> properties = {};

  std::optional<std::size_t> find(std::string_view property) const;
  bool has_lists() const;
  std::size_t least_bytes() const;  // of a row in a binary file: exact without lists
};

enum class Encoding : std::uint8_t { ascii, little_endian, big_endian };

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::size_t bytes = 0;              // of the header: where the body begins
  std::vector<std::string> textures;  // what comments say that name one: "TextureFile NAME"
  char line_end = '\n';               // the last byte of one; '\r' in files of old Macintoshes

  std::optional<std::size_t> find(std::string_view element) const;
};

// Lines end as the first one does: LF, CR LF or CR. Names of elements, and of the properties of one element,
// are unique. Counts are what the file claims, unchecked. Throws NodeError("malformed_file") with file:line.
Header read_header(std::string_view bytes, const FilePath& file);

}  // namespace frustum::ply
