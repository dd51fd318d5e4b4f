// Primitives of glTF meshes: what of them is read, checked as far as that goes without reading elements.
#pragma once

#include "runtime/io/gltf_data.h"
#include "runtime/io/gltf_notes.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace frustum::gltf {

struct Primitive {
  enum class Mode : std::uint8_t { triangles = 4, strip = 5, fan = 6 };
  std::string path;
  Mode mode = Mode::triangles;
  Accessor position;
  std::optional<Accessor> normal, color, index;
  std::map<std::uint32_t, Accessor> uv;  // by set
  std::map<std::string, Accessor> own;   // the application's, by column
  std::optional<std::size_t> material;

  std::size_t vertices() const { return position.count; }
  // Whether all attributes that are read come from the same accessors.
  bool same_vertices(const Primitive& other) const;
  std::size_t corners() const { return index ? index->count : position.count; }
  std::size_t triangles() const {
    if (mode == Mode::triangles) return corners() / 3;
    return corners() < 3 ? 0 : corners() - 2;
  }
};

// The triangles of one mesh. Other primitives, and attributes that are not read, are noted. Throws
// NodeError("malformed_file") for attributes of the wrong type or length.
std::vector<Primitive> read_primitives(const Object& mesh, const FilePath& file, Data& data,
                                       std::size_t materials, bool quantized, Notes& notes);

}  // namespace frustum::gltf
