// Shadows by depths that a light's camera saw, whatever conventions and grid of corners that camera has.
#include <gtest/gtest.h>

#include "tests/support/session_run.h"

namespace frustum {
namespace {

// What of the sun reaches a scene, through its light's camera.
//   scene   the nodes "scene", "camera" and "sun"
//   at_sun  parameters of the light's camera
//   shadow  parameters of the shadow
Raster shadow_in(std::string_view scene, std::string_view at_sun, std::string_view shadow) {
  const test::TempFolder folder;
  return test::run_in_session(folder,
                              fmt::format(R"({{ "format": "frustum.graph/1", "nodes": {{ {},
    "at_sun": {{ "type": "light.camera", "in": {{ "light": "sun", "mesh": "scene" }}, "params": {{ {} }} }},
    "map":    {{ "type": "graph", "file": "lib:shadow_map_parallel",
                "in": {{ "mesh": "scene", "camera": "at_sun" }} }},
    "eye":    {{ "type": "project.view", "in": {{ "mesh": "scene", "camera": "camera" }} }},
    "clip":   {{ "type": "project.perspective", "in": {{ "mesh": "eye", "camera": "camera" }} }},
    "cut":    {{ "type": "clip.homogeneous", "in": {{ "mesh": "clip" }} }},
    "screen": {{ "type": "project.viewport", "in": {{ "mesh": "cut", "camera": "camera" }} }},
    "hits":   {{ "type": "rasterize.triangles", "in": {{ "mesh": "screen" }} }},
    "points": {{ "type": "rasterize.attributes", "in": {{ "hits": "hits", "mesh": "screen" }} }},
    "shadow": {{ "type": "shade.shadow_map", "in": {{ "points": "points", "mesh": "screen", "lights": ["sun"],
                "maps": ["map"], "cameras": ["at_sun"] }}, "params": {{ {} }} }} }} }})",
                                          scene, at_sun, shadow),
                              {"shadow"})
      .image();
}

// A tilted plate over a floor, seen from above; both turned, so that corners fall between the points of any grid.
Raster shadow_of(std::string_view at_sun) {
  return shadow_in(R"(
    "floor":  { "type": "mesh.grid", "params": { "size": [8, 8], "segments": [3, 3] } },
    "plate":  { "type": "mesh.grid", "params": { "size": [2.1, 1.7] } },
    "raised": { "type": "transform.affine", "in": { "geometry": "plate" },
                "params": { "steps": [ { "rotate": { "axis": [1, 0, 2], "degrees": 31 } },
                                       { "translate": [0.2, 1.9, -0.1] } ] } },
    "both":   { "type": "mesh.merge", "in": { "meshes": ["floor", "raised"] } },
    "scene":  { "type": "transform.affine", "in": { "geometry": "both" },
                "params": { "steps": [ { "rotate": { "axis": [0.1, 1, 0.05], "degrees": 17 } } ] } },
    "camera": { "type": "scene.camera", "params": { "eye": [1, 9, 4], "resolution": [160, 120] } },
    "sun":    { "type": "light.directional", "params": { "direction": [-0.7, -1, 0.3] } })",
                   at_sun, "");
}

struct Lit {
  int lit = 0, dark = 0, different = 0;
};

Lit compared(const Raster& a, const Raster& b) {
  Lit n;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const float v = a.at<float>(0, 0, x, y);
      n.lit += v == 1, n.dark += v == 0, n.different += v != b.at<float>(0, 0, x, y);
    }
  return n;
}

TEST(LightCameraConventions, GiveTheSameShadows) {
  const Raster gl = shadow_of(R"("size": 256)");
  for (const char* api : {"vulkan", "d3d"}) {
    const Lit n = compared(shadow_of(fmt::format(R"("size": 256, "conventions": "{}")", api)), gl);
    EXPECT_GT(n.lit, 8000) << api;
    EXPECT_GT(n.dark, 500) << api;
    // Depths of a range half as deep round otherwise, which edges of texels may show.
    EXPECT_LE(n.different, 4) << api;
  }
}

// Where corners snap to sixteenths of a texel, planes still do not shade themselves: only the shadow's edge moves.
TEST(LightCameraConventions, OnACoarseGridPlanesDoNotShadeThemselves) {
  const Raster fine = shadow_of(R"("size": 256, "subpixel_bits": 8)");
  const auto moved = [&](int bits) {
    return compared(shadow_of(fmt::format(R"("size": 256, "subpixel_bits": {})", bits)), fine).different;
  };
  EXPECT_GT(moved(4), 0) << "the grid is the one that was asked for";
  for (const int bits : {4, 5, 6}) EXPECT_LE(moved(bits), 40) << bits;
}

// All of the picture is one plane, which nothing shades. Of the tolerance half a texel of its slope is used up where a
// point is seen in the corner of a texel; snapping moves what the map has there by up to half a step of the grid, 1/32
// texel of 4 bits. Without slope * step in the tolerance 38 points are dark, and 14 of 5 bits.
TEST(LightCameraConventions, TheStepOfACoarseGridIsPartOfTheTolerance) {
  for (const int bits : {4, 5}) {
    const Raster seen = shadow_in(R"(
    "grid":   { "type": "mesh.grid", "params": { "size": [8, 8], "segments": [23, 19] } },
    "scene":  { "type": "transform.affine", "in": { "geometry": "grid" },
                "params": { "steps": [ { "rotate": { "axis": [0.1, 1, 0.05], "degrees": 17 } } ] } },
    "camera": { "type": "scene.camera", "params": { "eye": [0.3, 6, 1], "resolution": [160, 120] } },
    "sun":    { "type": "light.directional", "params": { "direction": [-2, -1, 0.3] } })",
                                  fmt::format(R"("size": 64, "subpixel_bits": {})", bits), R"("radius": 0)");
    const Lit n = compared(seen, seen);
    EXPECT_EQ(n.lit, 160 * 120) << bits;
  }
}

}  // namespace
}  // namespace frustum
