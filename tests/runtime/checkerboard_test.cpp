// Pictures with alpha, in thumbnails and on pages, lie on a checkerboard: transparent is told from black.
#include "runtime/app/export.h"
#include "runtime/app/sweep/pictures.h"
#include "runtime/buffers/image.h"
#include "tests/support/browser.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>

namespace frustum {
namespace {

using nlohmann::json;
using test::TempFolder;

double encode(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }
double decode(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
int byte(double light) { return static_cast<int>(std::lround(255 * encode(light))); }

// One row of grey pixels: the light of each, not multiplied, and how much it covers.
struct Grey {
  double light, alpha;
};
constexpr Grey row[] = {{0, 0}, {0, 1}, {1, 0.5}, {0.25, 0.25}, {1, 1}, {0, 0}, {1, 0}, {0.5, 1}};
constexpr int count = 8;

// What an eye sees: squares of one pixel, the darker first.
std::vector<int> seen() {
  std::vector<int> out;
  for (int x = 0; x < count; ++x) {
    const double back = decode((x % 2 == 0 ? 153 : 204) / 255.0);
    out.push_back(byte(row[x].light * row[x].alpha + (1 - row[x].alpha) * back));
  }
  return out;
}

Raster picture(bool encoded, Alpha alpha) {
  Frame frame;
  frame.window = {0, 0, count, 1};
  for (const char* plane : {"R", "G", "B", "A"}) frame.planes.push_back({plane, PlaneKind::f32});
  frame.color_space = encoded ? "srgb" : "lin_rec709";
  frame.alpha = alpha;
  Raster raster(frame);
  for (int x = 0; x < count; ++x) {
    const double value = encoded ? encode(row[x].light) : row[x].light;
    const double stored = alpha == Alpha::premultiplied ? value * row[x].alpha : value;
    for (int p = 0; p < 3; ++p) raster.view().row<float>(p, 0, 0)[x] = static_cast<float>(stored);
    raster.view().row<float>(3, 0, 0)[x] = static_cast<float>(row[x].alpha);
  }
  return raster;
}

TEST(Checkerboard, StandsBehindThumbnailsHoweverColoursAreStored) {
  const TempFolder folder;
  for (const bool encoded : {false, true})
    for (const Alpha alpha : {Alpha::straight, Alpha::premultiplied}) {
      const Buffer buffer = std::make_shared<const Image>(Image{picture(encoded, alpha)});
      save_pictures(folder.path(), "small", buffer, nullptr);
      const Raster small = load_raster(folder.file("small.png"));
      ASSERT_EQ(small.frame().window, (Rect{0, 0, count, 1}));
      for (int x = 0; x < count; ++x)
        for (int p = 0; p < 3; ++p)
          EXPECT_NEAR(255 * small.value(p, 0, x, 0), seen()[static_cast<std::size_t>(x)], 1)
              << "x " << x << (encoded ? " encoded" : " linear")
              << (alpha == Alpha::straight ? " straight" : " premultiplied");
    }
}

TEST(Checkerboard, AThumbnailWithoutAlphaHasNone) {
  const TempFolder folder;
  Raster black = picture(false, Alpha::none);
  for (int p = 0; p < 4; ++p)
    for (int x = 0; x < count; ++x) black.view().row<float>(p, 0, 0)[x] = 0;
  save_pictures(folder.path(), "small", std::make_shared<const Image>(Image{std::move(black)}), nullptr);
  const Raster small = load_raster(folder.file("small.png"));
  for (int x = 0; x < count; ++x) EXPECT_EQ(small.value(0, 0, x, 0), 0);
}

TEST(Checkerboard, StandsBehindThePicturesOfAReport) {
  const TempFolder folder;
  save_raster(picture(false, Alpha::premultiplied), folder.file("linear.exr"));
  save_raster(picture(true, Alpha::straight), folder.file("straight.png"));
  const auto graph = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "linear":   { "type": "io.load_image", "params": { "file": "linear.exr" } },
    "straight": { "type": "io.load_image", "params": { "file": "straight.png" } },
    "encoded":  { "type": "color.convert", "in": { "image": "linear" }, "params": { "to": "srgb" } } } })");
  const auto made = test::frustum({"report", graph, "--all", "-o", folder.file("page.html")});
  ASSERT_EQ(made.code, 0) << made.err;
  test::Browser browser;
  browser.size(1280, 900);
  browser.open("file://" + folder.file("page.html"));
  for (const char* port : {"linear.image", "straight.image", "encoded.image"}) {
    const json bytes = browser.evaluate("(async () => { const c = document.getElementById('buffer-" +
                                        std::string(port) + R"('); c.scrollIntoView();
      const viewer = c.querySelector(".viewer");
      for (let i = 0; viewer.dataset.ready !== "true"; ++i) {
        if (i > 600) throw new Error("it was never drawn");
        await new Promise((f) => setTimeout(f, 50));
      }
      return [...c.querySelector("canvas").getContext("2d").getImageData(0, 0, 8, 1).data].filter((_, i) => i % 4 == 1);
    })())");
    ASSERT_EQ(bytes.size(), static_cast<std::size_t>(count)) << port;
    for (std::size_t x = 0; x < bytes.size(); ++x)
      EXPECT_NEAR(bytes[x].get<int>(), seen()[x], 2) << port << " x " << x << ' ' << bytes;
  }
  EXPECT_THAT(browser.complaints(), testing::IsEmpty());
}

}  // namespace
}  // namespace frustum
