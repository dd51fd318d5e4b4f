// Files of the application itself: where it is installed, small texts read and written whole.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// The whole content. Throws WorldError where it cannot be read.
std::string read_text(const std::filesystem::path& path);

// Writes to a temporary name beside it and renames, making folders as needed. Throws WorldError where it
// cannot.
void write_text(const std::filesystem::path& path, std::string_view text);

// Throws the WorldError that write_text would for this path, and leaves everything as it was: for results that are
// dear to make.
void require_writable(const std::filesystem::path& path);

// Like write_text, but a file that already says this is not touched. True where something was written.
bool write_if_changed(const std::filesystem::path& path, std::string_view text);

// The running program; empty where the system does not say.
std::filesystem::path executable_path();

// The nearest folder at or above `start` that is a frustum source tree (has graphs/lib and nodes).
std::optional<std::filesystem::path> source_root(const std::filesystem::path& start);

// Where "lib:name" looks for name.json, in order: $FRUSTUM_LIB (a list with ':'), the folder installed
// beside the executable (../share/frustum/graphs/lib), the source tree around the executable, the one
// around the graph.
std::vector<std::string> library_folders(const std::filesystem::path& graph);

// The files that match `pattern`, sorted; `*` stands for any characters within one name, in any part of
// the path. Without a `*`: the path itself, whether or not it exists.
std::vector<std::filesystem::path> matching_files(const std::filesystem::path& pattern);

}  // namespace frustum
