// How reading the bytes of a glTF file ends.
#pragma once

#include "runtime/core/error.h"
#include "runtime/io/gltf.h"

#include <string>
#include <utility>

namespace frustum::test {

inline const FilePath box{"box.glb", "box.glb"};

// Code and message of the error; empty where there is none. The code of a WorldError begins with "world: ".
inline std::pair<std::string, std::string> gltf_problem(const std::string& bytes,
                                                        const FilePath& file = box) {
  try {
    Context ctx;
    read_gltf(bytes, file, true, ctx);
  } catch (const NodeError& e) {
    return {e.code, e.what()};
  } catch (const WorldError& e) {
    return {"world: " + e.code, e.what()};
  }
  return {};
}

}  // namespace frustum::test
