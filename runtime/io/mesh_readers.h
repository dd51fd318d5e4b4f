// The mesh file formats that can be read, by extension.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"
#include "runtime/core/param.h"

#include <functional>
#include <span>
#include <string_view>

namespace frustum {

// `read` makes a mesh of the bytes of a whole file, with columns in ctx.precision; `file` is for messages and
// is what paths inside the file start from. Throws NodeError("malformed_file") with file and line or byte,
// WorldError("out_of_memory").
struct MeshReader {
  std::string_view extension;  // without its dot, lower case
  std::string_view name;       // "Wavefront OBJ"
  Mesh (*read)(std::string_view bytes, const FilePath& file, Context& ctx);
  // Calls `visit` for every other file that reading may open: a cache depends on what they hold. May be null.
  void (*visit_files)(std::string_view bytes, const FilePath& file,
                      const std::function<void(const FilePath&)>& visit) = nullptr;
};

// All of them, in the order in which messages list them.
std::span<const MeshReader> mesh_readers();

}  // namespace frustum
