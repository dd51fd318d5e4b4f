#include "nodes/visibility/bsp.h"

#include <gtest/gtest.h>

#include "runtime/buffers/paint_order.h"
#include "runtime/buffers/value.h"
#include "tests/nodes/visibility/scenes.h"

namespace frustum {
namespace {

using test::counter;

TEST(VisibilityBsp, ShowsTheDepthBuffersPictureHoweverItIsDividedAndWalked) {
  for (const char* splitter : {"first", "least_splits", "balanced"})
    for (const char* traversal : {"back_to_front", "front_to_back"}) {
      const auto show = [&](const Buffer& mesh, const Buffer& pattern, Precision precision) {
        return test::painted(nodes::visibility_bsp(), {{"splitter", splitter}, {"traversal", traversal}},
                             mesh, pattern, precision);
      };
      test::expect_depth_buffer<float>(Precision::single, 2, show);
      test::expect_depth_buffer<double>(Precision::real_double, 2, show);
    }
}

// From any eye the tree's order is the order in which a ray meets the faces: by exact intersection of rays
// with the planes, which share nothing with the tree.
TEST(VisibilityBsp, OrdersForAnyEye) {
  test::Random random(44);
  int met = 0;
  for (int round = 0; round < 40; ++round) {
    const auto m = test::soup<double>(random, test::Soup::any, 30);
    const kernels::ScreenMesh<double> mesh{m.position, m.face, {}};
    const auto faces = kernels::screen_faces(mesh, 1.0);
    const auto tree = bsp::build(faces, {0, 0, 96, 64}, {bsp::Splitter::balanced, 4});
    const glm::dvec4 eye(random.uniform(-200, 300), random.uniform(-200, 300), random.uniform(-20, 20), 1);
    std::vector<const bsp::Piece*> order;
    bsp::traverse(tree, faces, eye, true, [&](const bsp::Node& n) {
      for (std::uint32_t k = 0; k < n.pieces; ++k) order.push_back(&tree.pieces[n.first_piece + k]);
    });
    for (int ray = 0; ray < 50; ++ray) {
      const glm::dvec3 from(eye), to(random.uniform(0, 96), random.uniform(0, 64), random.uniform(-1, 1));
      double last = -1;
      for (const bsp::Piece* piece : order) {
        const auto& f = faces[piece->face];
        const auto height = [&](const glm::dvec3& p) { return p.z - f.depth.at({p.x, p.y}); };
        const double a = height(from), b = height(to);
        if (a == b) continue;
        const double t = a / (a - b);
        if (t < 0) continue;
        const glm::dvec3 at = from + (to - from) * t;
        if (!(at.x >= 0 && at.x <= 96 && at.y >= 0 && at.y <= 64)) continue;
        // Well inside the piece: its face's sides and its cuts.
        bool inside = true;
        for (std::uint32_t k = 0; k < 3; ++k)
          inside = inside && kernels::side_function(f, k, {at.x, at.y}) > 1e-3;
        for (const kernels::Cut& c : piece->cuts)
          inside = inside && kernels::on_side(c, f.depth, faces, {at.x, at.y}) &&
                   std::fabs(kernels::cut_at(c, f.depth, faces, {at.x, at.y})) > 1e-6;
        if (!inside) continue;
        ++met;
        ASSERT_GE(t, last - 1e-6) << "round " << round << ", ray " << ray;
        last = std::max(last, t);
      }
    }
  }
  EXPECT_GT(met, 1000);
}

TEST(VisibilityBsp, PutsCoplanarFacesIntoOneNode) {
  test::ScreenMeshMaker<float> m;
  for (int i = 0; i < 20; ++i) {  // ten, and ten the other way round: hard case BSP-04
    const auto a = m.vertex(10, 10, 0.25), b = m.vertex(60, 10, 0.5), c = m.vertex(10, 50, 0.75);
    m.face.push_back(i % 2 == 0 ? glm::uvec3(a, b, c) : glm::uvec3(a, c, b));
  }
  Context ctx;
  const auto out = test::run_node(nodes::visibility_bsp(), Json::object(),
                                  {{test::buffer_of(m.make(test::scene_size))}}, &ctx);
  EXPECT_EQ(counter(ctx, "nodes"), 1U);
  EXPECT_EQ(counter(ctx, "pieces"), 20U);
  EXPECT_EQ(out.at(1).as<Table>()->columns.at(3).numbers.at(0), 20);
}

// A field of hills, 100 352 faces: fewer pieces than three a face, and a tree whose depth is to
// its faces as 1 to 500.
TEST(VisibilityBsp, DividesAHundredThousandFacesWithFewSplits) {
  test::ScreenMeshMaker<float> m;
  constexpr std::uint32_t n = 224;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double u = i / static_cast<double>(n), v = j / static_cast<double>(n);
      const double hill = std::sin(17 * u) * std::cos(13 * v);
      m.vertex(96 * u, 64 * (0.2 + 0.75 * v) - 9 * hill, 0.9 - 1.5 * v);
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      m.face.emplace_back(a, a + 1, a + n + 1), m.face.emplace_back(a + 1, a + n + 2, a + n + 1);
    }
  const kernels::ScreenMesh<float> mesh{m.position, m.face, {}};
  const auto faces = kernels::screen_faces(mesh, 1.0F);
  const auto tree = bsp::build(faces, {0, 0, 96, 64}, {});
  EXPECT_GT(tree.faces, 90000U);
  EXPECT_LT(tree.pieces.size(), 3 * tree.faces);
  EXPECT_LT(tree.depth, 200U);
  EXPECT_LT(tree.comparisons, 1000 * tree.faces);
}

}  // namespace
}  // namespace frustum
