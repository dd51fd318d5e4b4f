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
  throw NodeError("unknown_format", fmt::format("{}: meshes are read from {} files, not from .{}",
                                                file.written, fmt::join(known, ", "), kind));
}

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  if (p.file.empty()) throw NodeError("no_file", "no file is named");
  const MeshReader& reader = reader_of(p.file);
  const FileBytes bytes(p.file);
  return {std::make_shared<Mesh>(reader.read(bytes.text(), p.file, ctx))};
}

}  // namespace

NodeType nodes::io_load_mesh() {
  NodeType type = node("io.load_mesh", run)
                      .doc("Reads a triangle mesh from a glTF, OBJ, PLY or STL file.")
                      .cite(
                          "Wavefront, The Advanced Visualizer: Object Files (.obj), appendix B1; Turk 1994, "
                          "The PLY Polygon "
                          "File Format")
                      .param("file", &Params::file,
                             "A .gltf, .glb, .obj, .ply or .stl file; polygons become triangles, faces keep "
                             "their materials.")
                      .output("mesh", &Outputs::mesh,
                              "The vertices of the file, of a glTF every instance in its place; normals that "
                              "it lacks are made.",
                              {.space = Space::object});
  depend_on_files_beside(type);
  return type;
}

}  // namespace frustum
