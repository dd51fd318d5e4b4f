// Numbers as a binary PLY file stores them.
#pragma once

#include "runtime/io/ply_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace frustum::ply {

inline bool swaps(Encoding e) {
  return (e == Encoding::big_endian) != (std::endian::native == std::endian::big);
}

template <class T>
T stored(const char* from, bool swap) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

// Calls f with the number, in its own type.
template <class F>
auto with_stored(const char* from, Number type, bool swap, F&& f) {
  switch (type) {
    case Number::i8: return f(stored<std::int8_t>(from, swap));
    case Number::u8: return f(stored<std::uint8_t>(from, swap));
    case Number::i16: return f(stored<std::int16_t>(from, swap));
    case Number::u16: return f(stored<std::uint16_t>(from, swap));
    case Number::i32: return f(stored<std::int32_t>(from, swap));
    case Number::u32: return f(stored<std::uint32_t>(from, swap));
    case Number::f32: return f(stored<float>(from, swap));
    case Number::f64: break;
  }
  return f(stored<double>(from, swap));
}

// A number of whole type.
inline std::int64_t stored_whole(const char* from, Number type, bool swap) {
  return with_stored(from, type, swap, [](auto v) { return static_cast<std::int64_t>(v); });
}

}  // namespace frustum::ply
