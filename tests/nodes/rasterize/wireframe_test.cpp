#include "nodes/rasterize/wireframe.h"

#include "nodes/kernels/mesh_edges.h"
#include "nodes/mesh.h"
#include "nodes/project.h"
#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <map>
#include <numeric>

namespace frustum {
namespace {

Ref<Camera> camera(int width, int height, glm::dvec3 eye = {0, 0, 5}, bool reversed_z = false) {
  auto c = std::make_shared<Camera>();
  c->eye = eye, c->resolution = {width, height}, c->reversed_z = reversed_z;
  return c;
}

// A mesh on its way to the screen.
struct Stages {
  Ref<Mesh> clip, screen;
  Buffer hits;

  Stages(const Ref<Mesh>& mesh, const Ref<Camera>& c) {
    const auto step = [&](const NodeType& type, const Ref<Mesh>& m) {
      return test::run_node(type, Json::object(), {{m}, {c}}).at(0).as<Mesh>();
    };
    clip = step(nodes::project_perspective(), step(nodes::project_view(), mesh));
    screen = step(nodes::project_viewport(), clip);
    hits = test::run_node(nodes::rasterize_triangles(), Json::object(), {{screen}, {}}).at(0);
  }
};

Ref<Image> drawing(const Stages& s, const Json& params, bool with_hits = true) {
  const test::NodeInputs in = {{s.clip},
                               with_hits ? std::vector<Buffer>{s.hits} : std::vector<Buffer>{},
                               with_hits ? std::vector<Buffer>{s.screen} : std::vector<Buffer>{},
                               {},
                               {}};
  return test::run_node(nodes::rasterize_wireframe(), params, in).at(0).as<Image>();
}

double alpha(const Image& image, int x, int y) { return image.raster.value(3, 0, x, y); }

Ref<Mesh> box() { return test::run_node(nodes::mesh_box(), Json::object()).at(0).as<Mesh>(); }

// Row 23: the edges of a cube, each once: 12, and 6 diagonals of its sides.
TEST(MeshEdges, AreThoseOfACubeEachOnce) {
  const auto m = box();
  std::vector<std::uint32_t> place(m->vertices());
  std::iota(place.begin(), place.end(), 0U);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> times;
  int along_an_axis = 0;
  for (const auto& e : kernels::mesh_edges(m->triangles(), place, [](const auto&) { return true; })) {
    ++times[{e.a, e.b}];
    EXPECT_EQ(e.faces, 2U);
    EXPECT_TRUE(e.turned);
    const std::uint32_t bits = e.a ^ e.b;  // vertices are numbered by their octants
    along_an_axis += bits == 1 || bits == 2 || bits == 4 ? 1 : 0;
  }
  EXPECT_EQ(times.size(), 18U);
  EXPECT_EQ(along_an_axis, 12);
  for (const auto& [edge, n] : times) EXPECT_EQ(n, 1);
}

TEST(WireframeLine, IsWhatTheViewportSays) {
  const auto planes = wireframe::planes_around({100, 50}, {}, 0);
  const auto line = wireframe::line_of({-1, 0, 0, 2}, {1, 0.5, 0, 2}, planes, kernels::Viewport({100, 50}));
  ASSERT_TRUE(line);
  EXPECT_EQ(line->a, glm::dvec3(25, 25, 0));
  EXPECT_EQ(line->b, glm::dvec3(75, 18.75, 0));
}

// An edge through the plane of the eye: it ends on the near plane, on the visible side, and nothing wraps round.
TEST(WireframeLine, EndsAtTheNearPlaneWhenItPassesTheEye) {
  const kernels::Viewport viewport({100, 100});
  const auto planes = wireframe::planes_around({100, 100}, {}, 1);
  const auto line = wireframe::line_of({0.2, 0, 0, 1}, {0.2, 0, -3, -2}, planes, viewport);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->a.x, 60);
  EXPECT_NEAR(line->b.z, -1, 1e-12);
  EXPECT_GT(line->b.x, 60);
  EXPECT_LE(line->b.x, 101 + 1e-9);
  EXPECT_FALSE(wireframe::line_of({0, 0, -3, -1}, {1, 0, -3, -2}, planes, viewport));  // behind
  EXPECT_FALSE(wireframe::line_of({5, 0, 0, 1}, {6, 9, 0, 1}, planes, viewport));      // beside
  EXPECT_FALSE(wireframe::line_of({NAN, 0, 0, 1}, {0, 0, 0, 1}, planes, viewport));
  EXPECT_FALSE(wireframe::line_of({0, 0, 0, 0}, {0, 0, 0, 0}, planes, viewport));
}

TEST(WireframeCoverage, IsTheWidthOfTheLineOverAll) {
  for (const double width : {0.25, 1.0, 2.5, 7.0})
    for (double offset = 0; offset < 1; offset += 0.125) {
      double sum = 0;
      for (int i = -20; i <= 20; ++i) sum += wireframe::coverage(std::fabs(i + offset), width, false);
      EXPECT_NEAR(sum, width, 1e-12);
    }
}

// Every sample within the width of an edge is inked and no other, by brute force over all lines.
TEST(RasterizeWireframe, InksExactlyTheSamplesNearAnEdge) {
  const auto c = camera(67, 45, {2, 1.5, 3});
  const Stages s(box(), c);
  const auto image = drawing(s, {{"width", 1.5}}, false);
  std::vector<std::uint32_t> place(8);
  std::iota(place.begin(), place.end(), 0U);
  const auto planes = wireframe::planes_around(c->resolution, {}, 3);
  const auto clip = test::column<glm::vec4>(*s.clip, "position");
  for (int y = 0; y < 45; ++y)
    for (int x = 0; x < 67; ++x) {
      double want = 0;
      for (const auto& e :
           kernels::mesh_edges(s.clip->triangles(), place, [](const auto&) { return true; })) {
        const auto line = wireframe::line_of(glm::dvec4(clip[e.a]), glm::dvec4(clip[e.b]), planes,
                                             kernels::Viewport(c->resolution));
        if (line)
          want = std::max(
              want, wireframe::coverage(wireframe::nearest(*line, {x + 0.5, y + 0.5}).distance, 1.5, false));
      }
      EXPECT_NEAR(alpha(*image, x, y), want, 1e-5) << x << " " << y;
    }
}

// Front and back of a cube seen from the front: hidden edges are left out, and only they are.
TEST(RasterizeWireframe, LeavesHiddenEdgesOut) {
  for (const bool reversed : {false, true}) {
    const Stages s(box(), camera(101, 101, {0, 0, 5}, reversed));
    const auto all = drawing(s, {{"hidden", 1}, {"crease", 0}}), seen = drawing(s, {{"crease", 0}}),
               faint = drawing(s, {{"hidden", 0.25}, {"crease", 0}});
    const auto front = s.screen->at("position");
    const auto back_x = static_cast<int>(front.number(0, 0));   // vertex 0: back, left, below
    const auto front_x = static_cast<int>(front.number(4, 0));  // vertex 4: front, left, below
    EXPECT_GT(alpha(*all, back_x, 50), 0.4);
    EXPECT_EQ(alpha(*seen, back_x, 50), 0);
    EXPECT_NEAR(alpha(*faint, back_x, 50), 0.25 * alpha(*all, back_x, 50), 1e-6);
    EXPECT_GT(alpha(*seen, front_x, 50), 0.4);
    EXPECT_EQ(alpha(*seen, front_x, 50), alpha(*all, front_x, 50));
  }
}

// What lies on the front of a ball loses nothing to the ball's own faces, however small they are.
TEST(RasterizeWireframe, LosesNothingOnFacesThatBend) {
  const auto ball = test::run_node(nodes::mesh_sphere(), {{"segments", 96}, {"rings", 48}}).at(0).as<Mesh>();
  const Stages s(ball, camera(200, 200, {0, 0, 4}));
  const auto all = drawing(s, {{"hidden", 1}}), seen = drawing(s, Json::object());
  const auto in_front = [&](int x, int y) { return (x - 100) * (x - 100) + (y - 100) * (y - 100) < 40 * 40; };
  std::size_t inked = 0, lost = 0;
  // Front and back edges of the ball mirror each other only at the middle row and column: compare with the front half alone.
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < ball->faces(); ++f)
    if (ball->at("position").number(ball->triangles()[f].x, 2) > 0.2) faces.push_back(f);
  std::vector<glm::uvec3> triangles;
  for (const std::uint32_t f : faces) triangles.push_back(ball->triangles()[f]);
  const auto front =
      test::shared(ball->with(Column::make<glm::uvec3>("triangle", Domain::face, triangles))
                       .with(Column::make<glm::vec2>("uv", Domain::corner, 3 * triangles.size())));
  const auto want = drawing(Stages(front, camera(200, 200, {0, 0, 4})), {{"hidden", 1}});
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      if (!in_front(x, y)) continue;
      inked += alpha(*want, x, y) > 0 ? 1U : 0U;
      lost += alpha(*seen, x, y) < alpha(*want, x, y) - 1e-6 ? 1U : 0U;
    }
  EXPECT_GT(inked, 1000U);
  EXPECT_EQ(lost, 0U);
}

TEST(RasterizeWireframe, DrawsOutlinesAndCreasesOnly) {
  const Stages s(box(), camera(101, 101, {0, 0, 5}));
  const auto all = drawing(s, Json::object()), creases = drawing(s, {{"crease", 30}});
  EXPECT_GT(alpha(*all, 50, 50), 0.4);  // the diagonal of the front
  EXPECT_EQ(alpha(*creases, 50, 50), 0);
}

TEST(RasterizeWireframe, NamesWhatDoesNotFit) {
  const Stages s(box(), camera(40, 30)), other(box(), camera(30, 40));
  const auto error = [&](const test::NodeInputs& in) {
    return test::run_error(nodes::rasterize_wireframe(), Json::object(), in).first;
  };
  EXPECT_EQ(error({{s.clip}, {other.hits}, {other.screen}, {}, {}}), "frames_differ");
  EXPECT_EQ(error({{s.clip}, {s.hits}, {}, {}, {}}), "missing_mesh");
  Mesh blind = *s.clip;
  blind.camera = nullptr;
  EXPECT_EQ(error({{test::shared(blind)}, {}, {}, {}, {}}), "no_camera");
}

}  // namespace
}  // namespace frustum
