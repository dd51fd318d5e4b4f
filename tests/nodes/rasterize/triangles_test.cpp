#include "nodes/rasterize/triangles.h"

#include <gtest/gtest.h>

#include "nodes/rasterize.h"
#include "tests/nodes/rasterize/screen_mesh.h"

namespace frustum {
namespace {

using test::buffer_of;
using test::ScreenMeshMaker;

struct Seen {
  Raster visibility, depth;
  std::uint32_t id(int sample, int x, int y) const { return visibility.at<std::uint32_t>(0, sample, x, y); }
  double z(int sample, int x, int y) const { return visibility.value(1, sample, x, y); }
};

Seen rasterize(std::shared_ptr<Mesh> mesh, std::shared_ptr<SamplePattern> pattern = nullptr,
               Precision precision = Precision::single, int tile_edge = 0) {
  Context ctx = test::with_precision(precision);
  test::NodeInputs inputs{{buffer_of(std::move(mesh))}, {}};
  if (pattern) inputs[1].push_back(buffer_of(std::move(pattern)));
  const auto out =
      test::run_node(nodes::rasterize_triangles(), nlohmann::json::object(), inputs, &ctx, {}, tile_edge);
  return {out[0].as<Visibility>()->raster, out[1].as<Depth>()->raster};
}

TEST(RasterizeTriangles, FillsTheHandComputedPixels) {
  ScreenMeshMaker<float> m;
  const std::uint32_t a = m.vertex(0.5, 0.5, 0), b = m.vertex(3.5, 0.5, 0.75), c = m.vertex(0.5, 3.5, 0.75);
  m.face.emplace_back(a, b, c);
  const Seen s = rasterize(m.make({4, 4}));
  // Left and top edges hold their pixel centres; the diagonal through (3.5, 0.5) .. (0.5, 3.5) does not.
  const int covered[4][4] = {{1, 1, 1, 0}, {1, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 0}};
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      EXPECT_EQ(s.id(0, x, y), covered[y][x] ? 0U : no_face) << x << ", " << y;
      EXPECT_EQ(s.z(0, x, y), covered[y][x] ? (x + y) * 0.25 : 1.0);
      EXPECT_EQ(s.depth.value(0, 0, x, y), s.z(0, x, y));
    }
}

TEST(RasterizeTriangles, TheDepthsAreReversedWithTheCamera) {
  ScreenMeshMaker<float> m;
  for (const float z : {0.25f, 0.75f}) {
    const std::uint32_t a = m.vertex(0, 0, z), b = m.vertex(3, 0, z), c = m.vertex(0, 3, z);
    m.face.emplace_back(a, b, c);
  }
  EXPECT_EQ(rasterize(m.make({4, 4})).id(0, 0, 0), 0U);
  const Seen reversed = rasterize(m.make({4, 4}, true));
  EXPECT_EQ(reversed.id(0, 0, 0), 1U);
  EXPECT_EQ(reversed.z(0, 0, 0), 0.75);
  EXPECT_EQ(reversed.z(0, 3, 3), 0.0);
}

TEST(RasterizeTriangles, TiesGoToTheLowestOrigin) {
  ScreenMeshMaker<float> m;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t a = m.vertex(0, 0), b = m.vertex(3, 0), c = m.vertex(0, 3);
    m.face.emplace_back(a, b, c);
  }
  auto mesh = m.make({4, 4});
  const std::vector<std::uint32_t> origin{5, 2, 9};
  mesh->columns.push_back(Column::make("origin", Domain::face, std::span<const std::uint32_t>(origin)));
  EXPECT_EQ(rasterize(mesh).id(0, 0, 0), 1U);
}

TEST(RasterizeTriangles, AnEmptyMeshAndOddSizesGiveTheFarDepth) {
  for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(7, 5), glm::ivec2(4096, 1)}) {
    const Seen s = rasterize(ScreenMeshMaker<float>().make(size));
    for (int x = 0; x < size.x; ++x) {
      ASSERT_EQ(s.id(0, x, size.y - 1), no_face);
      ASSERT_EQ(s.z(0, x, size.y - 1), 1.0);
    }
  }
}

TEST(RasterizeTriangles, CountsAndWarnsOfWhatCannotBeDrawn) {
  ScreenMeshMaker<float> m;
  const std::uint32_t a = m.vertex(0, 0), b = m.vertex(3, 0), c = m.vertex(0, 3), bad = m.vertex(NAN, 0),
                      far = m.vertex(9, 3e6);
  m.face = {{a, b, c}, {a, bad, c}, {a, b, far}, {a, a, c}};
  Context ctx;
  const auto out = test::run_node(nodes::rasterize_triangles(), nlohmann::json::object(),
                                  {{buffer_of(m.make({4, 4}))}}, &ctx);
  EXPECT_EQ(out[0].as<Visibility>()->raster.at<std::uint32_t>(0, 0, 0, 0), 0U);
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "triangles_out_of_range");
  EXPECT_EQ(ctx.warnings()[0].second.substr(0, 12), "2 triangles ");
  for (const auto& [name, n] : ctx.counters()) {
    if (name == "triangles_out_of_range") {
      EXPECT_EQ(n, 2U);
    }
    if (name == "triangles_without_area") {
      EXPECT_EQ(n, 1U);
    }
  }
}

TEST(RasterizeTriangles, AMeshWithoutCameraOrTooLargeAPictureIsRefused) {
  ScreenMeshMaker<float> m;
  auto mesh = m.make({65537, 1});
  EXPECT_EQ(
      test::run_error(nodes::rasterize_triangles(), nlohmann::json::object(), {{buffer_of(mesh)}}).first,
      "too_large");
  mesh->camera = nullptr;
  EXPECT_EQ(
      test::run_error(nodes::rasterize_triangles(), nlohmann::json::object(), {{buffer_of(mesh)}}).first,
      "no_camera");
}

// --- Against a ray caster
// -----------------------------------------------------------------------------------

struct EyeTriangle {
  std::array<glm::dvec3, 3> p;     // eye space
  std::array<glm::dvec2, 3> p_px;  // on the screen, not snapped

  // The distance along -z at which the ray (x, y, -1) meets the plane, where it does so inside. Moeller &
  // Trumbore 1997.
  std::optional<double> hit(double x, double y) const {
    const glm::dvec3 d(x, y, -1), e1 = p[1] - p[0], e2 = p[2] - p[0], h = glm::cross(d, e2);
    const double a = glm::dot(e1, h);
    if (a == 0) return std::nullopt;
    const glm::dvec3 q = glm::cross(-p[0], e1);
    const double u = glm::dot(-p[0], h) / a, v = glm::dot(d, q) / a;
    if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
    return glm::dot(e2, q) / a;
  }
  double edge_distance_px(glm::dvec2 s) const {
    double least = 1e9;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec2 a = p_px[k], ab = p_px[(k + 1) % 3] - a;
      const double t = std::min(1.0, std::max(0.0, glm::dot(s - a, ab) / glm::dot(ab, ab)));
      least = std::min(least, glm::length(s - a - ab * t));
    }
    return least;
  }
};

// A pinhole camera, 90 degrees high: depth in normalized device coordinates from near 0.5 to far 50.
struct Pinhole {
  glm::ivec2 size;
  double depth(double w) const { return (50.5 - 2 * 0.5 * 50 / w) / 49.5; }
  glm::dvec2 to_px(glm::dvec3 p) const {
    return {(p.x / -p.z * size.y / size.x + 1) * 0.5 * size.x, (1 - p.y / -p.z) * 0.5 * size.y};
  }
  glm::dvec2 ray(glm::dvec2 px) const {
    return {(px.x / size.x * 2 - 1) * size.x / size.y, 1 - px.y / size.y * 2};
  }
};

std::vector<EyeTriangle> random_triangles(test::Random& random, const Pinhole& camera, int n) {
  std::vector<EyeTriangle> all;
  for (int i = 0; i < n; ++i) {
    EyeTriangle t;
    const double w = random.uniform(2, 20), size = std::exp2(random.uniform(-2, 2));
    const glm::dvec3 middle(random.uniform(-1.2, 1.2) * w, random.uniform(-1.2, 1.2) * w, -w);
    for (std::size_t k = 0; k < 3; ++k) {
      t.p[k] =
          middle + size * glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.3, 0.3));
      t.p[k].z = std::min(t.p[k].z, -0.5);
      t.p_px[k] = camera.to_px(t.p[k]);
    }
    all.push_back(t);
  }
  return all;
}

template <class R>
void expect_ray_cast(Precision precision, glm::ivec2 size, int triangles) {
  test::Random random(31);
  const Pinhole camera{size};
  const auto eye = random_triangles(random, camera, triangles);
  ScreenMeshMaker<R> m;
  for (const EyeTriangle& t : eye) {
    glm::uvec3 f;
    for (int k = 0; k < 3; ++k) {
      const std::size_t i = static_cast<std::size_t>(k);
      f[k] = m.vertex(t.p_px[i].x, t.p_px[i].y, camera.depth(-t.p[i].z), -1 / t.p[i].z);
    }
    m.face.push_back(f);
  }
  auto pattern = std::make_shared<SamplePattern>(SamplePattern{3, 1, {512, 2048, 3600}, {3000, 900, 2048}});
  const Seen seen = rasterize(m.make(size), pattern, precision, 32);

  int compared = 0, near_edge = 0, near_tie = 0;
  for (int s = 0; s < 3; ++s)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const glm::dvec2 at(x + pattern->x[static_cast<std::size_t>(s)] / 4096.0,
                            y + pattern->y[static_cast<std::size_t>(s)] / 4096.0);
        bool edge = false;
        std::vector<std::pair<double, std::uint32_t>> hits;
        std::vector<double> slack(eye.size());
        for (std::uint32_t i = 0; i < eye.size(); ++i) {
          edge = edge || eye[i].edge_distance_px(at) <= 1.0 / 256;
          const auto z_at = [&](double dx, double dy) {
            const glm::dvec2 r = camera.ray(at + glm::dvec2(dx, dy));
            const auto w = eye[i].hit(r.x, r.y);
            return w ? camera.depth(*w) : NAN;
          };
          const double z = z_at(0, 0);
          if (std::isnan(z)) continue;
          hits.emplace_back(z, i);
          // Snapping moves the plane by at most half a grid step in x and y: the change of depth over that,
          // here from differences over 2^-10 px, and the rounding of depths themselves.
          const double h = 1.0 / 1024, gx = std::abs(z_at(h, 0) - z), gy = std::abs(z_at(0, h) - z);
          slack[i] = std::isnan(gx + gy) ? 1 : 2 * (gx + gy) + 8 * std::numeric_limits<R>::epsilon();
        }
        if (edge) {
          ++near_edge;
          continue;
        }
        std::sort(hits.begin(), hits.end());
        if (hits.size() > 1) {
          const auto [z, i] = hits[0];
          bool tie = false;
          for (std::size_t k = 1; k < hits.size(); ++k)
            tie = tie || hits[k].first - z <= slack[i] + slack[hits[k].second];
          if (tie) {
            ++near_tie;
            continue;
          }
        }
        ++compared;
        ASSERT_EQ(seen.id(s, x, y), hits.empty() ? no_face : hits[0].second)
            << x << ", " << y << ", sample " << s;
        if (!hits.empty()) {
          ASSERT_NEAR(seen.z(s, x, y), hits[0].first, slack[hits[0].second]);
        }
      }
  EXPECT_GT(compared, 3 * size.x * size.y * 9 / 10)
      << near_edge << " near an edge, " << near_tie << " near a tie";
}

TEST(RasterizeTriangles, SeesWhatARayCasterSees) {
  expect_ray_cast<double>(Precision::real_double, {160, 90}, 120);
  expect_ray_cast<float>(Precision::single, {160, 90}, 120);
}

// --- The identity law
// ---------------------------------------------------------------------------------------

template <class R>
void expect_tiles(Precision precision) {
  test::Random random(32);
  ScreenMeshMaker<R> m;
  for (int i = 0; i < 300; ++i) {
    const double x = random.uniform(0, 150), y = random.uniform(0, 100), r = std::exp2(random.uniform(0, 6));
    const auto corner = [&] {
      return m.vertex(x + random.uniform(-r, r), y + random.uniform(-r, r), random.uniform());
    };
    const std::uint32_t a = corner(), b = corner(), c = corner();
    m.face.emplace_back(a, b, c);
  }
  auto pattern =
      std::make_shared<SamplePattern>(SamplePattern{1, 2, {100, 900, 3000, 2048}, {4000, 5, 1024, 2000}});
  const Seen whole = rasterize(m.make({150, 100}), pattern, precision);
  for (const int edge : {1, 7, 16, 64, 128}) {
    const Seen tiled = rasterize(m.make({150, 100}), pattern, precision, edge);
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 150; ++x) {
        ASSERT_EQ(tiled.id(0, x, y), whole.id(0, x, y)) << edge;
        ASSERT_EQ(tiled.z(0, x, y), whole.z(0, x, y)) << edge;
        ASSERT_EQ(tiled.depth.value(0, 0, x, y), whole.z(0, x, y)) << edge;
      }
  }
}

TEST(RasterizeTriangles, TilesOfAnySizeGiveTheSameBytes) {
  expect_tiles<float>(Precision::single);
  expect_tiles<double>(Precision::real_double);
}

}  // namespace
}  // namespace frustum
