// What `run --region` writes: the files say where in the whole picture their pixels lie.
#include "runtime/io/image_files.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

namespace frustum {
namespace {

using testing::IsEmpty;

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

}  // namespace
}  // namespace frustum
