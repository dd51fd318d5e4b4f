// A new node type as source: algorithm, node, test and example graph, all of which work as they are.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

enum class NewNode { geometry, pixels };

// "clip.homogeneous" as "ClipHomogeneous", the name of its tests.
std::string pascal_name(std::string_view name);

struct ScaffoldFile {
  std::string path;  // relative to the root of the source tree
  std::string text;
};

// "" for a name such as "clip.homogeneous"; otherwise what is wrong with it.
std::string problem_of_node_name(std::string_view name);

// The files of a node type. The text depends on nothing but the arguments.
std::vector<ScaffoldFile> scaffold(std::string_view name, NewNode kind);

}  // namespace frustum
