// A buffer as bytes and back, for the cache on disk. Numbers lie as the processor has them: the cache's key names the build,
// and its files say at the front whether this program can read them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace frustum {

// The bytes are not those of such a value: a count beyond the end, a choice that does not exist.
struct ArchiveError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class ArchiveWriter {
 public:
  virtual ~ArchiveWriter() = default;
  virtual void raw(const void* data, std::size_t bytes) = 0;
  // Storage that several buffers may share (a column's): written once however many of them are.
  virtual void shared(const std::shared_ptr<const void>& storage, std::size_t bytes) = 0;

  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) ArchiveWriter& value(T v) {
    raw(&v, sizeof v);
    return *this;
  }
  ArchiveWriter& text(std::string_view s) {
    value(std::uint64_t{s.size()});
    raw(s.data(), s.size());
    return *this;
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> ArchiveWriter& span(std::span<const T> values) {
    value(std::uint64_t{values.size()});
    raw(values.data(), values.size_bytes());
    return *this;
  }
};

// Every read throws ArchiveError where the bytes end first, before anything of that size is allocated.
class ArchiveReader {
 public:
  virtual ~ArchiveReader() = default;
  virtual void raw(void* to, std::size_t bytes) = 0;
  virtual std::size_t left() const = 0;
  // What ArchiveWriter::shared was given, on a 64-byte boundary; the same storage for every buffer that shares it.
  virtual std::shared_ptr<void> shared(std::size_t bytes) = 0;

  template <class T>
  requires(std::is_arithmetic_v<T>) T value() {
    T v{};
    raw(&v, sizeof v);
    return v;
  }
  bool flag() { return choice<std::uint8_t>(1) != 0; }
  // An enumeration whose values are 0 to `last`.
  template <class E>
  E choice(E last) {
    E v{};
    raw(&v, sizeof v);
    if (v > last) throw ArchiveError("a choice that does not exist");
    return v;
  }
  // A count of things that take at least `bytes_each` bytes each.
  std::size_t count(std::size_t bytes_each) {
    const auto n = value<std::uint64_t>();
    if (n > left() / bytes_each) throw ArchiveError("a count beyond the end");
    return static_cast<std::size_t>(n);
  }
  std::string text() {
    std::string s(count(1), '\0');
    raw(s.data(), s.size());
    return s;
  }
  template <class T>
  requires std::is_trivially_copyable_v<T> std::vector<T> vector() {
    std::vector<T> v(count(sizeof(T)));
    raw(v.data(), v.size() * sizeof(T));
    return v;
  }
};

}  // namespace frustum
