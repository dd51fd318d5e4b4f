// glTF 2.0 and GLB. Source: Khronos, glTF 2.0 specification, ISO/IEC 12113:2022.
#pragma once

#include "runtime/buffers/camera.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"
#include "runtime/core/param.h"

#include <string>
#include <string_view>
#include <vector>

namespace frustum {

class NodeType;

// A scene with everything in world space.
struct GltfScene {
  struct View {
    std::string node, name;  // what the file calls the camera's node and the camera; may be empty
    Camera camera;           // with the default resolution
  };
  Mesh mesh;
  std::vector<View> views;
  LightSet lights;
};

// All triangles of the default scene as one mesh: every instance of every mesh, in the order of the node tree
// (parents first) and of the primitives, at its place. Columns in ctx.precision:
//   position, triangle (strips and fans become lists; mirrored instances are turned, so that fronts stay
//   fronts), normal (by the transposed inverse; where a primitive has none, of its faces, as the format asks,
//   and then the column is one of corners), uv, uv1 ... (v up: 1 - the file's), color, material;
//   attributes of applications as columns of their names in lower case ("quality" for _QUALITY, with "gltf_" before it
//   where the name has a meaning here), 0 where a primitive has none.
// Positions that no face names stay. Faces without a material have the usual one; materials are those that
// faces have; column transparency where one blends (runtime/io/gltf_material.h). Points and lines, tangents, skins, morph targets and animations are left out, and said so once.
//
// `textures`: whether pictures are read. Throws NodeError("malformed_file", "unsupported_version",
// "unsupported_extension", "unsafe_path", "missing_file", "too_large") and WorldError("cannot_read_file", "out_of_memory")
// naming file and element ("box.gltf: accessors[3]: ..."): for indices and byte ranges out of range,
// positions that are not finite, node cycles. Memory: at most 64 MB and 256 times the bytes of the files, so that a
// small file cannot ask for much by naming the same data often. Cost: that of copying the columns.
GltfScene read_gltf(std::string_view bytes, const FilePath& file, bool textures, Context& ctx);

// The mesh alone, in object space: for the table of mesh formats.
Mesh read_gltf_mesh(std::string_view bytes, const FilePath& file, Context& ctx);

// A cache key of a node that reads glTF also depends on the files that its file names.
void depend_on_files_beside(NodeType&);

}  // namespace frustum
