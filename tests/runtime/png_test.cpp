// Pictures that app writes itself are read back by OpenImageIO as they were.
#include "runtime/app/png.h"

#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "tests/support/temp_file.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace frustum {
namespace {

TEST(Png, IsReadBackAsItWas) {
  std::mt19937 random(1);
  const test::TempFolder folder;
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(7, 1), std::pair(1, 5), std::pair(320, 180)}) {
    std::vector<std::uint8_t> rgb(3 * static_cast<std::size_t>(width * height));
    for (std::uint8_t& v : rgb) v = static_cast<std::uint8_t>(random() % 256);
    write_text(folder.file("p.png"), png_file(width, height, rgb));
    const Buffer image = load_buffer(folder.file("p.png"));
    const Raster& raster = image.type().raster(image.data());
    ASSERT_EQ(raster.frame().window, (Rect{0, 0, width, height}));
    for (std::size_t i = 0; i < rgb.size(); ++i) {
      const int pixel = static_cast<int>(i / 3), plane = static_cast<int>(i % 3);
      ASSERT_EQ(std::lround(255 * raster.value(plane, 0, pixel % width, pixel / width)), rgb[i])
          << width << " x " << height << " at " << i;
    }
  }
}

}  // namespace
}  // namespace frustum
