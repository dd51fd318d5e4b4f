// GLB files. What does not begin as one is wrapped in one, so that changed lengths do not end every input: the text up
// to the first zero byte is its JSON chunk, the rest its binary one.
#include "tests/fuzz/support/gltf.h"
#include "tests/fuzz/support/target.h"
#include "tests/support/gltf_maker.h"

namespace frustum::fuzz {
namespace {

void read(std::string_view input) {
  if (input.starts_with("glTF")) return read_scene(input, "input.glb");
  const std::size_t cut = std::min(input.find('\0'), input.size());
  const std::string_view binary = input.substr(std::min(cut + 1, input.size()));
  read_scene(test::GltfMaker::wrap(std::string(input.substr(0, cut)), std::string(binary)), "input.glb");
}
const Registered glb({"glb", read, scene_memory});

}  // namespace
}  // namespace frustum::fuzz
