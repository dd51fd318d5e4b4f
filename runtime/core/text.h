// Numbers as people write and read them.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// "512", "512K", "1.5G" (powers of 1024, case does not matter, a trailing B is allowed) as bytes; null
// where the text is no size, is negative, or does not fit.
std::optional<std::uint64_t> parse_bytes(std::string_view text);

std::string human_bytes(std::uint64_t bytes);           // "1.5 GiB"
std::string human_time(std::chrono::nanoseconds time);  // "812 us", "3.21 s", "2 min 05 s"

// Rows as aligned columns, two spaces apart; the last column is not padded. `indent` spaces before each row.
std::string aligned(const std::vector<std::vector<std::string>>& rows, int indent = 0);

// Breaks at spaces so that no line is longer than `width`, each line after the first indented.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent);

}  // namespace frustum
