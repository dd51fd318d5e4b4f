// A mesh file without faces is a picture of the background, through every graph of the library that draws.
#include "tests/support/session_run.h"

#include <gtest/gtest.h>

namespace frustum {
namespace {

constexpr std::string_view header = "ply\nformat ascii 1.0\n";

struct EmptyFile {
  const char* name;
  std::string bytes;
};

std::vector<EmptyFile> files() {
  std::string stl(84, '\0');
  return {{"nothing.ply", std::string(header) +
                              "element vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
                              "element face 0\nproperty list uchar int vertex_indices\nend_header\n"},
          {"points.ply", std::string(header) +
                             "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                             "end_header\n0 0 0\n1 1 1\n"},
          {"nothing.obj", "# nothing\n"},
          {"points.obj", "v 0 0 0\nv 1 0 0\n"},
          {"nothing.stl", stl},
          {"text.stl", "solid nothing\nendsolid nothing\n"},
          {"nothing.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{}], "scene": 0})"}};
}

std::string graph_of(std::string_view file, std::string_view library, std::string_view more) {
  return fmt::format(R"({{
  "format": "frustum.graph/1",
  "params": {{ "resolution": [24, 16], "samples": 4 }},
  "nodes": {{
    "mesh":   {{ "type": "io.load_mesh", "params": {{ "file": "{}" }} }},
    "camera": {{ "type": "scene.camera", "params": {{ "eye": [0, 0, 5], "target": [0, 0, 0], "resolution": "$resolution" }} }},
    "lamp":   {{ "type": "light.point", "params": {{ "position": [1, 2, 3] }} }},
    "shiny":  {{ "type": "shade.material", "params": {{ "specular": 0.5, "two_sided": true }} }},
    "checks": {{ "type": "texture.checker" }},
    "draw":   {{ "type": "graph", "file": "{}", "params": {{ "samples": "$samples" }},
                "in": {{ "mesh": "mesh", "camera": "camera"{} }} }} }},
  "outputs": {{ "beauty": {{ "from": "draw.image" }} }} }})",
                     file, library, more);
}

void expect_background(const EmptyFile& file, std::string_view library, std::string_view more) {
  test::TempFolder folder;
  folder.write(file.name, file.bytes);
  const test::SessionRun run = test::run_in_session(folder, graph_of(file.name, library, more), {"beauty"});
  ASSERT_EQ(run.result.end, RunResult::End::done) << file.name << " " << library << more << "\n"
                                                  << run.said();
  const Raster& image = run.image();
  ASSERT_EQ(image.frame().window, (Rect{0, 0, 24, 16}));
  for (int plane = 0; plane < static_cast<int>(image.frame().planes.size()); ++plane)
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 24; ++x)
        ASSERT_EQ(image.value(plane, 0, x, y), 0) << file.name << " " << library << " " << plane;
}

TEST(EmptyMesh, IsABackgroundThroughTheLibrary) {
  for (const EmptyFile& file : files()) {
    for (const char* library : {"lib:raster", "lib:abuffer"})
      for (const char* more : {R"(, "lights": ["lamp"])", R"(, "lights": ["lamp"], "material": "shiny")",
                               R"(, "lights": ["lamp"], "material": "shiny", "texture": "checks")"})
        expect_background(file, library, more);
  }
}

TEST(EmptyMesh, IsABackgroundHoweverItIsInterpolated) {
  for (const char* how : {"flat", "gouraud", "phong"}) {
    test::TempFolder folder;
    const EmptyFile file = files()[1];
    folder.write(file.name, file.bytes);
    std::string graph = graph_of(file.name, "lib:raster", R"(, "lights": ["lamp"])");
    const std::string params = R"("params": { "samples": "$samples" },)";
    graph.replace(graph.find(params), params.size(),
                  params + fmt::format(R"( "overrides": {{ "lit:interpolation": "{}" }},)", how));
    const test::SessionRun run = test::run_in_session(folder, graph, {"beauty"});
    EXPECT_EQ(run.result.end, RunResult::End::done) << how << "\n" << run.said();
  }
}

// One face is one face.
TEST(EmptyMesh, OneFaceWithoutNormalsIsNotEmpty) {
  test::TempFolder folder;
  const EmptyFile file{"one.ply",
                       std::string(header) +
                           "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                           "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                           "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"};
  folder.write(file.name, file.bytes);
  const test::SessionRun run =
      test::run_in_session(folder, graph_of(file.name, "lib:raster", R"(, "lights": ["lamp"])"), {"beauty"});
  EXPECT_EQ(run.result.end, RunResult::End::done) << run.said();
  double sum = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; ++x) sum += run.image().value(3, 0, x, y);
  EXPECT_GT(sum, 1);
}

}  // namespace
}  // namespace frustum
