// Which reader a mesh file needs.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace frustum {

// The extension of a path in lower case without its dot; empty where there is none.
inline std::string extension_of(std::string_view path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string_view name = slash == std::string_view::npos ? path : path.substr(slash + 1);
  const std::size_t dot = name.find_last_of('.');
  std::string ext(dot == std::string_view::npos ? std::string_view{} : name.substr(dot + 1));
  std::transform(ext.begin(), ext.end(), ext.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return ext;
}

}  // namespace frustum
