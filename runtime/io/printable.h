// Pieces of a file inside a message.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace frustum {

// The first `most` bytes, with '?' for what is no ASCII character one can see.
inline std::string printable(std::string_view s, std::size_t most = 20) {
  std::string out(s.substr(0, most));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

}  // namespace frustum
