#include "runtime/app/scaffold.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <regex>
#include <utility>

namespace frustum {
namespace {

constexpr std::string_view geometry_header = R"(// @name@: the algorithm, on spans, without the runtime.
#pragma once

#include "nodes/kernels/vector.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <span>

namespace frustum::@family@ {

// out[i] = in[i] + distance * direction. All spans have the same length; `in` and `out` may be the same.
// Error: one rounding of the product and one of the sum, in R.
template <class R>
void @node@(std::span<const glm::vec<3, R>> in, const glm::vec<3, R>& direction, R distance,
            std::span<glm::vec<3, R>> out) {
  for (std::size_t i = 0; i < in.size(); ++i) out[i] = in[i] + distance * direction;
}

}  // namespace frustum::@family@
)";

constexpr std::string_view geometry_source = R"(#include "nodes/@family@/@node@.h"

@include@ "nodes/@family@.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {
  glm::dvec3 direction{0, 1, 0};
  double distance = 1;
};
struct Outputs {
  Ref<Mesh> mesh;
};

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  return ctx.real([&]<class R>() -> Outputs {
    using V = glm::vec<3, R>;
    const Ref<Column> position = in.mesh->real<R>("position");
    const std::shared_ptr<Column> moved =
        Column::make<V>("position", Domain::vertex, position->rows(), position->space());
    const auto distance = static_cast<R>(p.distance);
    @family@::@node@<R>(position->values<V>(), V(p.direction), distance, moved->values<V>());
    return {std::make_shared<const Mesh>(in.mesh->with(moved))};
  });
}

}  // namespace

NodeType nodes::@family@_@node@() {
  return node("@name@", run)
      .doc("Moves every vertex by the same distance along a direction.")
      .input("mesh", &Inputs::mesh, "Triangles with three coordinates a vertex.",
             {.space = {Space::object, Space::world, Space::eye}})
      .param("direction", &Params::direction, "Which way; its length scales the way gone.")
      .param("distance", &Params::distance, "How far; raising it moves further.", {.unit = "world units"})
      .output("mesh", &Outputs::mesh, "The same triangles, moved; every other column is shared.");
}

}  // namespace frustum
)";

constexpr std::string_view geometry_test = R"(#include "nodes/@family@/@node@.h"

@include@ "nodes/@family@.h"
#include "runtime/buffers/mesh.h"
@include@ "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>

namespace frustum {
namespace {

using glm::vec3;

Ref<Mesh> triangle() {
  Mesh mesh;
  const std::array<vec3, 3> corners{vec3{0, 0, 0}, vec3{1, 0, 0}, vec3{0, 1, 0}};
  const std::array<glm::uvec3, 1> faces{glm::uvec3{0, 1, 2}};
  mesh.columns.push_back(Column::make<vec3>("position", Domain::vertex, corners, Space::object));
  mesh.columns.push_back(Column::make<glm::uvec3>("triangle", Domain::face, faces));
  return std::make_shared<const Mesh>(std::move(mesh));
}

Ref<Mesh> moved(const Json& params) {
  return test::run_node(nodes::@family@_@node@(), params, {{triangle()}}).at(0).as<Mesh>();
}

TEST(@Node@, MovesEveryVertexAlongTheDirection) {
  const auto mesh = moved({{"direction", {0, 0, 2}}, {"distance", 1.5}});
  const auto p = mesh->at("position").values<vec3>();
  EXPECT_EQ(p[0], vec3(0, 0, 3));
  EXPECT_EQ(p[1], vec3(1, 0, 3));
  EXPECT_EQ(p[2], vec3(0, 1, 3));
}

TEST(@Node@, DistanceZeroKeepsEveryBit) {
  const auto before = triangle(), after = moved({{"distance", 0}});
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(after->at("position").values<vec3>()[i], before->at("position").values<vec3>()[i]);
}

TEST(@Node@, KeepsTheSpaceAndTheOtherColumns) {
  const auto mesh = moved(Json::object());
  EXPECT_EQ(mesh->space(), Space::object);
  EXPECT_EQ(mesh->triangles()[0], glm::uvec3(0, 1, 2));
}

TEST(@Node@, OfNoVerticesIsNothing) { @family@::@node@<float>({}, vec3(1), 1.0f, {}); }

}  // namespace
}  // namespace frustum
)";

constexpr std::string_view geometry_graph = R"({ "$schema": "../../../schemas/graph.schema.json",
  "format": "frustum.graph/1",
  "title": "@name@: the teapot, moved",
  "nodes": {
    "teapot": { "type": "io.load_patches", "params": { "file": "../../data/teapot.json" } },
    "mesh":   { "type": "surface.tessellate", "in": { "surface": "teapot" } },
    "moved":  { "type": "@name@", "in": { "mesh": "mesh" },
                "params": { "direction": [0, 0, 1], "distance": 0.5 } } },
  "outputs": {
    "moved": { "from": "moved" } } }
)";

constexpr std::string_view pixel_header = R"(// @name@: the algorithm, on one row, without the runtime.
#pragma once

#include <cstddef>
#include <span>

namespace frustum::@family@ {

// out[i] = gain * in[i]. Both rows have the same length; they may be the same row. Error: one rounding, in R.
template <class R>
void @node@(std::span<const R> in, R gain, std::span<R> out) {
  for (std::size_t i = 0; i < in.size(); ++i) out[i] = gain * in[i];
}

}  // namespace frustum::@family@
)";

constexpr std::string_view pixel_source = R"(#include "nodes/@family@/@node@.h"

@include@ "nodes/@family@.h"
#include "runtime/buffers/image.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  Tiled<Image> image;
};
struct Params {
  double gain = 1;
};
struct Outputs {
  Tiled<Image> image;
};

// What tile() needs beside the pixels; immutable, shared by all threads.
struct State {
  double gain;
};

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context&) {
  in.image.read_all();
  return {{p.gain}, {in.image.frame()}};
}

template <class R>
void fill(const State& state, const Tile& in, const Tile& out, int plane) {
  const Rect& r = out.rect();
  const auto width = static_cast<std::size_t>(r.width());
  for (int s = 0; s < out.samples(); ++s)
    for (int y = r.y0; y < r.y1; ++y) {
      const R* row = in.row<R>(plane, s, y) + (r.x0 - in.rect().x0);
      @family@::@node@<R>({row, width}, static_cast<R>(state.gain), {out.row<R>(plane, s, y), width});
    }
}

void tile(const State& state, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena&) {
  const Tile &from = in[&Inputs::image], &to = out[&Outputs::image];
  for (int p = 0; p < static_cast<int>(to.frame().planes.size()); ++p) {
    if (!to.has(p)) continue;
    switch (to.frame().planes[static_cast<std::size_t>(p)].kind) {
      case PlaneKind::f32: fill<float>(state, from, to, p); break;
      case PlaneKind::f64: fill<double>(state, from, to, p); break;
      case PlaneKind::u32: fill<std::uint32_t>({1}, from, to, p); break;  // ids and counts are no light
    }
  }
}

}  // namespace

NodeType nodes::@family@_@node@() {
  return pixel_node("@name@", prepare, tile)
      .doc("Multiplies every real plane by a gain.")
      .input("image", &Inputs::image, "Any planes; planes of whole numbers pass unchanged.")
      .param("gain", &Params::gain, "What to multiply by; raising it brightens.")
      .output("image", &Outputs::image, "The same planes and samples.");
}

}  // namespace frustum
)";

constexpr std::string_view pixel_test = R"(#include "nodes/@family@/@node@.h"

@include@ "nodes/@family@.h"
#include "runtime/buffers/image.h"
@include@ "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

// 3x2 pixels of one plane: 0 1 2 / 3 4 5.
Ref<Image> ramp() {
  Raster raster(Frame{{0, 0, 3, 2}, nullptr, {{"R", PlaneKind::f32}}, "lin_rec709", Alpha::none});
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) raster.view().row<float>(0, 0, y)[x] = static_cast<float>(3 * y + x);
  return std::make_shared<const Image>(Image{raster});
}

Ref<Image> scaled(const Json& params, int tile_edge) {
  return test::run_node(nodes::@family@_@node@(), params, {{ramp()}}, nullptr, {}, tile_edge).at(0).as<Image>();
}

TEST(@Node@, MultipliesEveryPixel) {
  const auto image = scaled({{"gain", 2}}, 0);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x)
      EXPECT_EQ(image->raster.at<float>(0, 0, x, y), static_cast<float>(2 * (3 * y + x)));
}

TEST(@Node@, TilesGiveTheSameBytesAsTheWhole) {
  EXPECT_EQ(Buffer(scaled({{"gain", 0.3}}, 1)).digest(), Buffer(scaled({{"gain", 0.3}}, 0)).digest());
}

TEST(@Node@, GainOneKeepsEveryBit) {
  EXPECT_EQ(Buffer(scaled(Json::object(), 2)).digest(), Buffer(ramp()).digest());
}

TEST(@Node@, OfAnEmptyRowIsNothing) { @family@::@node@<float>({}, 2.0f, {}); }

}  // namespace
}  // namespace frustum
)";

constexpr std::string_view pixel_graph = R"({ "$schema": "../../../schemas/graph.schema.json",
  "format": "frustum.graph/1",
  "title": "@name@: a brighter teapot",
  "nodes": {
    "teapot": { "type": "io.load_patches", "params": { "file": "../../data/teapot.json" } },
    "camera": { "type": "scene.camera", "params": { "eye": [0, -9, 4], "target": [0, 0, 1.2], "up": [0, 0, 1],
                "resolution": [64, 48] } },
    "mesh":   { "type": "surface.tessellate", "in": { "surface": "teapot", "camera": "camera" } },
    "key":    { "type": "light.directional", "params": { "direction": [-1, 2, -1] } },
    "clay":   { "type": "shade.material" },
    "draw":   { "type": "graph", "file": "lib:raster",
                "in": { "mesh": "mesh", "camera": "camera", "lights": ["key"], "material": "clay" } },
    "bright": { "type": "@name@", "in": { "image": "draw" }, "params": { "gain": 2 } } },
  "outputs": {
    "bright": { "from": "bright" } } }
)";

std::string filled(std::string_view text, const std::vector<std::pair<std::string, std::string>>& values) {
  std::string out(text);
  for (const auto& [key, value] : values)
    for (std::size_t at = out.find(key); at != std::string::npos; at = out.find(key, at + value.size()))
      out.replace(at, key.size(), value);
  return out;
}

}  // namespace

std::string pascal_name(std::string_view name) {
  std::string out;
  bool up = true;
  for (const char c : name) {
    if (c == '_' || c == '.') {
      up = true;
      continue;
    }
    out += up && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    up = false;
  }
  return out;
}

namespace {

bool is_keyword(std::string_view word) {
  static constexpr std::string_view keywords[] = {
      "alignas",     "alignof",   "and",       "asm",           "auto",         "bool",
      "break",       "case",      "catch",     "char",          "class",        "concept",
      "const",       "continue",  "decltype",  "default",       "delete",       "do",
      "double",      "else",      "enum",      "explicit",      "export",       "extern",
      "false",       "float",     "for",       "friend",        "goto",         "if",
      "inline",      "int",       "long",      "mutable",       "namespace",    "new",
      "noexcept",    "not",       "nullptr",   "operator",      "or",           "private",
      "protected",   "public",    "register",  "requires",      "return",       "short",
      "signed",      "sizeof",    "static",    "struct",        "switch",       "template",
      "this",        "throw",     "true",      "try",           "typedef",      "typeid",
      "typename",    "union",     "unsigned",  "using",         "virtual",      "void",
      "volatile",    "while",     "xor",       "bitand",        "bitor",        "compl",
      "constexpr",   "consteval", "constinit", "static_assert", "thread_local", "wchar_t",
      "static_cast", "const_cast"};
  return std::find(std::begin(keywords), std::end(keywords), word) != std::end(keywords);
}

// Names that a node's source sees, which a namespace of the same name would hide.
bool is_seen(std::string_view word) {
  static constexpr std::string_view seen[] = {"std",  "glm",        "tbb",   "hwy",     "fmt",    "frustum",
                                              "node", "pixel_node", "nodes", "kernels", "detail", "test"};
  return std::find(std::begin(seen), std::end(seen), word) != std::end(seen);
}

}  // namespace

std::string problem_of_node_name(std::string_view name) {
  static const std::regex pattern("[a-z][a-z0-9]*(_[a-z0-9]+)*[.][a-z][a-z0-9]*(_[a-z0-9]+)*");
  if (name.size() > 100 || !std::regex_match(name.begin(), name.end(), pattern))
    return "a node type is named FAMILY.NODE in snake_case, such as clip.homogeneous";
  const auto dot = name.find('.');
  const std::string_view family = name.substr(0, dot), node = name.substr(dot + 1);
  if (family.find('_') != std::string_view::npos)
    return "a family is one word: clip_a.b and clip.a_b would be one C++ function";
  for (const std::string_view word : {family, node})
    if (is_keyword(word)) return fmt::format("'{}' is a word of C++", word);
  if (is_seen(family)) return fmt::format("a family '{}' would hide what nodes use by that name", family);
  return "";
}

std::vector<ScaffoldFile> scaffold(std::string_view name, NewNode kind) {
  const auto dot = name.find('.');
  const std::string family(name.substr(0, dot)), node(name.substr(dot + 1));
  const std::vector<std::pair<std::string, std::string>> values{{"@name@", std::string(name)},
                                                                {"@include@", "#include"},
                                                                {"@family@", family},
                                                                {"@node@", node},
                                                                {"@Node@", pascal_name(name)}};
  const bool pixels = kind == NewNode::pixels;
  const std::string path = family + "/" + node;
  return {{"nodes/" + path + ".h", filled(pixels ? pixel_header : geometry_header, values)},
          {"nodes/" + path + ".cpp", filled(pixels ? pixel_source : geometry_source, values)},
          {"tests/nodes/" + path + "_test.cpp", filled(pixels ? pixel_test : geometry_test, values)},
          {"graphs/nodes/" + path + ".json", filled(pixels ? pixel_graph : geometry_graph, values)}};
}

}  // namespace frustum
