// The tokens of OBJ and MTL text.
#pragma once

#include "runtime/io/decimal.h"
#include "runtime/io/printable.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace frustum::obj {

inline bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

// Reads tokens of one line after another; a '\' before a line end continues the line.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : begin_(text.data()), at_(begin_), end_(begin_ + text.size()) {}

  bool done() const { return at_ == end_; }
  bool line_done() const { return at_ == end_ || *at_ == '\n' || *at_ == '#'; }
  std::size_t offset() const { return static_cast<std::size_t>(at_ - begin_); }

  void skip_blanks() {
    for (; at_ != end_; ++at_) {
      if (blank(*at_)) continue;
      if (*at_ != '\\') return;
      const char* next = at_ + 1;
      if (next != end_ && *next == '\r') ++next;
      if (next == end_ || *next != '\n') return;
      at_ = next;
    }
  }
  void skip_line() {
    while (at_ != end_) {
      const auto* eol =
          static_cast<const char*>(std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_)));
      if (eol == nullptr) {
        at_ = end_;
        return;
      }
      const bool continued = continues(at_, eol);
      at_ = eol + 1;
      if (!continued) return;
    }
  }
  static bool continues(const char* begin, const char* eol) {
    if (eol != begin && eol[-1] == '\r') --eol;
    return eol != begin && eol[-1] == '\\';
  }
  std::string_view word() {
    const char* start = at_;
    while (at_ != end_ && !blank(*at_) && *at_ != '\n') ++at_;
    return {start, static_cast<std::size_t>(at_ - start)};
  }
  std::string_view rest_of_line() {
    const char* start = at_;
    while (at_ != end_ && *at_ != '\n') ++at_;
    const char* stop = at_;
    while (stop != start && blank(stop[-1])) --stop;
    return {start, static_cast<std::size_t>(stop - start)};
  }
  bool take(char c) {
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }
  // A number that ends at a blank or line end; nothing where there is none, or where it is not finite in R.
  template <class R>
  std::optional<R> number() {
    skip_blanks();
    R value{};
    const char* stop = read_decimal(at_, end_, value);
    if (stop == nullptr || !std::isfinite(value)) return {};
    if (stop != end_ && !blank(*stop) && *stop != '\n' && *stop != '\\') return {};
    at_ = stop;
    return value;
  }
  // A whole number other than zero, of at most nine digits.
  std::optional<std::int32_t> index() {
    const bool negative = take('-');
    const char* start = at_;
    std::int32_t value = 0;
    while (at_ != end_ && *at_ >= '0' && *at_ <= '9' && at_ - start < 10)
      value = static_cast<std::int32_t>(value * 10L + (*at_++ - '0'));
    if (at_ == start || at_ - start > 9 || value == 0) return {};
    return negative ? -value : value;
  }

 private:
  const char *begin_, *at_, *end_;
};

// Why a word is no number of R: it is none, or infinite, or R ends before it.
template <class R>
std::string no_number(std::string_view word) {
  return is_beyond<R>(word) ? fmt::format("'{}' is beyond {}", printable(word), precision_name<R>())
                            : fmt::format("'{}' is not a finite number", printable(word));
}

}  // namespace frustum::obj
