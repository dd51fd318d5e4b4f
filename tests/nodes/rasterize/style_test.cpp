// rasterize.style: three pictures of one scene, each within the silhouette.
#include "nodes/rasterize/style.h"
#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "tests/support/meshes.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

namespace frustum {
namespace {

// Two triangles that make a square of 20 px, the lower left one red, and the samples they cover.
struct Square {
  Ref<Mesh> mesh;
  Ref<Visibility> hits;
  Ref<Image> shaded;

  Square() {
    Mesh m = test::mesh_of<glm::vec4>({{6, 6, 0, 1}, {26, 6, 0, 1}, {26, 26, 0, 1}, {6, 26, 0, 1}},
                                      {{0, 2, 3}, {0, 1, 2}}, Space::screen);
    const std::uint32_t of[2] = {0, 1};
    m.columns.push_back(Column::make<std::uint32_t>("material", Domain::face, of));
    auto set = std::make_shared<MaterialSet>();
    set->materials = {Material{.diffuse = {1, 0, 0}}, Material{.diffuse = {0, 1, 0}}};
    m.materials = set;
    mesh = test::shared(m);
    const Rect window{0, 0, 32, 32};
    Raster r(Frame{.window = window, .planes = {{"id", PlaneKind::u32}, {"Z"}}});
    Raster color(Frame{.window = window, .planes = {{"R"}, {"G"}, {"B"}, {"A"}}});
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const bool in = x >= 6 && x < 26 && y >= 6 && y < 26;
        r.view().row<std::uint32_t>(0, 0, y)[x] = !in ? no_face : y > x ? 0u : 1u;
        for (int c = 0; c < 4; ++c)
          color.view().row<float>(c, 0, y)[x] = in ? 0.25F * static_cast<float>(c + 1) : 0;
      }
    hits = std::make_shared<const Visibility>(Visibility{r});
    shaded = std::make_shared<const Image>(Image{color});
  }
  test::PixelRun run(const std::string& params) const {
    return {nodes::rasterize_style(), params, {{"hits", {hits}}, {"mesh", {mesh}}, {"shaded", {shaded}}}};
  }
  bool inside(int x, int y) const { return hits->raster.at<std::uint32_t>(0, 0, x, y) != no_face; }
};

TEST(RasterizeStyle, WiresLieWithinTheSilhouetteOfWhatIsShaded) {
  const Square square;
  for (const double width : {0.5, 1.0, 2.0, 7.0}) {
    const Raster wire =
        square.run(R"({"style": "wireframe", "width": )" + std::to_string(width) + "}").whole();
    const Raster shaded = square.run(R"({"style": "shaded"})").whole();
    int wires = 0, covered = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        EXPECT_LE(wire.at<float>(3, 0, x, y), shaded.at<float>(3, 0, x, y));
        wires += wire.at<float>(3, 0, x, y) > 0, covered += shaded.at<float>(3, 0, x, y) > 0;
        // Half a width each side of the diagonal, and within half a width of the rim.
        const double rim = std::min({x - 5.5, y - 5.5, 25.5 - x, 25.5 - y}),
                     diagonal = std::abs(x - y) / std::sqrt(2.0);
        if (!square.inside(x, y)) continue;
        EXPECT_EQ(wire.at<float>(3, 0, x, y) > 0, std::min(rim, diagonal) <= width / 2) << x << " " << y;
      }
    EXPECT_EQ(covered, 400);
    EXPECT_GT(wires, 15);
    EXPECT_LT(wires, 400);
  }
}

TEST(RasterizeStyle, BlocksAreOneColourAFace) {
  const Square square;
  const Raster blocks = square.run(R"({"style": "blocked"})").whole();
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const bool red = square.inside(x, y) && y > x, green = square.inside(x, y) && y <= x;
      EXPECT_EQ(blocks.at<float>(0, 0, x, y), red ? 1 : 0);
      EXPECT_EQ(blocks.at<float>(1, 0, x, y), green ? 1 : 0);
      EXPECT_EQ(blocks.at<float>(3, 0, x, y), red || green ? 1 : 0);
    }
}

TEST(RasterizeStyle, ShadedIsWhatItIsGiven) {
  const Square square;
  EXPECT_EQ(test::first_difference(square.run(R"({"style": "shaded"})").whole(), square.shaded->raster), "");
  try {
    test::PixelRun(nodes::rasterize_style(), R"({"style": "shaded"})",
                   {{"hits", {square.hits}}, {"mesh", {square.mesh}}});
    FAIL();
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "missing_plane");
    EXPECT_EQ(e.part, "/params/style");
  }
}

TEST(RasterizeStyle, KeepsTheLawOfTiles) {
  const Square square;
  for (const char* style : {"blocked", "wireframe", "shaded"})
    EXPECT_EQ(test::break_of_tile_law(square.run(std::string(R"({"style": ")") + style + R"("})")), "")
        << style;
}

TEST(RasterizeStyle, ADegenerateFaceIsAllSide) {
  EXPECT_EQ(style::SideDistance({3, 3}, {3, 3}, {3, 3}).at({100, 5}), 0);
  EXPECT_NEAR(style::SideDistance({0, 0}, {10, 0}, {0, 10}).at({2, 3}), 2, 1e-15);
}

}  // namespace
}  // namespace frustum
