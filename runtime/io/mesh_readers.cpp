#include "runtime/io/mesh_readers.h"

#include "runtime/io/obj.h"

#include <array>

namespace frustum {
namespace {

constexpr std::array readers{
    MeshReader{"obj", "Wavefront OBJ", read_obj},
};

}  // namespace

std::span<const MeshReader> mesh_readers() { return readers; }

}  // namespace frustum
