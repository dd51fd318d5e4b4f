// surface.tessellate: no cracks, within the tolerance, normals everywhere.
#include "nodes/io.h"
#include "nodes/kernels/bicubic.h"
#include "nodes/surface.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/surface.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <set>

namespace frustum {
namespace {

using kernels::BicubicNet;

std::uint32_t add_point(Surface& s, const glm::dvec3& p) {
  s.points.push_back(p);
  return static_cast<std::uint32_t>(s.points.size() - 1);
}

// A cube's six faces, each a bicubic patch with its control points pushed outwards to `radius`: a closed,
// rounded body whose patches share boundary points by place, not by index. dP/du x dP/dv points outwards.
Surface rounded_cube(double radius) {
  Surface s;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      auto& patch = s.patches.emplace_back();
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
          const double a = static_cast<double>(i) * 2 / 3 - 1, b = static_cast<double>(j) * 2 / 3 - 1;
          glm::dvec3 p{0};
          p[axis] = sign;
          p[(axis + 1) % 3] = sign > 0 ? a : b;
          p[(axis + 2) % 3] = sign > 0 ? b : a;
          for (int c = 0; c < 3; ++c)
            p[c] = std::round(p[c] * 3) / 3;  // -1, -1/3, 1/3, 1 from every face alike
          const double length = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
          patch[4 * i + j] = add_point(s, p * (radius * (0.4 + 0.6 / length)));
        }
    }
  return s;
}

// An octant of a sphere about the origin, nearly: the edge v = 1 is collapsed to the pole (0, 1, 0).
Surface octant() {
  const double k = 4.0 / 3 * (std::sqrt(2.0) - 1);
  const double radius[4] = {1, 1, k, 0}, height[4] = {0, k, 1, 1};
  const glm::dvec2 around[4] = {{0, 1}, {k, 1}, {1, k}, {1, 0}};  // z axis to x axis
  Surface s;
  auto& patch = s.patches.emplace_back();
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      patch[4 * i + j] = add_point(s, {radius[j] * around[i].x, height[j], radius[j] * around[i].y});
  return s;
}

Ref<Mesh> tessellated(const Surface& s, std::string_view params, const Camera* camera = nullptr,
                      Precision precision = Precision::real_double) {
  test::NodeInputs in{{"surface", {std::make_shared<const Surface>(s)}}};
  if (camera != nullptr) in["camera"] = {std::make_shared<const Camera>(*camera)};
  return test::run_geometry(nodes::surface_tessellate(), params, in, precision).at(0).as<Mesh>();
}

BicubicNet net_of(const Surface& s, std::size_t patch) {
  BicubicNet net;
  for (std::size_t k = 0; k < 16; ++k) net[k] = s.points[s.patches[patch][k]];
  return net;
}

// Every directed edge at most once, and each with its twin where the surface is closed.
void expect_watertight(const Mesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles())
    for (const auto& e : {std::pair{t[0], t[1]}, std::pair{t[1], t[2]}, std::pair{t[2], t[0]}})
      ASSERT_TRUE(edges.insert(e).second)
          << "the edge " << e.first << ", " << e.second << " has two faces on one side";
  for (const auto& [a, b] : edges)
    ASSERT_TRUE(edges.contains({b, a})) << "the edge " << a << ", " << b << " is open";
}

// The largest distance between points of triangles and the points of the patch with the same (u, v).
template <class Measure>
double largest_deviation(const Mesh& mesh, const Surface& s, Measure&& measure) {
  const auto position = mesh.at("position").values<glm::dvec3>();
  const auto uv = mesh.at("uv").values<glm::dvec2>();
  const auto patch = mesh.at("patch").values<std::uint32_t>();
  double largest = 0;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const BicubicNet net = net_of(s, patch[f]);
    for (int a = 0; a <= 6; ++a)
      for (int b = 0; a + b <= 6; ++b) {
        const double w[3] = {a / 6.0, b / 6.0, (6 - a - b) / 6.0};
        glm::dvec3 p{0};
        glm::dvec2 t{0};
        for (std::size_t c = 0; c < 3; ++c) {
          p += position[mesh.triangles()[f][static_cast<glm::length_t>(c)]] * w[c];
          t += uv[3 * f + c] * w[c];
        }
        largest = std::max(largest, measure(p, kernels::bicubic_derivative(net, t.x, t.y, 0, 0)));
      }
  }
  return largest;
}

TEST(SurfaceTessellate, AClosedBodyIsWatertightAndFacesOutwards) {
  const Camera camera{.eye = {0, 0, 2.5},
                      .target = {0, 0, 0}};  // near patches are cut more finely than far ones
  const Surface cube = rounded_cube(1);
  const auto mesh = tessellated(cube, R"({"tolerance_px": 2})", &camera);
  EXPECT_EQ(mesh->closed, std::optional(true));
  EXPECT_EQ(mesh->validate(), "");
  expect_watertight(*mesh);
  const auto p = mesh->at("position").values<glm::dvec3>();
  const auto n = mesh->at("normal").values<glm::dvec3>();
  double volume = 0;
  for (std::size_t f = 0; f < mesh->faces(); ++f) {
    const auto t = mesh->triangles()[f];
    volume += kernels::dot(p[t[0]], kernels::cross(p[t[1]], p[t[2]])) / 6;
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_GT(kernels::dot(n[3 * f + c], p[t[static_cast<glm::length_t>(c)]]), 0);
  }
  EXPECT_GT(volume, 2);
}

TEST(SurfaceTessellate, StaysWithinItsTolerance) {
  const Surface cube = rounded_cube(1);
  const auto distance = [](const glm::dvec3& a, const glm::dvec3& b) { return kernels::norm(a - b); };
  for (const double tolerance : {0.1, 0.01, 0.001}) {
    const auto mesh = tessellated(cube, R"({"tolerance": )" + std::to_string(tolerance) + "}");
    const double off = largest_deviation(*mesh, cube, distance);
    EXPECT_LE(off, tolerance);
    EXPECT_GT(off, tolerance / 40) << "far finer than asked";
    expect_watertight(*mesh);
  }
}

TEST(SurfaceTessellate, StaysWithinItsToleranceInPixels) {
  const Surface cube = rounded_cube(1);
  const Camera camera{.eye = {1.5, 1.2, 2}, .target = {0.2, 0, 0}, .fov_y = 0.9, .resolution = {1280, 720}};
  const auto mesh = tessellated(cube, R"({"tolerance_px": 0.5})", &camera);
  const auto forward = *kernels::normalized(camera.target - camera.eye);
  const auto right = *kernels::normalized(kernels::cross(forward, camera.up));
  const auto up = kernels::cross(right, forward);
  const auto pixel = [&](const glm::dvec3& p) {
    const glm::dvec3 d = p - camera.eye;
    return glm::dvec2(kernels::dot(d, right), kernels::dot(d, up)) *
           (0.5 * camera.resolution.y / std::tan(0.5 * camera.fov_y) / kernels::dot(d, forward));
  };
  EXPECT_LE(largest_deviation(
                *mesh, cube,
                [&](const glm::dvec3& a, const glm::dvec3& b) { return kernels::norm(pixel(a) - pixel(b)); }),
            0.5);
}

TEST(SurfaceTessellate, APoleIsOneVertexWithTheNormalOfItsLimit) {
  const Surface s = octant();
  const auto mesh = tessellated(s, R"({"tolerance": 0.001})");
  EXPECT_EQ(mesh->closed, std::optional(false));
  const auto p = mesh->at("position").values<glm::dvec3>();
  const auto n = mesh->at("normal").values<glm::dvec3>();
  EXPECT_EQ(std::count(p.begin(), p.end(), glm::dvec3(0, 1, 0)), 1);
  std::size_t at_pole = 0;
  for (std::size_t c = 0; c < n.size(); ++c) {
    const glm::dvec3 q = p[mesh->triangles()[c / 3][static_cast<glm::length_t>(c % 3)]];
    // A cubic stands off the circle by 2.7e-4 at most, its tangent by 1e-3 or so.
    EXPECT_GT(kernels::dot(n[c], q), 0.99999);
    if (q == glm::dvec3(0, 1, 0)) {
      ++at_pole;
      EXPECT_NEAR(n[c].y, 1, 1e-12);
    }
  }
  EXPECT_GT(at_pole, 3u);
}

TEST(BicubicNormal, FollowsNeighboursWhereTheCornerCollapses) {
  // Both tangents vanish at (0, 0): the second Taylor coefficient decides.
  BicubicNet net;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      const double x = i < 2 ? 0 : static_cast<double>(i), y = j < 2 ? 0 : static_cast<double>(j);
      net[4 * i + j] = {x, y, 0.1 * x * y};
    }
  const double extent = kernels::net_extent(net);
  const auto at = kernels::bicubic_normal(net, extent, 0, 0),
             near = kernels::bicubic_normal(net, extent, 1e-4, 1e-4);
  EXPECT_NEAR(kernels::dot(at, near), 1, 1e-6);
  const BicubicNet point{};
  EXPECT_EQ(kernels::bicubic_normal(point, 0, 0.5, 0.5), glm::dvec3(0, 0, 1));
}

TEST(SurfaceTessellate, AFlatPatchIsTwoTriangles) {
  Surface s;
  auto& patch = s.patches.emplace_back();
  for (std::size_t k = 0; k < 16; ++k)
    patch[k] = add_point(s, {static_cast<double>(k / 4), static_cast<double>(k % 4), 0});
  EXPECT_EQ(tessellated(s, "{}")->faces(), 2u);
  EXPECT_EQ(tessellated(s, R"({"min_segments": 3})")->faces(), 18u);
  EXPECT_EQ(tessellated(Surface{}, "{}")->faces(), 0u);
}

Surface teapot() {
  const auto made =
      test::run_geometry(nodes::io_load_patches(), R"({"file": "graphs/data/teapot.json"})", {});
  return *made.at(0).as<Surface>();
}

TEST(SurfaceTessellate, TheTeapotIsNotInsideOutAndHasNoNan) {
  const auto mesh = tessellated(teapot(), R"({"tolerance": 0.002})");
  EXPECT_EQ(mesh->validate(), "");
  const auto p = mesh->at("position").values<glm::dvec3>();
  const auto n = mesh->at("normal").values<glm::dvec3>();
  std::size_t against = 0;
  glm::dvec3 lowest(0, 0, 1e9), highest(0, 0, -1e9), lowest_normal{}, highest_normal{};
  for (std::size_t c = 0; c < n.size(); ++c) {
    const auto t = mesh->triangles()[c / 3];
    EXPECT_NEAR(kernels::norm(n[c]), 1, 1e-12);
    against += kernels::dot(kernels::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]), n[c]) <= 0 ? 1 : 0;
    const glm::dvec3 q = p[t[static_cast<glm::length_t>(c % 3)]];
    if (q.z < lowest.z) lowest = q, lowest_normal = n[c];
    if (q.z > highest.z) highest = q, highest_normal = n[c];
  }
  EXPECT_EQ(against, 0u) << "of " << n.size() << " corners";
  EXPECT_LT(lowest_normal.z, -0.99) << "the bottom faces down";
  EXPECT_GT(highest_normal.z, 0.99) << "the knob faces up";
}

TEST(SurfaceTessellate, HasTheSameBytesForAnyNumberOfThreads) {
  const Camera camera{.eye = {6, 4, 5}, .target = {0, 0, 1.5}, .up = {0, 0, 1}};
  const Surface s = teapot();
  std::set<std::string> digests;
  for (const std::size_t threads : {1u, 2u, 7u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    digests.insert(to_hex(Buffer(tessellated(s, "{}", &camera, Precision::single)).digest()));
  }
  EXPECT_EQ(digests.size(), 1u);
}

TEST(SurfaceTessellate, BadSurfacesAreErrors) {
  const auto code_of = [](const Surface& s, std::string_view params) -> std::string {
    try {
      tessellated(s, params);
    } catch (const NodeError& e) {
      return e.code;
    }
    return "";
  };
  Surface s = octant();
  EXPECT_EQ(code_of(s, R"({"min_segments": 9, "max_segments": 4})"), "bad_segments");
  s.points[5].x = std::nan("");
  EXPECT_EQ(code_of(s, "{}"), "not_finite");
  s.patches[0][3] = 99;
  EXPECT_EQ(code_of(s, "{}"), "bad_surface");
}

}  // namespace
}  // namespace frustum
