// What both containers of glTF have in common.
#pragma once

#include "tests/fuzz/support/target.h"

#include <string_view>

namespace frustum::fuzz {

// Reads a scene with its cameras, lights and pictures; "beside.bin", 84 bytes, lies in its folder.
void read_scene(std::string_view input, std::string_view name);

// What a mesh may take is 64 MB and 256 times its file (runtime/io/gltf.h). Weighed are also the copies that
// statistics make of a column at a time, and pictures in the file, which are not decoded here.
constexpr MemoryBound scene_memory{std::size_t{3} << 26, 2048};

}  // namespace frustum::fuzz
