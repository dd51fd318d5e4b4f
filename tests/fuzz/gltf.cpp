// glTF files of JSON, with buffers in them or beside them.
#include "tests/fuzz/support/gltf.h"
#include "tests/fuzz/support/target.h"

namespace frustum::fuzz {
namespace {

void read(std::string_view input) { read_scene(input, "input.gltf"); }
const Registered gltf({"gltf", read, scene_memory});

}  // namespace
}  // namespace frustum::fuzz
