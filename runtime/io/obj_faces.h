// Which material and which group each triangle of an OBJ file belongs to.
#pragma once

#include "runtime/buffers/column.h"
#include "runtime/io/obj_parse.h"

#include <map>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum::obj {

struct FaceNames {
  Ref<Column> material, group;              // face columns; null where the file names none, or one group only
  std::vector<std::string_view> materials;  // by number, in the order of first use
};

// Every face of n corners counts n - 2 triangles. A group is a pair of what `o` and `g` last said; it has its
// number from its first face. Faces before the first usemtl have the material without a name.
template <class R>
FaceNames name_faces(std::span<const Chunk<R>> chunks, std::size_t triangles);

}  // namespace frustum::obj
