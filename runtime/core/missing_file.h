// Files that the user names and that are not there: a mistake of what was written, where a file that is there and cannot be
// read is the world's failure.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// Why no file can be read at `path`, whatever the rights: "there is no file 'teapto.obj'", "'data' is a folder, not a file",
// "'pipe' is not a regular file". `written` is its name in the sentence. Empty where a regular file stands there, and where
// the system does not tell: reading finds out why. Cost: one look at the path.
std::string why_missing(const std::string& path, std::string_view written);

// Problems after which nobody looks for near files any more: a hostile graph may name a hundred thousand.
constexpr std::size_t most_looked_beside = 100;

// Files beside `path` whose names are near, as whoever wrote `written` would name them: nearest first, three at most. Looks at
// a thousand names at most.
std::vector<std::string> near_files(const std::string& path, std::string_view written);

}  // namespace frustum
