// Attributes of vertices that glTF leaves to applications (glTF 2.0, 3.7.2.1): names that begin with '_'.
#pragma once

#include "runtime/io/column_names.h"

#include <string>
#include <string_view>

namespace frustum::gltf {

// "_QUALITY" for column "quality".
inline std::string attribute_of(std::string_view column) {
  std::string name = "_";
  for (const char c : column)
    name += c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c <= ' ' || c > '~' ? '_' : c;
  return name;
}

// "quality" for "_QUALITY", and "gltf_w" for "_W", since "w" has a meaning here; empty for what is none.
inline std::string column_of(std::string_view attribute) {
  if (attribute.size() < 2 || attribute[0] != '_') return {};
  std::string name;
  for (const char c : attribute.substr(1)) name += c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return has_meaning(name) || name == "transparency" ? "gltf_" + name : name;
}

}  // namespace frustum::gltf
