#include "nodes/kernels/interpolate_attributes.h"

#include <gtest/gtest.h>

#include <deque>

#include "nodes/kernels/simd/interpolate_attributes.h"
#include "tests/nodes/kernels/screen_scene.h"
#include "tests/support/simd_targets.h"

namespace frustum {
namespace {

using kernels::Attribute;
using kernels::AttributeDomain;
using kernels::Interpolation;
using kernels::no_face;
using kernels::PixelRect;
using test::Filled;
using test::Pattern;
using test::ScreenScene;
using test::Twin;

// The planes of one attribute: values, then derivatives by x, then by y, each per component; the last plane
// is w.
template <class R>
using Planes = std::deque<std::vector<R>>;

template <class R>
struct Column {
  std::vector<R> data;
  int width;
  AttributeDomain domain = AttributeDomain::vertex;
};

template <class R>
Planes<R> interpolate(const ScreenScene<R>& scene, const Filled<R>& seen, const Pattern& pattern,
                      const std::vector<Column<R>>& columns, Interpolation interpolation, Twin twin,
                      const std::vector<PixelRect>& rects = {}, bool differentiate = true) {
  const kernels::AttributeScene<R> from{scene.view(), pattern.view(), interpolation};
  Planes<R> planes;
  for (const auto& c : columns)
    for (int i = 0; i < 3 * c.width; ++i) planes.emplace_back(seen.id.size(), R(-77));
  planes.emplace_back(seen.id.size(), R(-77));
  for (const PixelRect& rect : rects.empty() ? std::vector{seen.window} : rects) {
    std::vector<Attribute<R>> attributes;
    auto plane = planes.begin();
    for (const auto& c : columns) {
      Attribute<R> a{c.data.data(), c.width, c.domain};
      for (auto* set : {&a.value, &a.dx, &a.dy})
        for (std::size_t i = 0; i < static_cast<std::size_t>(c.width); ++i, ++plane)
          if (set == &a.value || differentiate) (*set)[i] = seen.plane(*plane, rect);
      attributes.push_back(a);
    }
    const kernels::AttributePlanes<R> to{attributes, seen.plane(planes.back(), rect)};
    const kernels::PlaneView<const std::uint32_t> id{seen.id.data() + seen.at(0, rect.x0, rect.y0),
                                                     seen.width(),
                                                     std::ptrdiff_t{seen.width()} * seen.height()};
    if constexpr (std::is_same_v<R, float>)
      if (twin == Twin::vector) {
        kernels::simd::interpolate_attributes(from, rect, id, to);
        continue;
      }
    kernels::interpolate_attributes<R>(from, rect, id, to);
  }
  return planes;
}

// Triangles in perspective: corners at distances w from 1 to 20.
template <class R>
ScreenScene<R> perspective_scene(test::Random& random, int triangles, double extent) {
  ScreenScene<R> s;
  for (int i = 0; i < triangles; ++i) {
    const double size = std::exp2(random.uniform(0, 7)), x = random.uniform(0, extent),
                 y = random.uniform(0, extent);
    const auto corner = [&] {
      const double w = random.uniform(1, 20), z = random.uniform();  // one after the other, by every compiler
      const double dy = random.uniform(-size, size), dx = random.uniform(-size, size);
      return s.vertex(x + dx, y + dy, z, 1 / w);
    };
    const std::uint32_t a = corner(), b = corner(), c = corner();
    s.face.emplace_back(a, b, c);
  }
  return s;
}

template <class R>
Column<R> random_column(test::Random& random, std::size_t rows, int width,
                        AttributeDomain domain = AttributeDomain::vertex) {
  Column<R> c{{}, width, domain};
  for (std::size_t i = 0; i < rows * static_cast<std::size_t>(width); ++i)
    c.data.push_back(static_cast<R>(random.uniform(-2, 2)));
  return c;
}

// A plane through three snapped corners in long double: value of f at a screen point, where f is f_k at
// corner k.
template <class R>
long double on_plane(const ScreenScene<R>& s, std::uint32_t face, const std::array<long double, 3>& f,
                     long double x, long double y) {
  std::array<long double, 3> px, py;
  for (int k = 0; k < 3; ++k) {
    px[static_cast<std::size_t>(k)] =
        std::nearbyint(static_cast<long double>(s.position[s.face[face][k]].x) * 256) / 256;
    py[static_cast<std::size_t>(k)] =
        std::nearbyint(static_cast<long double>(s.position[s.face[face][k]].y) * 256) / 256;
  }
  const auto area = [](long double ax, long double ay, long double bx, long double by) {
    return ax * by - bx * ay;
  };
  const long double all = area(px[1] - px[0], py[1] - py[0], px[2] - px[0], py[2] - py[0]);
  const long double l1 = area(x - px[0], y - py[0], px[2] - px[0], py[2] - py[0]) / all;
  const long double l2 = area(px[1] - px[0], py[1] - py[0], x - px[0], y - py[0]) / all;
  return f[0] * (1 - l1 - l2) + f[1] * l1 + f[2] * l2;
}

// The attribute at a screen point: f/w and 1/w are planes on the screen (hyperbolic), or f itself (affine).
template <class R>
long double reference(const ScreenScene<R>& s, std::uint32_t face, const std::vector<R>& data, int width,
                      int component, Interpolation interpolation, long double x, long double y) {
  std::array<long double, 3> f, per_w;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = s.face[face][static_cast<int>(k)];
    per_w[k] = interpolation == Interpolation::hyperbolic ? static_cast<long double>(s.position[v].w) : 1;
    f[k] = static_cast<long double>(
               data[v * static_cast<std::size_t>(width) + static_cast<std::size_t>(component)]) *
           per_w[k];
  }
  return on_plane(s, face, f, x, y) / on_plane(s, face, per_w, x, y);
}

template <class R>
void expect_reference(Interpolation interpolation) {
  test::Random random(21);
  const PixelRect window{-3, 5, 90, 80};
  const auto scene = perspective_scene<R>(random, 60, 90);
  const Pattern pattern = test::random_pattern(random, 2, 4);
  const auto seen = test::fill(scene, pattern, window, Twin::scalar);
  const auto column = random_column<R>(random, scene.position.size(), 2);
  const auto planes = interpolate<R>(scene, seen, pattern, {column}, interpolation, Twin::scalar);
  std::size_t covered = 0;
  for (int s = 0; s < pattern.samples; ++s)
    for (int y = window.y0; y < window.y1; ++y)
      for (int x = window.x0; x < window.x1; ++x) {
        const std::size_t at = seen.at(s, x, y), k = pattern.view().index(s, x, y);
        const std::uint32_t face = seen.id[at];
        if (face == no_face) continue;
        ++covered;
        const long double px = x + pattern.x[k] / 4096.0L, py = y + pattern.y[k] / 4096.0L;
        for (std::size_t c = 0; c < 2; ++c) {
          const auto f = [&](long double dx, long double dy) {
            return reference(scene, face, column.data, 2, static_cast<int>(c), interpolation, px + dx,
                             py + dy);
          };
          // Weights are rounded once to R and the sum takes five more roundings of numbers up to 6.
          const double ulp = std::numeric_limits<R>::epsilon();
          ASSERT_NEAR(static_cast<double>(planes[c][at]), static_cast<double>(f(0, 0)), 16 * ulp);
          const long double h = 1e-5L;  // central differences: error h^2 f''' / 6, and rounding 1e-19 / h
          const double dx = static_cast<double>((f(h, 0) - f(-h, 0)) / (2 * h)),
                       dy = static_cast<double>((f(0, h) - f(0, -h)) / (2 * h));
          const double slack = 16 * ulp * (std::abs(dx) + std::abs(dy) + 1) + 1e-7 * (1 + dx * dx + dy * dy);
          ASSERT_NEAR(static_cast<double>(planes[2 + c][at]), dx, slack * 10) << "face " << face;
          ASSERT_NEAR(static_cast<double>(planes[4 + c][at]), dy, slack * 10) << "face " << face;
        }
      }
  EXPECT_GT(covered, 5000U);
}

TEST(InterpolateAttributes, HyperbolicIsTheRatioOfPlanes) {
  expect_reference<double>(Interpolation::hyperbolic);
  expect_reference<float>(Interpolation::hyperbolic);
}
TEST(InterpolateAttributes, AffineIsAPlaneOnTheScreen) {
  expect_reference<double>(Interpolation::affine);
  expect_reference<float>(Interpolation::affine);
}

TEST(InterpolateAttributes, HalfwayOnTheScreenIsNotHalfwayInTheScene) {
  ScreenScene<double> s;  // an edge from w = 1 to w = 3
  const std::uint32_t a = s.vertex(0.5, 0.5, 0, 1), b = s.vertex(4.5, 0.5, 0, 1 / 3.0),
                      c = s.vertex(0.5, 4.5, 0, 1);
  s.face.emplace_back(a, b, c);
  const auto seen = test::fill(s, Pattern{}, {0, 0, 5, 5}, Twin::scalar);
  const Column<double> u{{0, 1, 0}, 1};
  const auto hyperbolic = interpolate<double>(s, seen, {}, {u}, Interpolation::hyperbolic, Twin::scalar);
  const auto affine = interpolate<double>(s, seen, {}, {u}, Interpolation::affine, Twin::scalar);
  const std::size_t middle = seen.at(0, 2, 0);
  EXPECT_NEAR(hyperbolic[0][middle], 0.25, 1e-15);  // (1/2 * 1/3) / (1/2 * 1 + 1/2 * 1/3)
  EXPECT_NEAR(hyperbolic.back()[middle], 1.5, 1e-15);
  EXPECT_NEAR(affine[0][middle], 0.5, 1e-15);
  EXPECT_NEAR(affine.back()[middle], 2, 1e-15);
}

template <class R>
void expect_bits(Twin twin) {
  test::Random random(22);
  const PixelRect window{0, 0, 64, 64};
  auto scene = perspective_scene<R>(random, 200, 64);
  for (auto& p : scene.position)
    p.x = std::floor(p.x) + R(0.5), p.y = std::floor(p.y) + R(0.5);  // on pixel centres
  const auto seen = test::fill(scene, Pattern{}, window, Twin::scalar);
  const Column<R> constant{std::vector<R>(scene.position.size(), R(0.7)), 1};
  const auto column = random_column<R>(random, scene.position.size(), 3);
  const auto planes = interpolate<R>(scene, seen, {}, {constant, column}, Interpolation::hyperbolic, twin);
  int at_corners = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const std::size_t at = seen.at(0, x, y);
      if (seen.id[at] == no_face) {
        for (const auto& plane : planes) ASSERT_EQ(plane[at], R(0));
        continue;
      }
      ASSERT_EQ(planes[0][at], R(0.7));
      ASSERT_EQ(planes[1][at], R(0));
      ASSERT_EQ(planes[2][at], R(0));
      for (std::size_t c = 0; c < 3; ++c) {
        std::array<R, 3> corner;
        for (std::size_t k = 0; k < 3; ++k)
          corner[k] = column.data[scene.face[seen.id[at]][static_cast<int>(k)] * 3 + c];
        const R value = planes[3 + c][at];
        ASSERT_GE(value, std::min({corner[0], corner[1], corner[2]}));
        ASSERT_LE(value, std::max({corner[0], corner[1], corner[2]}));
        for (std::size_t k = 0; k < 3; ++k) {
          const auto& p = scene.position[scene.face[seen.id[at]][static_cast<int>(k)]];
          if (p.x != R(x + 0.5) || p.y != R(y + 0.5)) continue;
          ASSERT_EQ(value, corner[k]);
          ++at_corners;
        }
      }
    }
  EXPECT_GT(at_corners, 40);
}

TEST(InterpolateAttributes, KeepsTheBitsOfConstantsAndOfCornersAndTheirRange) {
  expect_bits<double>(Twin::scalar);
  expect_bits<float>(Twin::scalar);
}

TEST(InterpolateAttributes, CornersOfFacesHaveTheirOwnRows) {
  ScreenScene<double> s;
  for (int i = 0; i < 4; ++i) s.vertex(0.5 + 4 * (i % 2), 0.5 + 4 * (i / 2));
  s.face = {{0, 1, 2}, {1, 3, 2}};
  const auto seen = test::fill(s, Pattern{}, {0, 0, 5, 5}, Twin::scalar);
  const Column<double> corner{{0, 0, 0, 10, 30, 20}, 1, AttributeDomain::corner},
      face{{5, 6}, 1, AttributeDomain::face};
  const auto planes =
      interpolate<double>(s, seen, {}, {corner, face}, Interpolation::hyperbolic, Twin::scalar);
  ASSERT_EQ(seen.id[seen.at(0, 1, 1)], 0U);
  ASSERT_EQ(seen.id[seen.at(0, 3, 3)], 1U);
  EXPECT_EQ(planes[0][seen.at(0, 1, 1)], 0);
  EXPECT_EQ(planes[0][seen.at(0, 3, 3)],
            22.5);  // 1/4 of corner 1 (10), 1/2 of corner 3 (30), 1/4 of corner 2 (20)
  EXPECT_EQ(planes[3][seen.at(0, 1, 1)], 5);
  EXPECT_EQ(planes[3][seen.at(0, 3, 3)], 6);
  EXPECT_EQ(planes[4][seen.at(0, 3, 3)], 0);
}

std::vector<std::vector<PixelRect>> tilings(PixelRect window) {
  return {{window},
          test::tiles(window, 1, 1),
          test::tiles(window, 7, 5),
          test::tiles(window, 16, 16),
          test::tiles(window, 64, 128),
          test::tiles(window, 129, 3)};
}

void expect_same_in_any_tiles(Twin twin) {
  test::Random random(23);
  const PixelRect window{-7, 2, 170, 90};
  for (const int triangles : {20, 400, 4000})
    for (const Interpolation interpolation : {Interpolation::hyperbolic, Interpolation::affine}) {
      auto scene = perspective_scene<float>(random, triangles, 150);
      scene.corner_bits = 4 + static_cast<int>(random.below(5));
      const Pattern pattern = triangles == 20 ? test::random_pattern(random, 3, 64) : Pattern{};
      const auto seen = test::fill(scene, pattern, window, Twin::scalar);
      std::vector<Column<float>> columns;
      for (int width = 1; width <= 4; ++width)
        columns.push_back(random_column<float>(random, scene.position.size(), width));
      columns.push_back(random_column<float>(random, scene.face.size() * 3, 2, AttributeDomain::corner));
      columns.push_back(random_column<float>(random, scene.face.size(), 3, AttributeDomain::face));
      for (const bool differentiate : {true, false}) {
        const auto want =
            interpolate<float>(scene, seen, pattern, columns, interpolation, Twin::scalar, {}, differentiate);
        for (const auto& rects : tilings(window)) {
          const auto got =
              interpolate<float>(scene, seen, pattern, columns, interpolation, twin, rects, differentiate);
          for (std::size_t i = 0; i < want.size(); ++i)
            ASSERT_EQ(std::memcmp(got[i].data(), want[i].data(), want[i].size() * sizeof(float)), 0)
                << "plane " << i << " of " << want.size() << ", tiles of " << rects[0].x1 - rects[0].x0;
        }
      }
    }
}

TEST(InterpolateAttributes, AnyTilesGiveTheSameBytes) { expect_same_in_any_tiles(Twin::scalar); }

class InterpolateAttributesSimd : public test::EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, InterpolateAttributesSimd, test::every_target(), test::target_name);

TEST_P(InterpolateAttributesSimd, HasTheBytesOfItsTwinInAnyTiles) { expect_same_in_any_tiles(Twin::vector); }
TEST_P(InterpolateAttributesSimd, KeepsTheBitsOfConstantsAndOfCornersAndTheirRange) {
  expect_bits<float>(Twin::vector);
}

}  // namespace
}  // namespace frustum
