#include "nodes/mesh/weld.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

namespace frustum {
namespace {

Ref<Mesh> welded(const Mesh& mesh, const Json& params, Context* ctx = nullptr) {
  return test::run_node(nodes::mesh_weld(), params, {{test::shared(mesh)}}, ctx).at(0).as<Mesh>();
}

std::uint64_t counter(const Context& ctx, std::string_view name) {
  for (const auto& [n, value] : ctx.counters())
    if (n == name) return value;
  return 0;
}

// Two triangles that touch along an edge, with vertices of their own; the second's are off by `gap`.
Mesh pair_of_triangles(float gap = 0) {
  return test::mesh_of(
      std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1 + gap, 0, 0}, {1, 1, 0}, {0, 1 + gap, 0}},
      {{0, 1, 2}, {3, 4, 5}}, Space::object);
}

// The triangles of a mesh, each with vertices of its own.
Mesh soup(const Mesh& m) {
  std::vector<glm::vec3> p;
  std::vector<glm::uvec3> t;
  for (const glm::uvec3& f : m.triangles()) {
    const auto first = static_cast<std::uint32_t>(p.size());
    for (glm::length_t c = 0; c < 3; ++c) p.emplace_back(test::position_at(m, f[c]));
    t.emplace_back(first, first + 1, first + 2);
  }
  return test::mesh_of(p, t, Space::object);
}

TEST(MeshWeld, JoinsEqualVertices) {
  const auto m = welded(pair_of_triangles(), Json::object());
  EXPECT_EQ(m->vertices(), 4U);
  EXPECT_EQ(test::column<glm::uvec3>(*m, "triangle"), (std::vector<glm::uvec3>{{0, 1, 2}, {1, 3, 2}}));
}

TEST(MeshWeld, ClosesASoupOfTriangles) {
  const auto ball = test::run_node(nodes::mesh_sphere(), Json::object()).at(0).as<Mesh>();
  const auto m = welded(soup(*ball), Json::object());
  EXPECT_EQ(m->vertices(), ball->vertices());
  EXPECT_EQ(test::statistic(m, "closed"), 1);
  EXPECT_EQ(test::statistic(test::shared(soup(*ball)), "closed"), 0);
  EXPECT_EQ(m->validate(), "");
}

TEST(MeshWeld, JoinsWithinTheToleranceAtTheEarliestVertex) {
  EXPECT_EQ(welded(pair_of_triangles(1e-4F), Json::object())->vertices(), 6U);
  const auto m = welded(pair_of_triangles(1e-4F), {{"tolerance", 1e-3}});
  EXPECT_EQ(m->vertices(), 4U);
  EXPECT_EQ(test::column<glm::vec3>(*m, "position")[1], glm::vec3(1, 0, 0));
}

TEST(MeshWeld, KeepsVerticesApartWhoseAttributesDiffer) {
  const std::vector<glm::vec2> uv = {{0, 0}, {1, 0}, {0, 1}, {1, 0}, {9, 9}, {7, 7}};
  const Mesh m = pair_of_triangles().with(Column::make<glm::vec2>("uv", Domain::vertex, uv));
  const auto split = welded(m, Json::object());
  EXPECT_EQ(split->vertices(), 5U);  // uv agrees at (1, 0, 0) and differs at (0, 1, 0)
  const auto corners = welded(m, {{"attributes", "corners"}});
  EXPECT_EQ(corners->vertices(), 4U);
  EXPECT_EQ(test::column<glm::vec2>(*corners, "uv"), uv);  // here corners come in the order of vertices
  const auto first = welded(m, {{"attributes", "first"}});
  EXPECT_EQ(first->vertices(), 4U);
  EXPECT_EQ(test::column<glm::vec2>(*first, "uv")[2], glm::vec2(0, 1));
}

TEST(MeshWeld, DropsAndCountsFacesThatCollapse) {
  Context ctx;
  const Mesh m = test::mesh_of(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e-6F, 0, 0}},
                               {{0, 1, 2}, {0, 3, 2}, {1, 1, 2}}, Space::object);
  const auto out = welded(m, {{"tolerance", 1e-5}}, &ctx);
  EXPECT_EQ(out->faces(), 1U);
  EXPECT_EQ(counter(ctx, "faces_dropped"), 2U);
  EXPECT_EQ(counter(ctx, "vertices_joined"), 1U);
  EXPECT_EQ(test::column<std::uint32_t>(*out, "origin"), (std::vector<std::uint32_t>{0}));
}

TEST(MeshWeld, LeavesWhatIsNotFiniteAlone) {
  const Mesh m = test::mesh_of(std::vector<glm::vec3>{{NAN, 0, 0}, {NAN, 0, 0}, {INFINITY, 0, 0}},
                               {{0, 1, 2}}, Space::object);
  for (const double tolerance : {0.0, 1.0, 1e300})
    EXPECT_EQ(welded(m, {{"tolerance", tolerance}})->vertices(), 3U);
  EXPECT_EQ(welded(test::mesh_of(std::vector<glm::vec3>{}, {}, Space::object), Json::object())->vertices(),
            0U);
}

}  // namespace
}  // namespace frustum
