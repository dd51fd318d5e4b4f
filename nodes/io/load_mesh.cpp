#include "nodes/io/load_mesh.h"

#include "nodes/io.h"
#include "runtime/core/node_type.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/gltf.h"
#include "runtime/io/mesh_readers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  FilePath file;
};
struct Outputs {
  Ref<Mesh> mesh;
};

const MeshReader& reader_of(const FilePath& file) {
  const std::string kind = extension_of(file.written);
  std::vector<std::string> known;
  for (const MeshReader& reader : mesh_readers()) {
    if (reader.extension == kind) return reader;
    known.push_back(fmt::format(".{}", reader.extension));
  }
  throw NodeError(
      "unknown_format",
      fmt::format("{}: meshes are read from {} files, and this {}", file.written, fmt::join(known, ", "),
                  kind.empty() ? "name has no ending" : fmt::format("is a .{}", kind)),
      at_param("file"));
}

// What the mesh file names beside itself is part of what the result depends on.
void depend_on_named_files(NodeType& type) {
  type.params.files = [files = type.params.files](const void* params, const auto& visit) {
    files(params, visit);
    const FilePath& file = static_cast<const Params*>(params)->file;
    for (const MeshReader& reader : mesh_readers()) {
      if (reader.extension != extension_of(file.written) || reader.visit_files == nullptr) continue;
      try {
        const FileBytes bytes(file);
        reader.visit_files(bytes.text(), file, visit);
      } catch (const std::runtime_error&) {  // running the node says what is wrong
      }
    }
  };
}

void check(const Params& p) {
  if (p.file.empty()) throw NodeError("no_file", "no file is named", at_param("file"));
  reader_of(p.file);
}

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  const MeshReader& reader = reader_of(p.file);
  const FileBytes bytes(p.file);
  return {std::make_shared<Mesh>(reader.read(bytes.text(), p.file, ctx))};
}

}  // namespace

NodeType nodes::io_load_mesh() {
  NodeType type =
      node("io.load_mesh", run)
          .doc("Reads a triangle mesh from a glTF, OBJ, PLY or STL file.")
          .cite(
              "Khronos, glTF 2.0, ISO/IEC 12113:2022; Wavefront, The Advanced Visualizer: Object Files "
              "(.obj), "
              "appendix B1; Turk 1994, The PLY Polygon File Format")
          .param("file", &Params::file,
                 "A .gltf, .glb, .obj, .ply or .stl file; polygons become triangles, faces keep their "
                 "materials.")
          .check(check)
          .output(
              "mesh", &Outputs::mesh,
              "The vertices of the file, of a glTF every instance in its place; normals it lacks are made.",
              {.space = Space::object});
  depend_on_files_beside(type);
  depend_on_named_files(type);
  return type;
}

}  // namespace frustum
