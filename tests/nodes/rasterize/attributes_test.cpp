#include "nodes/rasterize/attributes.h"

#include <gtest/gtest.h>

#include "nodes/rasterize.h"
#include "tests/nodes/rasterize/screen_mesh.h"

namespace frustum {
namespace {

using test::buffer_of;
using test::ScreenMeshMaker;

// A quad at distances 1 (left) and 3 (right) over 8 x 8 pixels, with all the columns that have planes of
// their own.
template <class R>
std::shared_ptr<Mesh> quad() {
  ScreenMeshMaker<R> m;
  for (const double y : {0.5, 8.5})
    for (const double x : {0.5, 8.5}) m.vertex(x, y, 0.5, x < 1 ? 1 : 1 / 3.0);
  m.face = {{0, 1, 2}, {1, 3, 2}};
  auto mesh = m.make({12, 9});
  using vec2 = glm::vec<2, R>;
  using vec3 = glm::vec<3, R>;
  const std::vector<vec2> uv{{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  const std::vector<vec3> normal(4, vec3(R(0.6), 0, R(0.8))),
      world{{0, 0, 0}, {1, 0, 2}, {0, 1, 0}, {1, 1, 2}};
  const std::vector<R> heat{1, 2, 3, 4};
  const std::vector<vec2> lobe{{5, 6}, {7, 8}};
  mesh->columns.push_back(Column::make("uv", Domain::vertex, std::span<const vec2>(uv)));
  mesh->columns.push_back(
      Column::make("normal", Domain::vertex, std::span<const vec3>(normal), Space::world));
  mesh->columns.push_back(Column::make("world", Domain::vertex, std::span<const vec3>(world), Space::world));
  mesh->columns.push_back(Column::make("heat", Domain::vertex, std::span<const R>(heat)));
  mesh->columns.push_back(Column::make("lobe", Domain::face, std::span<const vec2>(lobe)));
  return mesh;
}

Raster points(const std::shared_ptr<Mesh>& mesh, const char* interpolation,
              Precision precision = Precision::single, int edge = 0) {
  Context ctx = test::with_precision(precision);
  const auto hits =
      test::run_node(nodes::rasterize_triangles(), nlohmann::json::object(), {{buffer_of(mesh)}, {}}, &ctx);
  const auto out = test::run_node(nodes::rasterize_attributes(), {{"interpolation", interpolation}},
                                  {{hits[0]}, {buffer_of(mesh)}}, &ctx, {}, edge);
  return out[0].as<Image>()->raster;
}

double at(const Raster& r, const char* plane, int x, int y) {
  return r.value(*r.frame().find(plane), 0, x, y);
}

TEST(RasterizeAttributes, HalfwayOnTheScreenIsAQuarterOfTheWayInTheScene) {
  const Raster hyperbolic = points(quad<double>(), "hyperbolic", Precision::real_double);
  // At the middle of the edge from w = 1 to w = 3: u = (1/2 * 1/3) / (1/2 * 1 + 1/2 * 1/3), w = 1 / (2/3).
  EXPECT_NEAR(at(hyperbolic, "uv.u", 4, 0), 0.25, 1e-15);
  EXPECT_NEAR(at(hyperbolic, "w", 4, 0), 1.5, 1e-15);
  EXPECT_NEAR(at(hyperbolic, "P.z", 4, 0), 0.5, 1e-15);
  EXPECT_NEAR(at(hyperbolic, "heat", 4, 0), 1.25, 1e-15);
  // u(t) = (t/3) / (1 - 2t/3) with t = x / 8: du/dt = (1/3) / (1 - 2t/3)^2 = 3/4.
  EXPECT_NEAR(at(hyperbolic, "uv.du_dx", 4, 0), 0.75 / 8, 1e-15);
  EXPECT_NEAR(at(hyperbolic, "uv.dv_dx", 4, 0), 0, 1e-15);
  // Along the column w stays 1.5, and v covers 1 in 8 px where both corners are equally far.
  EXPECT_NEAR(at(hyperbolic, "uv.dv_dy", 0, 4), 1.0 / 8, 1e-15);
  const Raster affine = points(quad<double>(), "affine", Precision::real_double);
  EXPECT_NEAR(at(affine, "uv.u", 4, 0), 0.5, 1e-15);
  EXPECT_NEAR(at(affine, "uv.du_dx", 4, 0), 1.0 / 8, 1e-15);
}

TEST(RasterizeAttributes, ConstantsKeepTheirBitsAndNothingSeenIsZero) {
  const Raster r = points(quad<float>(), "hyperbolic");
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 12; ++x) {
      const bool seen = r.at<std::uint32_t>(0, 0, x, y) != no_face;
      EXPECT_EQ(seen, x < 8 && y < 8);
      EXPECT_EQ(at(r, "N.x", x, y), seen ? static_cast<double>(0.6f) : 0.0);
      EXPECT_EQ(at(r, "N.z", x, y), seen ? static_cast<double>(0.8f) : 0.0);
      EXPECT_EQ(at(r, "lobe.y", x, y), !seen ? 0.0 : r.at<std::uint32_t>(0, 0, x, y) == 0 ? 6.0 : 8.0);
      if (!seen) {
        EXPECT_EQ(at(r, "w", x, y), 0.0);
      }
    }
}

TEST(RasterizeAttributes, HasOnlyThePlanesOfTheMesh) {
  ScreenMeshMaker<float> m;
  for (const glm::vec2 p : {glm::vec2(0, 0), {4, 0}, {0, 4}}) m.vertex(p.x, p.y);
  m.face = {{0, 1, 2}};
  const Raster r = points(m.make({4, 4}), "hyperbolic");
  EXPECT_EQ(r.frame().planes, (PlaneList{{"id", PlaneKind::u32}, {"w", PlaneKind::f32}}));
  const Raster all = points(quad<double>(), "affine", Precision::real_double);
  std::vector<std::string> names;
  for (const Plane& p : all.frame().planes) names.push_back(p.name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"id",       "uv.u",    "uv.v",    "uv.du_dx", "uv.dv_dx", "uv.du_dy",
                                      "uv.dv_dy", "N.x",     "N.y",     "N.z",      "P.x",      "P.y",
                                      "P.z",      "P.dx_dx", "P.dy_dx", "P.dz_dx",  "P.dx_dy",  "P.dy_dy",
                                      "P.dz_dy",  "heat",    "lobe.x",  "lobe.y",   "w"}));
}

TEST(RasterizeAttributes, HitsOfAnotherMeshAreRefused) {
  const auto big = quad<float>();
  ScreenMeshMaker<float> m;
  for (const glm::vec2 p : {glm::vec2(0, 0), {4, 0}, {0, 4}}) m.vertex(p.x, p.y);
  m.face = {{0, 1, 2}};
  const auto hits =
      test::run_node(nodes::rasterize_triangles(), nlohmann::json::object(), {{buffer_of(big)}, {}});
  const auto error = test::run_error(nodes::rasterize_attributes(), nlohmann::json::object(),
                                     {{hits[0]}, {buffer_of(m.make({12, 9}))}});
  EXPECT_EQ(error.first, "wrong_mesh");
  EXPECT_EQ(error.second, "face 1 is seen, but the mesh has 1 faces: the hits are of another mesh");
}

TEST(RasterizeAttributes, TilesOfAnySizeGiveTheSameBytes) {
  for (const Precision precision : {Precision::single, Precision::real_double}) {
    const auto mesh = precision == Precision::single ? quad<float>() : quad<double>();
    const Raster whole = points(mesh, "hyperbolic", precision);
    for (const int edge : {1, 5, 16}) {
      const Raster tiled = points(mesh, "hyperbolic", precision, edge);
      for (int plane = 0; plane < static_cast<int>(whole.frame().planes.size()); ++plane)
        for (int y = 0; y < 9; ++y)
          for (int x = 0; x < 12; ++x)
            ASSERT_EQ(tiled.value(plane, 0, x, y), whole.value(plane, 0, x, y)) << edge;
    }
  }
}

}  // namespace
}  // namespace frustum
