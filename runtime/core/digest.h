// 128-bit content hashes (XXH3), for cache keys and goldens. Not cryptographic.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace frustum {

struct Digest {
  std::uint64_t high = 0, low = 0;
  auto operator<=>(const Digest&) const = default;
};

std::string to_hex(const Digest&);  // 32 lower-case digits

// Digest of a sequence of values. Every text and span is prefixed by its length, so that ("ab","c") and ("a","bc") differ.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(Hasher&&) noexcept;
  Hasher& operator=(Hasher&&) noexcept;

  Hasher& bytes(const void* data, std::size_t size);
  Hasher& text(std::string_view s);
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) Hasher& value(T v) { return bytes(&v, sizeof v); }
  Hasher& value(const Digest& d) { return value(d.high).value(d.low); }
  template <class T>
  requires std::is_trivially_copyable_v<T> Hasher& span(std::span<const T> values) {
    return value(values.size()).bytes(values.data(), values.size_bytes());
  }
  Digest done() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace frustum
