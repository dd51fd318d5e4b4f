#include "runtime/io/mesh_readers.h"

#include "runtime/io/gltf.h"
#include "runtime/io/mtl.h"
#include "runtime/io/obj.h"
#include "runtime/io/ply.h"
#include "runtime/io/stl.h"

#include <array>

namespace frustum {
namespace {

constexpr std::array readers{
    MeshReader{"gltf", "glTF 2.0", read_gltf_mesh},
    MeshReader{"glb", "GLB", read_gltf_mesh},
    MeshReader{"obj", "Wavefront OBJ", read_obj, visit_obj_files},
    MeshReader{"ply", "PLY", read_ply},
    MeshReader{"stl", "STL", read_stl},
};

}  // namespace

std::span<const MeshReader> mesh_readers() { return readers; }

}  // namespace frustum
