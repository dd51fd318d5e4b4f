#include "nodes/io/load_mesh.h"

#include "nodes/io.h"
#include "runtime/core/node_type.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/obj.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  FilePath file;
};
struct Outputs {
  Ref<Mesh> mesh;
};

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  if (const std::string kind = extension_of(p.file.written); !p.file.empty() && kind != "obj")
    throw NodeError("unknown_format",
                    fmt::format("{}: meshes are read from .obj files, not from .{}", p.file.written, kind));
  const FileBytes bytes(p.file);
  return {std::make_shared<Mesh>(read_obj(bytes.text(), p.file, ctx))};
}

}  // namespace

NodeType nodes::io_load_mesh() {
  return node("io.load_mesh", run)
      .doc("Reads a triangle mesh from a Wavefront OBJ file.")
      .cite("Wavefront, The Advanced Visualizer: Object Files (.obj), appendix B1")
      .param("file", &Params::file,
             "An OBJ file; polygons become triangles, usemtl gives each face its material.")
      .output("mesh", &Outputs::mesh,
              "One vertex for each distinct v/vt/vn; normals that the file lacks are computed.",
              {.space = Space::object});
}

}  // namespace frustum
