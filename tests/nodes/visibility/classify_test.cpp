#include "nodes/visibility/classify.h"

#include <gtest/gtest.h>

#include "nodes/clip.h"
#include "nodes/project.h"
#include "runtime/buffers/value.h"
#include "tests/nodes/visibility/scenes.h"

namespace frustum {
namespace {

using classify::Reason;

// Triangles in eye space, through the stages, to the reasons of their faces.
struct Case {
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> face;

  void add(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    const auto first = static_cast<std::uint32_t>(p.size());
    p.insert(p.end(), {a, b, c});
    face.emplace_back(first, first + 1, first + 2);
  }
  std::vector<Reason> reasons(Precision precision = Precision::real_double) const {
    auto camera = std::make_shared<Camera>();
    camera->resolution = {48, 48};
    camera->fov_y = 1.5707963267948966;
    camera->near_z = 1;
    camera->far_z = 50;
    auto mesh = std::make_shared<Mesh>();
    mesh->columns.push_back(Column::make("triangle", Domain::face, std::span<const glm::uvec3>(face)));
    mesh->columns.push_back(
        Column::make("position", Domain::vertex, std::span<const glm::dvec3>(p), Space::eye));
    mesh->camera = camera;
    Context ctx = test::with_precision(precision);
    const Buffer eye = test::buffer_of(mesh), cam = test::buffer_of(camera);
    const auto run = [&](const NodeType& type, const test::NodeInputs& in) {
      return test::run_node(type, Json::object(), in, &ctx).at(0);
    };
    const Buffer clip = run(nodes::project_perspective(), {{eye}, {cam}});
    const Buffer cut = run(nodes::clip_homogeneous(), {{clip}});
    const Buffer screen = run(nodes::project_viewport(), {{cut}, {cam}});
    const Buffer hits = run(nodes::rasterize_triangles(), {{screen}, {}});
    const auto out =
        test::run_node(nodes::visibility_classify(), Json::object(), {{clip}, {screen}, {hits}}, &ctx);
    const auto codes = out.at(1).as<Mesh>()->at("reason").values<std::uint32_t>();
    std::vector<Reason> reasons;
    for (const std::uint32_t code : codes) reasons.push_back(static_cast<Reason>(code));
    double sum = 0;
    for (const double n : out.at(0).as<Table>()->columns[2].numbers) sum += n;
    EXPECT_EQ(sum, static_cast<double>(face.size()));
    return reasons;
  }
};

TEST(VisibilityClassify, NamesEveryReason) {
  Case c;
  c.add({-4, -4, -5}, {4, -4, -5}, {0, 4, -5});  // in front of all
  c.add({-1, -1, -9}, {1, -1, -9}, {0, 1, -9});  // behind it
  c.add({-1, -1, -4}, {0, 1, -4}, {1, -1, -4});  // turned away, and yet seen: it is in front
  c.add({-1, -1, -9}, {0, 1, -9}, {1, -1, -9});  // turned away, and hidden
  c.add({90, 0, -5}, {99, 0, -5}, {90, 9, -5});  // beside the volume
  c.add({0, 0, 5}, {1, 0, 5}, {0, 1, 5});        // behind the eye
  c.add({8, 8, -10.001}, {8.0001, 8, -10.001}, {8, 8.0001, -10.001});  // between samples
  EXPECT_EQ(c.reasons(),
            (std::vector<Reason>{Reason::visible, Reason::hidden, Reason::visible, Reason::back_facing,
                                 Reason::outside, Reason::outside, Reason::between_samples}));
}

TEST(VisibilityClassify, OfCoincidentFacesTheFirstIsSeen) {
  Case c;
  for (int k = 0; k < 3; ++k) c.add({-4, -4, -5}, {4, -4, -5}, {0, 4, -5});
  EXPECT_EQ(c.reasons(), (std::vector<Reason>{Reason::visible, Reason::hidden, Reason::hidden}));
}

// What rays from the eye through the middles of all pixels say of each face, by Moeller & Trumbore. Hits within 2 %
// of a side and depths within 0.02 of one another are neither believed nor ruled out: corners snap to 2^-8 px.
struct Rays {
  std::vector<char> seen, perhaps;

  explicit Rays(const Case& c) : seen(c.face.size(), 0), perhaps(c.face.size(), 0) {
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 48; ++x) cast(c, {(x + 0.5) / 24 - 1, 1 - (y + 0.5) / 24, -1});
  }
  void cast(const Case& c, const glm::dvec3& d) {
    struct Hit {
      double t;
      std::size_t face;
      bool firm;
    };
    std::vector<Hit> hits;
    for (std::size_t f = 0; f < c.face.size(); ++f) {
      const glm::dvec3 *p = &c.p[3 * f], e1 = p[1] - p[0], e2 = p[2] - p[0], h = glm::cross(d, e2);
      const double a = glm::dot(e1, h);
      const glm::dvec3 q = glm::cross(-p[0], e1);
      const double u = glm::dot(-p[0], h) / a, v = glm::dot(d, q) / a, t = glm::dot(e2, q) / a;
      const double inside = std::min({u, v, 1 - u - v});
      if (inside > -0.02) hits.push_back({t, f, inside > 0.02});
    }
    for (const Hit& hit : hits) {
      bool first = hit.firm, hidden = false;
      for (const Hit& other : hits) {
        if (other.face == hit.face) continue;
        first = first && hit.t + 0.02 < other.t;
        hidden = hidden || (other.firm && other.t + 0.02 < hit.t);
      }
      if (first) seen[hit.face] = 1;
      if (!hidden) perhaps[hit.face] = 1;
    }
  }
};

TEST(VisibilityClassify, AgreesWithRays) {
  test::Random random(48);
  int visible = 0, invisible = 0;
  for (int round = 0; round < 12; ++round) {
    Case c;
    for (int i = 0; i < 40; ++i) {
      const double w = random.uniform(3, 20), size = std::exp2(random.uniform(-1, 2));
      const glm::dvec3 m(random.uniform(-1.3, 1.3) * w, random.uniform(-1.3, 1.3) * w, -w);
      const auto corner = [&] {
        const glm::dvec3 offset(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.2, 0.2));
        return m + size * offset;
      };
      const glm::dvec3 a = corner(), b = corner();
      c.add(a, b, corner());
    }
    const Rays rays(c);
    const auto reasons = c.reasons();
    for (std::size_t f = 0; f < reasons.size(); ++f) {
      if (rays.seen[f]) {
        ++visible;
        EXPECT_EQ(reasons[f], Reason::visible) << round << ", " << f;
      } else if (!rays.perhaps[f]) {
        ++invisible;
        EXPECT_NE(reasons[f], Reason::visible) << round << ", " << f;
      }
    }
  }
  EXPECT_GT(visible, 100);
  EXPECT_GT(invisible, 50);
}

}  // namespace
}  // namespace frustum
