// texture.inverse: the camera's own picture of a plane, samples, and planes that nobody reads.
#include "nodes/texture/inverse.h"

#include "nodes/texture.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/quad.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

namespace frustum {
namespace {

// A floor seen by a camera 1 above it that looks along -z: x_px = 32 + 32 x / -z, y_px = 32 + 32 / -z.
const glm::dmat4 camera(32, 0, 0, 0, 0, -32, 0, 0, -32, -32, 0, -1, 0, 0, 0, 0);

Ref<Points> floor_corners() {
  auto p = std::make_shared<Points>();
  p->at = {{-1, -1, -1.5}, {1, -1, -1.5}, {1, -1, -6}, {-1, -1, -6}};
  return p;
}

TEST(TextureInverse, FindsWhereTheRayThroughAPixelMeetsThePlane) {
  const test::PixelRun run(
      nodes::texture_inverse(), R"({"resolution": [64, 64]})",
      {{"corners", {floor_corners()}}, {"matrix", {Ref<Matrix>(std::make_shared<Matrix>(Matrix{camera}))}}},
      Precision::real_double);
  EXPECT_EQ(test::break_of_tile_law(run), "");
  const Raster seen = run.whole();
  int inside = 0;
  double affine = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      if (seen.at<std::uint32_t>(0, 0, x, y) == no_face) continue;
      ++inside;
      const double z = -32 / (y + 0.5 - 32), world_x = (x + 0.5 - 32) / 32 * -z;  // the ray meets y = -1
      EXPECT_NEAR(seen.at<double>(1, 0, x, y), (world_x + 1) / 2, 1e-14);
      EXPECT_NEAR(seen.at<double>(2, 0, x, y), (-1.5 - z) / 4.5, 1e-14);
      EXPECT_NEAR(seen.at<double>(6, 0, x, y), z * z / 32 / -4.5, 1e-13) << "dv/dy";
      // Linear on the screen between the near row (v = 0) and the far row (v = 1), as without the divide.
      const double near_row = 32 + 32 / 1.5, far_row = 32 + 32 / 6.0;
      affine = std::max(affine, std::fabs((near_row - (y + 0.5)) / (near_row - far_row) - (-1.5 - z) / 4.5));
    }
  EXPECT_GT(inside, 300);
  EXPECT_GT(affine, 0.25) << "what is linear on the screen is far off";
}

TEST(TextureInverse, SamplesHaveTheirOwnPlaces) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = 2;
  pattern->x = {1024, 3072}, pattern->y = {1024, 3072};
  auto corners = std::make_shared<Points>();
  corners->at = {{0, 8, 0}, {8, 8, 0}, {8, 0, 0}, {0, 0, 0}};
  const test::PixelRun run(nodes::texture_inverse(), R"({"resolution": [8, 8]})",
                           {{"corners", {Ref<Points>(corners)}}, {"pattern", {Ref<SamplePattern>(pattern)}}});
  EXPECT_EQ(test::break_of_tile_law(run), "");
  const Raster seen = run.whole();
  EXPECT_EQ(seen.at<float>(1, 0, 3, 2), 3.25F / 8);
  EXPECT_EQ(seen.at<float>(1, 1, 3, 2), 3.75F / 8);
  EXPECT_EQ(seen.at<float>(2, 1, 3, 2), 1 - 2.75F / 8);
  EXPECT_EQ(seen.at<float>(3, 1, 3, 2), 0.125F);
  EXPECT_EQ(seen.at<float>(6, 1, 3, 2), -0.125F);
}

}  // namespace
}  // namespace frustum
