// What is said of glTF files that lie: one lie a case, told by changing a good file.
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_problem.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace frustum {
namespace {

using test::GltfMaker;
using testing::HasSubstr;
using Tree = nlohmann::json;

struct Lie {
  const char* name;
  void (*tell)(GltfMaker&);
  const char* code;
  const char* says;
};
std::ostream& operator<<(std::ostream& out, const Lie& l) { return out << l.name; }

const Lie lies[] = {
    {"index_out_of_range",
     [](GltfMaker& g) {
       g.document["meshes"][0]["primitives"][0]["indices"] = g.accessor<std::uint16_t>({0, 1, 3}, "SCALAR");
     },
     "malformed_file", "box.glb: accessors[1]: index 2 is vertex 3, and accessors[0] has 3 vertices"},
    {"view_beyond_buffer", [](GltfMaker& g) { g.document["bufferViews"][0]["byteOffset"] = 4; },
     "malformed_file", "box.glb: bufferViews[0]: bytes 4 to 40 lie beyond the 36 of buffers[0]"},
    {"buffer_beyond_chunk",
     [](GltfMaker& g) {
       g.document["buffers"] = {{{"byteLength", 1000000}}};
     },
     "malformed_file", "box.glb: buffers[0]: byteLength says 1000000 bytes, and there are 36"},
    {"two_billion_vertices", [](GltfMaker& g) { g.document["accessors"][0]["count"] = 1ull << 31; },
     "malformed_file", "box.glb: accessors[0]: 2147483648 elements of 12 bytes"},
    {"two_billion_zeros",
     [](GltfMaker& g) {
       g.document["accessors"][0].erase("bufferView");
       g.document["accessors"][0]["count"] = (1ull << 31) - 2;
     },
     "too_large", "2147483646 vertices"},
    {"count_that_overflows", [](GltfMaker& g) { g.document["accessors"][0]["count"] = 1ull << 53; },
     "malformed_file", "accessors[0]: 9007199254740992 elements"},
    {"offset_that_overflows",
     [](GltfMaker& g) { g.document["bufferViews"][0]["byteOffset"] = 18446744073709551615ull; },
     "malformed_file", "bufferViews[0].byteOffset: this must be a whole number"},
    {"negative_count", [](GltfMaker& g) { g.document["accessors"][0]["count"] = -1; }, "malformed_file",
     "accessors[0].count"},
    {"stride_of_one", [](GltfMaker& g) { g.document["bufferViews"][0]["byteStride"] = 1; }, "malformed_file",
     "bufferViews[0].byteStride: this must be 4 to 252"},
    {"unknown_component", [](GltfMaker& g) { g.document["accessors"][0]["componentType"] = 5124; },
     "malformed_file", "accessors[0].componentType"},
    {"wrong_type_of_json", [](GltfMaker& g) { g.document["accessors"] = Tree::object(); }, "malformed_file",
     "box.glb: accessors: this must be an array"},
    {"emission_that_overflows",
     [](GltfMaker& g) {
       g.document["meshes"][0]["primitives"][0]["material"] = 0;
       g.document["materials"] = {
           {{"emissiveFactor", {1e200, 0, 0}},
            {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e200}}}}}}};
     },
     "malformed_file", "box.glb: materials[0]: its emission is larger than any number"},
    {"light_that_overflows",
     [](GltfMaker& g) {
       g.document["nodes"][0]["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}}};
       g.document["extensions"] = {
           {"KHR_lights_punctual",
            {{"lights", {{{"type", "point"}, {"color", {1e200, 0, 0}}, {"intensity", 1e200}}}}}}};
     },
     "malformed_file", "lights[0]: colour times intensity is larger than any number"},
    {"sparse_index_outside",
     [](GltfMaker& g) {
       const std::size_t i = g.view(GltfMaker::bytes_of<std::uint16_t>({9})),
                         v = g.view(std::string(12, '\0'));
       g.document["accessors"][0]["sparse"] = {{"count", 1},
                                               {"indices", {{"bufferView", i}, {"componentType", 5123}}},
                                               {"values", {{"bufferView", v}}}};
     },
     "malformed_file", "accessors[0]: a sparse index names none of its elements"},
    {"two_corners",
     [](GltfMaker& g) {
       g.document["meshes"][0]["primitives"][0]["indices"] = g.accessor<std::uint8_t>({0, 1}, "SCALAR");
     },
     "malformed_file", "meshes[0].primitives[0]: 2 indices are no whole triangles"},
    {"attributes_of_two_lengths",
     [](GltfMaker& g) {
       g.document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
           g.accessor<float>({0, 0, 1}, "VEC3");
     },
     "malformed_file", "accessors[1] has 1 elements, and POSITION 3"},
    {"infinite_position",
     [](GltfMaker& g) {
       const std::size_t p = g.accessor<float>({0, 0, 0, 1, INFINITY, 0, 0, 1, 0}, "VEC3");
       g.document["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = p;
     },
     "malformed_file", "accessors[1]: position 1 is not finite"},
    {"cycle_of_nodes",
     [](GltfMaker& g) {
       g.document["nodes"][0]["children"] = {1};
       g.node({{"children", {0}}}, false);
     },
     "malformed_file", "nodes[0]: it is its own ancestor"},
    {"node_with_two_parents",
     [](GltfMaker& g) {
       g.node({{"children", {2, 2}}});
       g.node(Tree::object(), false);
     },
     "malformed_file", "nodes[2]: it has two parents"},
    {"node_that_is_not_there", [](GltfMaker& g) { g.document["scenes"][0]["nodes"] = {7}; }, "malformed_file",
     "scenes[0].nodes[0]: this is none of the 1 nodes"},
    {"quaternion_without_length",
     [](GltfMaker& g) {
       g.document["nodes"][0]["rotation"] = {0, 0, 0, 0};
     },
     "malformed_file", "nodes[0].rotation"},
    {"place_beyond_all_numbers",
     [](GltfMaker& g) {
       g.document["nodes"][0]["scale"] = {1e300, 1, 1};
       g.document["nodes"][0]["children"] = {1};
       g.node({{"scale", {1e300, 1, 1}}}, false);
     },
     "malformed_file", "nodes[1]: its place in the world is not finite"},
    {"many_instances_of_much",
     [](GltfMaker& g) {
       const std::size_t p = g.accessor(std::vector<float>(30000, 0.5F), "VEC3");
       g.document["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", p}}}, {"mode", 5}};
       for (int i = 0; i < 4000; ++i) g.node({{"mesh", 0}});
     },
     "too_large", "more than 256 times"},
    {"climbing_uri",
     [](GltfMaker& g) {
       g.document["buffers"] = {{{"byteLength", 36}, {"uri", "a/%2e%2e/../../etc/passwd"}}};
     },
     "unsafe_path", "box.glb: buffers[0]: \"a/%2e%2e/../../etc/passwd\" leads out of the folder"},
    {"absolute_uri",
     [](GltfMaker& g) {
       g.document["buffers"] = {{{"byteLength", 36}, {"uri", "/etc/passwd"}}};
     },
     "unsafe_path", "is an absolute path"},
    {"uri_of_the_web",
     [](GltfMaker& g) {
       g.document["buffers"] = {{{"byteLength", 36}, {"uri", "http://a/b"}}};
     },
     "unsafe_path", "is not a file beside this one"},
    {"missing_buffer",
     [](GltfMaker& g) {
       g.document["buffers"] = {{{"byteLength", 36}, {"uri", "none.bin"}}};
     },
     "missing_file", "box.glb: buffers[0]: there is no file 'none.bin'"},
    {"bad_base64",
     [](GltfMaker& g) {
       g.document["buffers"] = {{{"byteLength", 36}, {"uri", "data:;base64,AA*A"}}};
     },
     "malformed_file", "buffers[0]: its data URI is malformed base64"},
    {"needs_draco", [](GltfMaker& g) { g.document["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
     "unsupported_extension", "it needs KHR_draco_mesh_compression"},
    {"version_1", [](GltfMaker& g) { g.document["asset"]["version"] = "1.0"; }, "unsupported_version",
     "this is glTF 1.0"},
    {"texture_that_is_not_there",
     [](GltfMaker& g) {
       g.document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 3}}}}}}};
       g.document["meshes"][0]["primitives"][0]["material"] = 0;
     },
     "malformed_file",
     "materials[0].pbrMetallicRoughness.baseColorTexture.index: 3 is none of the 0 textures"},
};

class GltfLie : public testing::TestWithParam<Lie> {};

TEST_P(GltfLie, IsFoundAndNamed) {
  GltfMaker g = test::one_triangle();
  GetParam().tell(g);
  const auto [code, message] = test::gltf_problem(g.glb());
  EXPECT_EQ(code, GetParam().code) << message;
  EXPECT_THAT(message, HasSubstr(GetParam().says));
}
INSTANTIATE_TEST_SUITE_P(All, GltfLie, testing::ValuesIn(lies),
                         [](const auto& i) { return std::string(i.param.name); });

}  // namespace
}  // namespace frustum
