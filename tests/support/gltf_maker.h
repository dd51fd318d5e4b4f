// Small glTF files, made in memory: numbers go in as vectors, and come out as buffer, views and accessors.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace frustum::test {

class GltfMaker {
 public:
  nlohmann::json document = {{"asset", {{"version", "2.0"}}}};

  std::size_t view(const std::string& bytes, int stride = 0) {
    while (binary_.size() % 4 != 0) binary_.push_back('\0');
    nlohmann::json v = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
    if (stride != 0) v["byteStride"] = stride;
    binary_ += bytes;
    document["bufferViews"].push_back(v);
    return document["bufferViews"].size() - 1;
  }
  template <class T>
  static std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
  }
  template <class T>
  std::size_t accessor(const std::vector<T>& values, const char* type, bool normalized = false) {
    const int width = type[3] == '2' ? 2 : type[3] == '3' ? 3 : type[3] == '4' ? 4 : 1;
    nlohmann::json a = {{"bufferView", view(bytes_of(values))},
                        {"componentType", code_of<T>()},
                        {"count", values.size() / static_cast<std::size_t>(width)},
                        {"type", type}};
    if (normalized) a["normalized"] = true;
    document["accessors"].push_back(a);
    return document["accessors"].size() - 1;
  }
  template <class T>
  static int code_of() {
    if constexpr (std::is_same_v<T, float>) return 5126;
    if constexpr (sizeof(T) == 1) return std::is_signed_v<T> ? 5120 : 5121;
    if constexpr (sizeof(T) == 2) return std::is_signed_v<T> ? 5122 : 5123;
    return 5125;
  }

  // A mesh of one primitive, its number.
  std::size_t mesh(nlohmann::json primitive) {
    document["meshes"].push_back({{"primitives", {std::move(primitive)}}});
    return document["meshes"].size() - 1;
  }
  std::size_t node(nlohmann::json node, bool root = true) {
    document["nodes"].push_back(std::move(node));
    const std::size_t n = document["nodes"].size() - 1;
    if (root) {
      document["scene"] = 0;
      document["scenes"][0]["nodes"].push_back(n);
    }
    return n;
  }

  std::string glb() const {
    nlohmann::json json = document;
    if (!json.contains("buffers") && !binary_.empty()) json["buffers"] = {{{"byteLength", binary_.size()}}};
    return wrap(json.dump(), binary_);
  }
  static std::string wrap(std::string json, std::string binary) {
    while (json.size() % 4 != 0) json.push_back(' ');
    while (binary.size() % 4 != 0) binary.push_back('\0');
    std::string out = "glTF";
    const auto word = [&](std::size_t v) {
      const auto w = static_cast<std::uint32_t>(v);
      char bytes[4];
      std::memcpy(bytes, &w, 4);
      out.append(bytes, 4);
    };
    word(2), word(12 + 8 + json.size() + 8 + binary.size());
    word(json.size()), word(0x4E4F534A);
    out += json;
    word(binary.size()), word(0x004E4942);
    return out + binary;
  }
  const std::string& binary() const { return binary_; }

 private:
  std::string binary_;
};

// One triangle, (0 0 0) (1 0 0) (0 1 0), facing +z.
inline GltfMaker one_triangle() {
  GltfMaker g;
  const std::size_t position = g.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  g.node({{"mesh", g.mesh({{"attributes", {{"POSITION", position}}}})}});
  return g;
}

}  // namespace frustum::test
