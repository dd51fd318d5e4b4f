// Wavefront OBJ text, cut into chunks of lines that are parsed on all cores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum::obj {

constexpr std::int32_t absent = std::numeric_limits<std::int32_t>::min();

// One corner of a face: indices from 0 into the file's v, vt and vn; vt and vn may be absent.
struct Corner {
  std::int32_t v = absent, vt = absent, vn = absent;
};

// From this face of a chunk on, another usemtl, g or o.
struct FaceChange {
  enum Kind : std::uint8_t { material, group, object } kind;
  std::size_t face;
  std::string_view name;
};

// What some lines of a file say. R is float or double: each decimal is rounded once, to R.
template <class R>
struct Chunk {
  std::string_view text;              // whole lines
  std::vector<R> positions, normals;  // x y z ...
  std::vector<R> uvs;                 // u v ...
  std::vector<Corner> corners;        // of all faces, in order
  std::vector<std::uint32_t> sizes;   // corners of each face, at least 3
  std::vector<std::size_t>
      relative;  // 3 x corner + field: fields written as negative numbers, counted from this chunk's start
  std::vector<R> colors;            // r g b of each vertex, white where it has none; empty where none has
  std::vector<FaceChange> changes;  // in order
  std::vector<std::string_view> libraries;          // what mtllib names, a line each
  std::map<std::string_view, std::uint64_t> other;  // statements that say nothing about triangles, by keyword
  std::string error;                                // of the first line that is wrong, or empty
  std::size_t error_at = 0;                         // its byte in `text`
};

// Cuts the text at line ends (never inside a line continued by '\') into pieces of about `size` bytes.
std::vector<std::string_view> split_lines(std::string_view text, std::size_t size);

// Parses one piece. Stops at the first error.
template <class R>
void parse(std::string_view lines, Chunk<R>& out);

// The byte where the `face`-th face statement of these lines begins.
std::size_t find_face(std::string_view lines, std::size_t face);

}  // namespace frustum::obj
