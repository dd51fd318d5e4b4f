// Decimal numbers in the texts of mesh files, read alike in every locale.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <system_error>

namespace frustum {

// Whether a decimal that overflows or underflows is the former: by the place of its first digit other than 0.
inline bool is_large_decimal(std::string_view text) {
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  const std::string_view mantissa = text.substr(0, e);
  const std::size_t digit = std::min(mantissa.find_first_of("123456789"), mantissa.size());
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const auto place = static_cast<long long>(point) - static_cast<long long>(digit);
  long long power = 0;
  std::string_view exponent = text.substr(std::min(e + 1, text.size()));
  if (exponent.starts_with('+')) exponent.remove_prefix(1);
  if (std::from_chars(exponent.data(), exponent.data() + exponent.size(), power).ec ==
      std::errc::result_out_of_range)
    return !exponent.starts_with('-');
  return power > -place;
}

// The number at `at` (a '+' may stand before it), rounded once to R: infinity and NaN where the text says so
// or it is too large, zero where it is too small. Returns the end of the number; null where there is none.
template <class R>
const char* read_decimal(const char* at, const char* end, R& value) {
  if (at != end && *at == '+') ++at;
  const auto [stop, error] = std::from_chars(at, end, value);
  if (error == std::errc::result_out_of_range) {
    const std::string_view text(at, static_cast<std::size_t>(stop - at));
    value = is_large_decimal(text) ? std::numeric_limits<R>::infinity() : R{0};
    if (text.starts_with('-')) value = -value;
    return stop;
  }
  return error == std::errc() ? stop : nullptr;
}

// Whether a text that read_decimal() reads as infinite is a finite number, and R ends before it.
template <class R>
bool is_beyond(std::string_view text) {
  R value{};
  const char* stop = read_decimal(text.data(), text.data() + text.size(), value);
  return stop == text.data() + text.size() && std::isinf(value) &&
         text.find_first_of("0123456789") != std::string_view::npos;
}
// "single precision", for sentences.
template <class R>
constexpr std::string_view precision_name() {
  return sizeof(R) == sizeof(float) ? "single precision" : "double precision";
}

}  // namespace frustum
