// texture.footprint: numbers by hand, and the law of tiles. The ellipse itself: filters_test.cpp.
#include "nodes/texture/footprint.h"

#include "nodes/texture.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/texture.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

namespace frustum {
namespace {

Ref<Image> slanted_points() {
  Frame f{.window = {0, 0, 9, 5}, .planes = {{"id", PlaneKind::u32}}};
  for (const char* name : {"uv.u", "uv.v", "uv.du_dx", "uv.dv_dx", "uv.du_dy", "uv.dv_dy"})
    f.planes.push_back({name});
  Raster r(f);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) {
      r.view().row<std::uint32_t>(0, 0, y)[x] = x == 4 ? no_face : 0;
      r.view().row<float>(3, 0, y)[x] = 8.0F / 64;   // du/dx: 8 texels
      r.view().row<float>(6, 0, y)[x] = -1.0F / 32;  // dv/dy: 1 texel, y down
    }
  return std::make_shared<Image>(Image{r});
}

Ref<Texture> blank_pyramid() {
  MipPyramid p;
  for (int w = 64, h = 32;; w = std::max(1, w / 2), h = std::max(1, h / 2)) {
    p.levels.push_back({w, h, std::vector<float>(static_cast<std::size_t>(w * h) * 4, 1)});
    if (w == 1 && h == 1) break;
  }
  return std::make_shared<Texture>(Texture{std::move(p)});
}

TEST(TextureFootprintNode, CountsTexelsAndLevels) {
  for (const Precision precision : {Precision::single, Precision::real_double}) {
    const test::PixelRun run(nodes::texture_footprint(), R"({"max_anisotropy": 4})",
                             {{"points", {slanted_points()}}, {"texture", {blank_pyramid()}}}, precision);
    EXPECT_EQ(test::break_of_tile_law(run), "");
    const Raster seen = run.whole();
    const double want[] = {8, 1, 8, 0, 8, 8, 3, 0};  // trilinear goes by 8 texels; ewa by 2, one level finer
    for (int plane = 0; plane < 8; ++plane) {
      EXPECT_NEAR(std::abs(seen.value(plane, 0, 2, 1)), want[plane], 1e-5) << plane;
      EXPECT_EQ(seen.value(plane, 0, 4, 1), 0) << "nothing is seen there";
    }
  }
}

TEST(TextureFootprintNode, RefusesATextureWithoutTexels) {
  try {
    test::PixelRun(nodes::texture_footprint(), "{}",
                   {{"points", {slanted_points()}},
                    {"texture", {Ref<Texture>(std::make_shared<Texture>(Texture{Checker{}}))}}});
    FAIL();
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "no_texels");
  }
}

}  // namespace
}  // namespace frustum
