// The conventions of OpenGL, Vulkan and Direct3D from the camera to the picture: other numbers on the way, the same
// picture in the end.
#include "nodes/clip.h"
#include "nodes/cull.h"
#include "nodes/mesh.h"
#include "nodes/project.h"
#include "nodes/rasterize.h"
#include "nodes/visibility.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/minification.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/value.h"
#include "tests/nodes/rasterize/screen_mesh.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <cstring>

namespace frustum {
namespace {

constexpr Conventions all[] = {Conventions::gl, Conventions::vulkan, Conventions::d3d};
constexpr glm::ivec2 size{80, 60};

Ref<Camera> camera(Conventions conventions, bool reversed_z = false, double near_z = 0.5) {
  auto c = std::make_shared<Camera>();
  c->eye = {1, 1.5, 4}, c->target = {0, 0.2, 0}, c->resolution = size;
  c->near_z = near_z, c->far_z = 20;
  c->conventions = conventions, c->reversed_z = reversed_z;
  return c;
}

// A mesh on its way to the screen.
struct Stages {
  Ref<Mesh> clip, cut, screen;
  Buffer hits;

  Stages(const Ref<Mesh>& mesh, const Ref<Camera>& c, Precision precision, bool culled,
         const NodeType& projection = nodes::project_perspective()) {
    const auto run = [&](const NodeType& type, const test::NodeInputs& in) {
      Context ctx = test::with_precision(precision);
      return test::run_node(type, Json::object(), in, &ctx).at(0);
    };
    const Buffer eye = run(nodes::project_view(), {{mesh}, {c}});
    clip = run(projection, {{eye}, {c}}).as<Mesh>();
    cut = run(nodes::clip_homogeneous(), {{clip}}).as<Mesh>();
    if (culled) cut = run(nodes::cull_backface(), {{cut}, {}}).as<Mesh>();
    screen = run(nodes::project_viewport(), {{cut}, {c}}).as<Mesh>();
    hits = run(nodes::rasterize_triangles(), {{screen}, {}});
  }
  const Raster& picture() const { return hits.as<Visibility>()->raster; }
};

// Triangles in front of the camera, behind it and across its planes.
template <class R>
Ref<Mesh> soup(test::Random& random, int faces) {
  using Point = glm::vec<3, R>;
  std::vector<Point> position;
  std::vector<glm::uvec3> triangle;
  for (int f = 0; f < faces; ++f) {
    const glm::dvec3 middle(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-4, 5));
    const auto first = static_cast<std::uint32_t>(position.size());
    for (int k = 0; k < 3; ++k)
      position.emplace_back(middle +
                            glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
    triangle.emplace_back(first, first + 1, first + 2);
  }
  return test::shared(test::mesh_of(position, triangle, Space::world));
}

int differing_ids(const Raster& a, const Raster& b) {
  int n = 0;
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) n += a.at<std::uint32_t>(0, 0, x, y) != b.at<std::uint32_t>(0, 0, x, y);
  return n;
}
int seen(const Raster& a) {
  int n = 0;
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) n += a.at<std::uint32_t>(0, 0, x, y) != no_face;
  return n;
}

// The corners of the view volume in NDC, as each specification has them.
TEST(Conventions, MapTheViewVolumeAsStated) {
  struct Stated {
    Conventions conventions;
    bool reversed_z;
    double near_z, far_z, top;
  };
  for (const Stated& s :
       {Stated{Conventions::gl, false, -1, 1, 1}, Stated{Conventions::vulkan, false, 0, 1, -1},
        Stated{Conventions::d3d, false, 0, 1, 1}, Stated{Conventions::gl, true, 1, 0, 1},
        Stated{Conventions::vulkan, true, 1, 0, -1}, Stated{Conventions::d3d, true, 1, 0, 1}})
    for (const bool perspective : {true, false}) {
      const auto c = camera(s.conventions, s.reversed_z);
      const double tangent = perspective ? std::tan(c->fov_y / 2) : 0;
      std::vector<glm::dvec3> corner;
      for (const double z : {c->near_z, c->far_z})
        for (const double y : {-1.0, 1.0})
          for (const double x : {-1.0, 1.0}) {
            const double half = perspective ? tangent * z : c->height / 2;
            corner.emplace_back(x * half * c->aspect(), y * half, -z);
          }
      Context ctx = test::with_precision(Precision::real_double);
      const NodeType type = perspective ? nodes::project_perspective() : nodes::project_orthographic();
      const Buffer eye(test::shared(test::mesh_of(corner, {}, Space::eye)));
      const Buffer clip = test::run_node(type, Json::object(), {{eye}, {c}}, &ctx).at(0);
      const auto ndc = test::column<glm::dvec3>(
          *test::run_node(nodes::project_divide(), Json::object(), {{clip}}, &ctx).at(0).as<Mesh>(),
          "position");
      for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_NEAR(ndc[i].x, (i & 1) != 0 ? 1 : -1, 1e-14);
        EXPECT_NEAR(ndc[i].y, (i & 2) != 0 ? s.top : -s.top, 1e-14);
        EXPECT_NEAR(ndc[i].z, (i & 4) != 0 ? s.far_z : s.near_z, 1e-14);
      }
    }
}

// Vulkan differs from Direct3D by the sign of y in clip space, which is exact: the same bits on the screen, of cut and of
// culled faces alike.
template <class R>
void expect_vulkan_is_d3d(Precision precision) {
  test::Random random(17);
  for (int round = 0; round < 12; ++round) {
    const auto mesh = soup<R>(random, 60);
    const bool reversed = round % 2 == 1, culled = round % 3 != 0;
    const NodeType projection = round % 4 == 3 ? nodes::project_orthographic() : nodes::project_perspective();
    const Stages vulkan(mesh, camera(Conventions::vulkan, reversed), precision, culled, projection),
        d3d(mesh, camera(Conventions::d3d, reversed), precision, culled, projection);
    ASSERT_TRUE(test::same_bytes(*vulkan.screen, *d3d.screen)) << round;
    ASSERT_EQ(differing_ids(vulkan.picture(), d3d.picture()), 0);
    ASSERT_GT(seen(d3d.picture()), 100);
    ASSERT_GT(vulkan.screen->faces(), 2U);
    const auto a = test::column<glm::vec<4, R>>(*vulkan.clip, "position"),
               b = test::column<glm::vec<4, R>>(*d3d.clip, "position");
    for (std::size_t i = 0; i < a.size(); ++i)
      ASSERT_EQ(a[i], (glm::vec<4, R>(b[i].x, -b[i].y, b[i].z, b[i].w)));
  }
}
TEST(Conventions, VulkansScreenIsDirect3DsBitForBit) {
  expect_vulkan_is_d3d<float>(Precision::single);
  expect_vulkan_is_d3d<double>(Precision::real_double);
}

// OpenGL's depth rounds otherwise, so that faces nearer to each other than rounding may change places. Between balls that
// do not touch there are none, nor among random triangles in double.
TEST(Conventions, AllShowTheSameFaces) {
  test::Random random(18);
  for (int round = 0; round < 6; ++round) {
    const auto mesh = soup<double>(random, 60);
    const Stages gl(mesh, camera(Conventions::gl, false, 2.5), Precision::real_double, round % 2 == 0),
        d3d(mesh, camera(Conventions::d3d, false, 2.5), Precision::real_double, round % 2 == 0);
    EXPECT_EQ(differing_ids(gl.picture(), d3d.picture()), 0) << round;
  }
  const Ref<Mesh> ring = test::shared(test::torus(40, 20));
  const Stages gl(ring, camera(Conventions::gl), Precision::single, true);
  for (const Conventions c : all)
    for (const bool reversed : {false, true}) {
      const Stages other(ring, camera(c, reversed), Precision::single, true);
      EXPECT_EQ(differing_ids(gl.picture(), other.picture()), 0);
      EXPECT_EQ(gl.screen->faces(), other.screen->faces());
    }
  EXPECT_GT(seen(gl.picture()), 500);
}

// A front face is a front face in every space, whichever way its y points.
TEST(Conventions, BackFacesAreTheSameInEverySpace) {
  const Ref<Mesh> ring = test::shared(test::torus(20, 10));
  std::vector<std::size_t> kept;
  for (const Conventions c : all) {
    const Stages s(ring, camera(c), Precision::single, false);
    const Buffer ndc = test::run_node(nodes::project_divide(), Json::object(), {{s.clip}}).at(0);
    for (const Buffer& mesh : {Buffer(s.clip), ndc, Buffer(s.screen)})
      kept.push_back(
          test::run_node(nodes::cull_backface(), Json::object(), {{mesh}, {}}).at(0).as<Mesh>()->faces());
  }
  for (const std::size_t n : kept) EXPECT_EQ(n, kept[0]);
  EXPECT_GT(kept[0], 20U);
  EXPECT_LT(kept[0], 380U);
}

TEST(Conventions, ReasonsEdgesAndCulledFacesAreTheSame) {
  test::Random random(19);
  for (int round = 0; round < 3; ++round) {
    const auto mesh = soup<double>(random, 80);
    std::vector<std::vector<std::uint32_t>> reasons;
    std::vector<std::size_t> inside;
    std::vector<Raster> lines;
    for (const Conventions c : all) {
      const Stages s(mesh, camera(c), Precision::real_double, true);
      Context ctx = test::with_precision(Precision::real_double);
      const auto classified = test::run_node(nodes::visibility_classify(), Json::object(),
                                             {{s.clip}, {s.screen}, {s.hits}}, &ctx);
      reasons.push_back(test::column<std::uint32_t>(*classified.at(1).as<Mesh>(), "reason"));
      inside.push_back(
          test::run_node(nodes::cull_frustum(), Json::object(), {{s.clip}}, &ctx).at(0).as<Mesh>()->faces());
      const test::NodeInputs in = {{s.clip}, {s.hits}, {s.screen}, {}, {}};
      lines.push_back(
          test::run_node(nodes::rasterize_wireframe(), Json::object(), in, &ctx).at(0).as<Image>()->raster);
    }
    for (std::size_t i = 1; i < 3; ++i) {
      EXPECT_EQ(reasons[i], reasons[0]);
      EXPECT_EQ(inside[i], inside[0]);
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
          EXPECT_NEAR(lines[i].value(3, 0, x, y), lines[0].value(3, 0, x, y), 1e-9);
    }
    EXPECT_LT(inside[0], mesh->faces());
  }
}

// The rows of the whole matrix that say where on the screen a point is do not depend on the API.
TEST(Conventions, TheWholeMatrixLeadsToTheSamePixels) {
  std::vector<glm::dmat4> m;
  for (const Conventions c : all)
    m.push_back(
        test::run_node(nodes::project_mvp(), Json::object(), {{camera(c)}, {}}).at(0).as<Matrix>()->value);
  for (std::size_t i = 1; i < 3; ++i)
    for (glm::length_t column = 0; column < 4; ++column)
      for (const glm::length_t row : {0, 1, 3}) EXPECT_EQ(m[i][column][row], m[0][column][row]);
  EXPECT_NE(m[1][3][2], m[0][3][2]);
}

TEST(Conventions, AViewportRefusesAnotherClipSpace) {
  const Stages s(test::shared(test::torus(8, 6)), camera(Conventions::gl), Precision::single, false);
  const auto error = [&](const Ref<Camera>& c) {
    return test::run_error(nodes::project_viewport(), Json::object(), {{s.clip}, {c}}).first;
  };
  EXPECT_EQ(error(camera(Conventions::gl)), "");
  EXPECT_EQ(error(camera(Conventions::vulkan)), "conventions_differ");
  EXPECT_EQ(error(camera(Conventions::d3d)), "conventions_differ");
  EXPECT_EQ(error(camera(Conventions::gl, true)), "conventions_differ");
}

// ----- bits below the pixel

// Whether the middle of a pixel is in a triangle whose corners are whole multiples of 2^-bits px, by the rule of Direct3D,
// Vulkan and OpenGL, in integers: on a top or a left edge it is.
bool covers(std::array<glm::i64vec2, 3> p, int bits, int x, int y) {
  const std::int64_t unit = std::int64_t{1} << bits, px = 2 * x + 1, py = 2 * y + 1;  // halves of pixels
  const auto cross = [](glm::i64vec2 a, glm::i64vec2 b) { return a.x * b.y - a.y * b.x; };
  const std::int64_t area = cross(p[1] - p[0], p[2] - p[0]);
  if (area == 0) return false;
  if (area < 0) std::swap(p[1], p[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::i64vec2 a = p[k], d = p[(k + 1) % 3] - a;
    const std::int64_t side = cross(d, glm::i64vec2(px * unit - 2 * a.x, py * unit - 2 * a.y));
    const bool top_or_left = d.y < 0 || (d.y == 0 && d.x > 0);
    if (side < 0 || (side == 0 && !top_or_left)) return false;
  }
  return true;
}

template <class R>
void expect_grid(Precision precision, int bits) {
  test::Random random(20);
  int covered = 0, moved = 0;
  for (int round = 0; round < 300; ++round) {
    test::ScreenMeshMaker<R> m;
    std::array<glm::i64vec2, 3> corner, fine;
    for (std::size_t k = 0; k < 3; ++k) {
      m.vertex(random.uniform(-2, 18), random.uniform(-2, 18));
      const double x = static_cast<double>(m.position[k].x), y = static_cast<double>(m.position[k].y);
      corner[k] = {std::llrint(std::ldexp(x, bits)), std::llrint(std::ldexp(y, bits))};  // halves to even
      fine[k] = {std::llrint(x * 256), std::llrint(y * 256)};
    }
    m.face.emplace_back(0, 1, 2);
    Context ctx = test::with_precision(precision);
    const Buffer mesh = test::buffer_of(m.make({16, 16}, false, bits));
    const Buffer hits =
        test::run_node(nodes::rasterize_triangles(), Json::object(), {{mesh}, {}}, &ctx).at(0);
    const Raster& got = hits.template as<Visibility>()->raster;
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        const bool want = covers(corner, bits, x, y);
        ASSERT_EQ(got.at<std::uint32_t>(0, 0, x, y) == 0U, want) << round;
        covered += want ? 1 : 0;
        moved += want != covers(fine, 8, x, y) ? 1 : 0;
      }
  }
  EXPECT_GT(covered, 1000);
  EXPECT_GT(moved, bits == 4 ? 10 : -1);
}
TEST(SubpixelBits, AreTheGridOfTheCamera) {
  for (const int bits : {4, 6, 8}) {
    expect_grid<float>(Precision::single, bits);
    expect_grid<double>(Precision::real_double, bits);
  }
}

// Attributes are those of the face as it was drawn: what is linear in the snapped corners is met.
TEST(SubpixelBits, AttributesFollowTheSnappedCorners) {
  for (const int bits : {4, 8}) {
    test::ScreenMeshMaker<double> m;
    m.vertex(0.29, 0.03), m.vertex(15.22, 2.11), m.vertex(3.47, 15.9);
    m.face.emplace_back(0, 1, 2);
    std::vector<double> across;
    for (const auto& p : m.position)
      across.push_back(std::ldexp(std::nearbyint(std::ldexp(p.x, bits)), -bits));
    auto mesh = m.make({16, 16}, false, bits);
    mesh->columns.push_back(Column::make<double>("across", Domain::vertex, across));
    Context ctx = test::with_precision(Precision::real_double);
    const Buffer drawn = test::buffer_of(std::move(mesh));
    const auto hits = test::run_node(nodes::rasterize_triangles(), Json::object(), {{drawn}, {}}, &ctx);
    const Raster points =
        test::run_node(nodes::rasterize_attributes(), Json::object(), {{hits[0]}, {drawn}}, &ctx)
            .at(0)
            .as<Image>()
            ->raster;
    const int plane = *points.frame().find("across");
    for (const glm::ivec2 at : {glm::ivec2(5, 5), {10, 3}, {4, 10}})
      EXPECT_NEAR(points.value(plane, 0, at.x, at.y), at.x + 0.5, 1e-12);
  }
}

// A face 0.0825 px wide is 21/256 px wide on the finest grid and 1/16 px on the coarsest: 12.2 or 16 texels a pixel.
TEST(SubpixelBits, MinificationIsThatOfTheFaceDrawn) {
  MipPyramid texture;
  texture.levels.push_back({1, 1, {1, 1, 1, 1}});
  const auto first = [&](int bits) {
    test::ScreenMeshMaker<double> m;
    m.vertex(0, 0), m.vertex(0.0825, 0), m.vertex(0, 64);
    m.face.emplace_back(0, 1, 2);
    auto mesh = m.make({16, 16}, false, bits);
    mesh->columns.push_back(
        Column::make<glm::dvec2>("uv", Domain::vertex, std::vector<glm::dvec2>{{0, 0}, {1, 0}, {0, 1}}));
    return first_minified_face(*mesh, texture, {}, 14);
  };
  EXPECT_EQ(first(8), std::nullopt);
  EXPECT_EQ(first(4), std::optional<std::size_t>(0));
}

}  // namespace
}  // namespace frustum
