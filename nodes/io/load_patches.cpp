#include "nodes/io/load_patches.h"

#include "nodes/io.h"
#include "runtime/core/node_type.h"
#include "runtime/io/file_bytes.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace frustum {
namespace {

constexpr std::string_view format = "frustum.patches/1";

struct File {
  std::string_view name;

  [[noreturn]] void fail(std::string_view pointer, std::string_view what) const {
    throw NodeError("malformed_file", fmt::format("{} {}: {}", name, pointer.empty() ? "/" : pointer, what));
  }
};

Json parse(std::string_view text, const File& file) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& e) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(e.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    throw NodeError("malformed_file",
                    fmt::format("{}:{}: this is not JSON (byte {})", file.name, line, e.byte));
  } catch (const Json::exception&) {  // a number beyond the range of double
    throw NodeError("malformed_file", fmt::format("{}: a number is too large", file.name));
  }
}

const Json& array_at(const Json& root, std::string_view key, const File& file) {
  const auto it = root.find(key);
  if (it == root.end()) file.fail("", fmt::format("there is no \"{}\"", key));
  if (!it->is_array()) file.fail(fmt::format("/{}", key), "this must be an array");
  return *it;
}

glm::dvec3 read_point(const Json& json, std::size_t i, const File& file) {
  const std::string pointer = fmt::format("/points/{}", i);
  if (!json.is_array() || json.size() != 3) file.fail(pointer, "a point is an array of 3 numbers");
  glm::dvec3 p{};
  for (int k = 0; k < 3; ++k) {
    const Json& n = json[static_cast<std::size_t>(k)];
    if (!n.is_number()) file.fail(fmt::format("{}/{}", pointer, k), "this must be a number");
    p[k] = n.get<double>();
  }
  return p;
}

std::array<std::uint32_t, 16> read_patch(const Json& json, std::size_t i, std::size_t points,
                                         const File& file) {
  const std::string pointer = fmt::format("/patches/{}", i);
  if (!json.is_array() || json.size() != 16) file.fail(pointer, "a patch is an array of 16 indices");
  std::array<std::uint32_t, 16> patch{};
  for (std::size_t k = 0; k < 16; ++k) {
    const Json& n = json[k];
    if (!n.is_number_unsigned() || n.get<std::uint64_t>() >= points)
      file.fail(fmt::format("{}/{}", pointer, k),
                fmt::format("{} is not the index of one of the {} points", n.dump(), points));
    patch[k] = n.get<std::uint32_t>();
  }
  return patch;
}

struct Inputs {};
struct Params {
  FilePath file;
};
struct Outputs {
  Ref<Surface> surface;
};

void check(const Params& p) {
  if (p.file.empty()) throw NodeError("no_file", "no file is named", at_param("file"));
}

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  const FileBytes bytes(p.file);
  auto surface = std::make_shared<Surface>(parse_patches(bytes.text(), p.file.written));
  ctx.count("patches", surface->patches.size());
  return {std::move(surface)};
}

}  // namespace

Surface parse_patches(std::string_view text, std::string_view name) {
  const File file{name};
  const Json root = parse(text, file);
  if (!root.is_object()) file.fail("", "this must be an object");
  for (const auto& [key, value] : root.items())
    if (key != "format" && key != "title" && key != "points" && key != "patches")
      file.fail("", fmt::format("\"{}\" is not a key of this format", key));
  if (const auto it = root.find("format"); it == root.end() || *it != format)
    file.fail("/format", fmt::format("this must be \"{}\"", format));
  Surface s;
  const Json &points = array_at(root, "points", file), &patches = array_at(root, "patches", file);
  for (std::size_t i = 0; i < points.size(); ++i) s.points.push_back(read_point(points[i], i, file));
  for (std::size_t i = 0; i < patches.size(); ++i)
    s.patches.push_back(read_patch(patches[i], i, points.size(), file));
  return s;
}

NodeType nodes::io_load_patches() {
  return node("io.load_patches", run)
      .doc("Reads bicubic Bezier patches from a JSON file.")
      .cite("Newell 1975, The Utilization of Procedure Models in Digital Image Synthesis (the teapot)")
      .param("file", &Params::file,
             "A file of format frustum.patches/1: points, and patches of 16 indices into them.")
      .check(check)
      .output("surface", &Outputs::surface,
              "The patches in object space; shared indices are shared control points.",
              {.space = Space::object});
}

}  // namespace frustum
