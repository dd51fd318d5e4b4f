// The body of a PLY file: cut into pieces of whole rows, which are decoded on all cores.
#pragma once

#include "runtime/core/context.h"
#include "runtime/io/ply_header.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::ply {

// Some rows of one element and their bytes.
struct Piece {
  std::size_t element = 0;
  std::uint64_t first = 0, rows = 0;
  std::string_view bytes;
};

// What becomes of one property. R is float or double: each decimal is rounded once, to R.
template <class R>
struct Slot {
  enum class Use : std::uint8_t { skip, real, whole, indices, corner_uv };
  Use use = Use::skip;
  Number type = Number::f32;
  std::optional<Number> count = {};
  bool finite = false;  // real: NaN and infinity are an error
  R* real = nullptr;    // of row 0; row i is `stride` further
  std::uint32_t* whole = nullptr;
  std::size_t stride = 1;
};

// What the lists of a piece say, row after row. `index` -1 (a strip's end) is ~0.
template <class R>
struct Lists {
  std::vector<std::uint32_t> sizes, indices;
  std::vector<R> corner_uv;  // u v of each index, where the rows have them
  std::uint64_t odd_uv = 0;  // rows whose list of coordinates does not fit their indices: made 0, 0
  std::uint64_t row = 0;     // of the first error, in the element
  std::size_t byte = 0;      // of the first error, in the piece
  std::string error;         // or empty
};

// The pieces of the elements that are wanted, in order. Nothing is allocated for a row before its bytes are
// known to be there. `tail` becomes the number of bytes after the last row. Throws
// NodeError("malformed_file") where rows are missing or a list has a negative length.
std::vector<Piece> cut_rows(const Header& header, std::string_view file_bytes,
                            const std::vector<bool>& wanted, const FilePath& file, Context& ctx,
                            std::size_t& tail);

// Decodes one piece into the slots of its element, one a property; `limit` is what indices stay below
// (`breaks`: or are -1). Stops at the first error.
template <class R>
void decode(const Header& header, const Piece& piece, std::span<const Slot<R>> slots, std::uint64_t limit,
            bool breaks, Lists<R>& out);

}  // namespace frustum::ply
