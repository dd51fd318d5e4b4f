#include "runtime/io/gltf_file.h"

#include "runtime/core/error.h"
#include "runtime/core/node_type.h"
#include "runtime/io/gltf.h"
#include "runtime/io/gltf_data.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace frustum::gltf {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF stores little-endian numbers");

constexpr std::uint32_t glb_magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

// What a file may say that it requires: all that this reader gives the meaning it has.
constexpr std::array supported{"KHR_lights_punctual",    "KHR_materials_emissive_strength",
                               "KHR_materials_ior",      "KHR_materials_pbrSpecularGlossiness",
                               "KHR_materials_specular", "KHR_materials_unlit",
                               "KHR_mesh_quantization",  "KHR_texture_transform"};

std::uint32_t word(std::string_view bytes, std::size_t at) {
  std::uint32_t w = 0;
  std::memcpy(&w, bytes.data() + at, sizeof w);
  return w;
}

struct Chunks {
  std::string_view json;
  std::optional<std::string_view> binary;
};

Chunks split(std::string_view bytes, const FilePath& file) {
  if (bytes.size() < 4 || word(bytes, 0) != glb_magic) return {bytes, {}};
  if (bytes.size() < 20) fail(file, "", fmt::format("a GLB file of {} bytes is cut off", bytes.size()));
  if (const std::uint32_t version = word(bytes, 4); version != 2)
    throw NodeError("unsupported_version",
                    fmt::format("{}: this is GLB version {}; version 2 is read", file.written, version));
  const std::size_t length = word(bytes, 8);
  if (length < 20 || length > bytes.size())
    fail(file, "", fmt::format("its header says {} bytes, and there are {}", length, bytes.size()));
  Chunks out;
  std::size_t at = 12;
  for (int chunk = 0; at + 8 <= length; ++chunk) {
    const std::size_t size = word(bytes, at);
    const std::uint32_t kind = word(bytes, at + 4);
    if (size > length - at - 8)
      fail(file, "", fmt::format("chunk {} says {} bytes, and {} are left", chunk, size, length - at - 8));
    const std::string_view content = bytes.substr(at + 8, size);
    if (chunk == 0 && kind != json_chunk) fail(file, "", "its first chunk is not JSON");
    if (chunk == 0) out.json = content;
    if (chunk == 1 && kind == binary_chunk) out.binary = content;
    at += 8 + size;
  }
  return out;
}

Tree parsed(std::string_view json, const FilePath& file) {
  if (json.empty()) fail(file, "", "there is nothing in it, and glTF is JSON");
  try {
    return Tree::parse(json);
  } catch (const Tree::parse_error& e) {
    const std::size_t at = std::min(e.byte == 0 ? 0 : e.byte - 1, json.size());
    const std::string_view before = json.substr(0, at);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    throw NodeError("malformed_file",
                    fmt::format("{}:{}:{}: this is not JSON here", file.written, line, 1 + at - start));
  } catch (const Tree::out_of_range&) {  // the only one that reading throws
    fail(file, "", "a number is beyond the largest one, 1.8e308");
  } catch (const Tree::exception& e) {
    fail(file, "", e.what());
  }
}

void check_version(const Object& document, const FilePath& file) {
  const auto asset = document.object("asset");
  const std::string version = asset ? asset->written("version") : "";
  if (version.starts_with("2.")) return;
  throw NodeError("unsupported_version",
                  version.empty()
                      ? fmt::format("{}: it does not say its version; glTF 2.0 is read", file.written)
                      : fmt::format("{}: this is glTF {}; glTF 2.0 is read", file.written, version));
}

void check_extensions(const Object& document, const FilePath& file) {
  for (const std::string& name : document.texts("extensionsRequired"))
    if (std::find(supported.begin(), supported.end(), name) == supported.end())
      throw NodeError(
          "unsupported_extension",
          fmt::format("{}: extensionsRequired: it needs {}, which is not read", file.written, name));
}

// Collects the values of all keys "uri", without building the document.
class UriCollector : public nlohmann::json_sax<Tree> {
 public:
  std::vector<std::string> uris;
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t& text) override {
    if (is_uri_ && !text.starts_with("data:")) uris.push_back(std::move(text));
    return true;
  }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return true; }
  bool key(string_t& name) override {
    is_uri_ = name == "uri";
    return true;
  }
  bool end_object() override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  bool is_uri_ = false;
};

}  // namespace

File open(std::string_view bytes, const FilePath& file) {
  const Chunks chunks = split(bytes, file);
  auto json = std::make_shared<const Tree>(parsed(chunks.json, file));
  const Object document(*json, "", file);
  check_version(document, file);
  check_extensions(document, file);
  return {std::move(json), chunks.binary};
}

std::vector<FilePath> files_beside(const FilePath& file) {
  std::vector<FilePath> out;
  try {
    const FileBytes bytes(file);
    UriCollector collector;
    Tree::sax_parse(split(bytes.text(), file).json, &collector);
    for (const std::string& uri : collector.uris) out.push_back(resolved_uri(file, uri, "uri"));
  } catch (const NodeError&) {  // what is wrong with it is said when it is read
  } catch (const WorldError&) {
  }
  return out;
}

}  // namespace frustum::gltf

namespace frustum {

void depend_on_files_beside(NodeType& type) {
  type.params.files = [files = type.params.files](const void* params, const auto& visit) {
    if (!files) return;
    files(params, [&](const FilePath& file) {
      visit(file);
      if (file.written.ends_with(".gltf") || file.written.ends_with(".glb"))
        for (const FilePath& beside : gltf::files_beside(file)) visit(beside);
    });
  };
}

}  // namespace frustum
