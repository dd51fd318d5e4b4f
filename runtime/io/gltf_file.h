// The two containers of glTF: a JSON text, or GLB with a JSON and a binary chunk.
#pragma once

#include "runtime/io/gltf_json.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace frustum::gltf {

struct File {
  std::shared_ptr<const Tree> json;
  std::optional<std::string_view> binary;  // of a GLB that has it; a part of the bytes
};

// Opens either container, told apart by content. Throws NodeError("malformed_file") with line and column of a
// JSON fault or the chunk of a GLB, NodeError("unsupported_version") for glTF 1 and for versions after 2, and
// NodeError("unsupported_extension") for a file that requires what is not read, by name.
File open(std::string_view bytes, const FilePath& file);

// The files beside it that a glTF file names; empty for what is no glTF file, or is malformed.
std::vector<FilePath> files_beside(const FilePath& file);

}  // namespace frustum::gltf
