// What `run --region` writes: the files say where in the whole picture their pixels lie.
#include "runtime/io/file_bytes.h"
#include "runtime/io/image_files.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace frustum {
namespace {

using testing::IsEmpty;

std::string text_of(const std::string& path) { return std::string(FileBytes({path, path}).text()); }

// The folder's name, after a run of the teapot at 200 x 100 into it.
std::string teapot(const test::TempFolder& folder, const std::string& name,
                   const std::vector<std::string>& more) {
  std::vector<std::string> arguments{
      "run",   std::string(FRUSTUM_SOURCE_DIR) + "/graphs/gallery/teapot_stages.json",
      "--set", "resolution=[200, 100]",
      "--set", "samples=4",
      "--out", folder.file(name)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const auto result = test::frustum(arguments);
  EXPECT_EQ(result.code, 0) << result.err;
  return folder.file(name) + "/";
}

// Compares the bytes of every plane of `part` with those of the whole picture (dx, dy) away.
void expect_same_pixels(const Raster& part, const Raster& whole, int dx, int dy) {
  const Rect& w = part.frame().window;
  ASSERT_EQ(part.frame().planes, whole.frame().planes);
  for (int p = 0; p < static_cast<int>(part.frame().planes.size()); ++p)
    for (int y = w.y0; y < w.y1; ++y) {
      const float* a = part.view().row<const float>(p, 0, y);
      const float* b = whole.view().row<const float>(p, 0, y + dy) + w.x0 + dx;
      ASSERT_EQ(std::memcmp(a, b, sizeof(float) * static_cast<std::size_t>(w.width())), 0)
          << "plane " << part.frame().planes[static_cast<std::size_t>(p)].name << ", row " << y;
    }
}

TEST(RegionFiles, HaveTheRegionForDataWindowInTheDisplayOfTheWhole) {
  const test::TempFolder folder;
  const std::string all = teapot(folder, "all", {}), cut = teapot(folder, "cut", {"--region", "60,20,70,50"});
  const Rect region{60, 20, 130, 70}, display{0, 0, 200, 100};

  const ImageFile whole = read_image(all + "teapot.exr", "whole"),
                  part = read_image(cut + "teapot.exr", "part");
  EXPECT_EQ(whole.raster.frame().window, display);
  EXPECT_EQ(whole.display_window, display);
  EXPECT_EQ(part.raster.frame().window, region);
  EXPECT_EQ(part.display_window, display);
  expect_same_pixels(part.raster, whole.raster, 0, 0);

  const ImageFile shown = read_image(all + "teapot.png", "whole"),
                  crop = read_image(cut + "teapot.png", "crop");
  EXPECT_EQ(crop.raster.frame().window, (Rect{0, 0, 70, 50}));  // PNG knows one window
  EXPECT_EQ(crop.display_window, crop.raster.frame().window);
  expect_same_pixels(crop.raster, shown.raster, region.x0, region.y0);
}

TEST(RegionFiles, AreCutToThePicture) {
  const test::TempFolder folder;
  const std::string cut = teapot(folder, "cut", {"--region", "190,-5,50,50"});
  const ImageFile part = read_image(cut + "teapot.exr", "part");
  EXPECT_EQ(part.raster.frame().window, (Rect{190, 0, 200, 45}));
  EXPECT_EQ(part.display_window, (Rect{0, 0, 200, 100}));
}

// Pictures of two sizes from one pass: each file gets its own rows and columns, and has the bytes that it has alone.
TEST(RegionFiles, ArePicturesOfTheirOwnSize) {
  const test::TempFolder folder;
  const std::string graph = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "ball":   { "type": "mesh.sphere" },
    "camera": { "type": "scene.camera", "params": { "resolution": [33, 17] } },
    "eye":    { "type": "project.view", "in": { "mesh": "ball", "camera": "camera" } },
    "clip":   { "type": "project.perspective", "in": { "mesh": "eye", "camera": "camera" } },
    "screen": { "type": "project.viewport", "in": { "mesh": "clip", "camera": "camera" } },
    "hits":   { "type": "rasterize.triangles", "in": { "mesh": "screen" } },
    "points": { "type": "rasterize.attributes", "in": { "hits": "hits", "mesh": "screen" } },
    "sun":    { "type": "light.directional" },
    "lit":    { "type": "shade.surface", "in": { "points": "points", "mesh": "screen", "lights": ["sun"] } },
    "large":  { "type": "image.magnify", "in": { "image": "lit" }, "params": { "factor": 3 } } },
    "outputs": { "hits":  { "from": "hits", "file": "hits.exr", "bits": 32 },
                 "large": { "from": "large", "file": "large.exr", "bits": 32 } } })");
  const auto picture = [&](const std::string& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"run", graph, "--out", folder.file("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto run = test::frustum(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return read_image(folder.file("out") + "/" + file, file).raster;
  };
  for (const std::vector<std::string>& more : {std::vector<std::string>{},
                                               {"--no-fuse"},
                                               {"--region", "20,3,30,40"},
                                               {"--no-fuse", "--region", "20,3,30,40"}}) {
    for (const std::string name : {"hits", "large"}) {
      std::vector<std::string> alone = more;
      alone.insert(alone.end(), {"--want", name});
      const Raster both = picture(name + ".exr", more), one = picture(name + ".exr", alone);
      ASSERT_EQ(both.frame().window, one.frame().window);
      const Rect& w = both.frame().window;
      for (int p = 0; p < static_cast<int>(both.frame().planes.size()); ++p)
        for (int y = w.y0; y < w.y1; ++y)
          for (int x = w.x0; x < w.x1; ++x)
            ASSERT_EQ(both.value(p, 0, x, y), one.value(p, 0, x, y))
                << name << " plane " << p << " at " << x << ", " << y;
    }
  }
}

// Pixels written as a table or as text, which go to their file whole.
TEST(RegionFiles, OfTextHoldTheRegionToo) {
  const test::TempFolder folder;
  const std::string graph = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "camera": { "type": "scene.camera", "params": { "resolution": [33, 17] } },
    "rays":   { "type": "trace.camera", "in": { "camera": "camera" } } },
    "outputs": { "table": { "from": "rays", "file": "rays.csv" }, "text": { "from": "rays", "file": "rays.json" } } })");
  const auto run = [&](const std::string& region) {
    return test::frustum({"run", graph, "--out", folder.file("out"), "--region", region});
  };
  const auto lines = [&] {
    const std::string text = text_of(folder.file("out") + "/rays.csv");
    return std::count(text.begin(), text.end(), '\n');
  };
  ASSERT_EQ(run("5,6,4,3").code, 0);
  EXPECT_EQ(lines(), 1 + 4 * 3);
  EXPECT_THAT(text_of(folder.file("out") + "/rays.json"), testing::HasSubstr("[5,6,9,9]"));
  ASSERT_EQ(run("30,-5,40,50").code, 0);
  EXPECT_EQ(lines(), 1 + 3 * 17);
  const auto outside = run("100,0,4,4");
  EXPECT_EQ(outside.code, 2);
  EXPECT_THAT(outside.err, testing::HasSubstr("error[empty_region]"));
}

}  // namespace
}  // namespace frustum
