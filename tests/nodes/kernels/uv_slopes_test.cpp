// The bound of a face's slopes against the slopes that are rasterized.
#include "nodes/kernels/uv_slopes.h"

#include "nodes/kernels/interpolate_attributes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace frustum::kernels {
namespace {

struct Face {
  std::vector<glm::vec4> position;
  std::vector<glm::vec2> uv;
};

Face random_face(std::mt19937_64& random) {
  std::uniform_real_distribution<float> px(0, 40), coordinate(-2, 2), exponent(-3, 3);
  Face f;
  for (int k = 0; k < 3; ++k) {
    f.position.emplace_back(px(random), px(random), 0.5F, std::exp2(exponent(random)));
    f.uv.emplace_back(coordinate(random), coordinate(random));
  }
  return f;
}

UvFace of(const Face& f) {
  UvFace u;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto corner = snap(f.position[k], corner_bits);
    u.px[k] = glm::dvec2(corner->x, corner->y) / double{corner_unit};
    u.per_w[k] = f.position[k].w, u.uv[k] = f.uv[k];
  }
  return u;
}

// The greatest of the slopes that interpolate_attributes stores inside of the face.
double greatest_stored(const Face& f, Interpolation kind, const glm::dmat2& texels) {
  const std::vector<glm::uvec3> triangle{{0, 1, 2}};
  const ScreenMesh<float> mesh{f.position, triangle, {}};
  WeightedCorners corners(mesh, 0, kind);
  const UvFace exact = of(f);
  double largest = 0;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      const glm::dvec2 at(x + 0.5, y + 0.5);
      int sides = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 &a = exact.px[k], &b = exact.px[(k + 1) % 3];
        sides += (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x) >= 0 ? 1 : -1;
      }
      if (std::abs(sides) != 3) continue;
      const SampleWeights w = corners.at(x, y, sample_unit / 2, sample_unit / 2);
      Attribute<float> uv{&f.uv[0].x, 2, AttributeDomain::vertex};
      float v[6];
      for (std::size_t i = 0; i < 2; ++i)
        uv.value[i] = {&v[i], 0, 0}, uv.dx[i] = {&v[2 + i], 0, 0}, uv.dy[i] = {&v[4 + i], 0, 0};
      interpolate_attribute(uv, mesh, 0, w, 0, 0, 0);
      for (const std::size_t i : {2U, 4U}) {
        const glm::dvec2 d = texels * glm::dvec2(v[i], v[i + 1]);
        largest = std::max(largest, std::hypot(d.x, d.y));
      }
    }
  return largest;
}

TEST(UvSlopes, NoPixelSeesMoreThanTheBound) {
  std::mt19937_64 random(1);
  const glm::dmat2 texels(64, 3, -7, 16);
  int faces = 0;
  double tightest = 10, at_a_corner_only = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Face f = random_face(random);
    const double bound = greatest_uv_slope(of(f), texels);
    for (const auto kind : {Interpolation::hyperbolic, Interpolation::affine}) {
      const double stored = greatest_stored(f, kind, texels);
      if (stored == 0) continue;
      ++faces;
      ASSERT_LE(stored, bound);
      if (kind == Interpolation::hyperbolic) tightest = std::min(tightest, bound / stored);
    }
    // What the first corner alone would say: too little, for every other face.
    Face flat = f;
    for (auto& p : flat.position) p.w = f.position[0].w;
    if (greatest_stored(f, Interpolation::hyperbolic, texels) > greatest_uv_slope(of(flat), texels))
      ++at_a_corner_only;
  }
  EXPECT_GT(faces, 2000);
  EXPECT_LT(tightest, 1.2) << "the bound is of use";
  EXPECT_GT(at_a_corner_only, 300) << "the bound of a parallel projection does not hold here";
}

TEST(UvSlopes, AreWhatAHandWouldFind) {
  // One unit of u over 10 px, of v over 20 px, w constant.
  const UvFace f{{glm::dvec2{0, 0}, {10, 0}, {0, 20}}, {1, 1, 1}, {glm::dvec2{0, 0}, {1, 0}, {0, 1}}};
  EXPECT_NEAR(greatest_uv_slope(f, glm::dmat2(64, 0, 0, 64)), 6.4, 1e-4);
  EXPECT_NEAR(greatest_uv_slope(f, glm::dmat2(1, 0, 0, 64)), 3.2, 1e-4);
  UvFace line = f;
  line.px[2] = {20, 0};
  EXPECT_EQ(greatest_uv_slope(line, glm::dmat2(1)), 0) << "no area, no sample";
  for (const double q : {0.0, -1.0, double{NAN}, double{INFINITY}}) {
    UvFace wild = f;
    wild.per_w[1] = q;
    EXPECT_EQ(greatest_uv_slope(wild, glm::dmat2(1)), INFINITY) << q;
  }
}

}  // namespace
}  // namespace frustum::kernels
