// Z-buffer and A-buffer.
#include "nodes/color/convert.h"
#include "nodes/kernels/simd/composite.h"
#include "nodes/kernels/sum.h"
#include "tests/hard/exact.h"
#include "tests/hard/screen.h"
#include "tests/hard/stages.h"
#include "tests/hard/threads.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <vector>

namespace frustum::hard {
namespace {

using glm::vec2, glm::vec4;
constexpr float infinity = std::numeric_limits<float>::infinity(),
                nan = std::numeric_limits<float>::quiet_NaN();

// A rectangle of the screen as two triangles, cut along either diagonal; its depth is z(x, y).
template <class Depth>
void add_quad(ScreenTriangles& mesh, float x0, float y0, float x1, float y1, bool other_diagonal,
              std::uint32_t source, Depth&& z) {
  const auto at = [&](float x, float y) { return vec4(x, y, z(x, y), 1); };
  const vec4 a = at(x0, y0), b = at(x1, y0), c = at(x1, y1), d = at(x0, y1);
  if (other_diagonal)
    mesh.add(a, b, d, source), mesh.add(b, c, d, source);
  else
    mesh.add(a, b, c, source), mesh.add(a, c, d, source);
}

bool same_picture(const Picture& a, const Picture& b) {
  return a.id == b.id && std::equal(a.z.begin(), a.z.end(), b.z.begin(), [](float x, float y) {
           return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
         });
}

// z of the plane through three points, carried along each row by adding dz/dx.
std::vector<float> stepped(float z_left, float dz_dx, int width) {
  std::vector<float> z(static_cast<std::size_t>(width));
  float at = z_left + 0.5F * dz_dx;
  for (float& x : z) x = at, at += dz_dx;
  return z;
}

void nearly_parallel_planes(Trial& t) {
  constexpr int width = 1024, height = 16;
  for (std::size_t n = t.samples(40, 2000); n-- > 0;) {
    const auto slope = static_cast<float>(t.random.uniform(1e-7, 1e-6)),
               crossing = static_cast<float>(t.random.uniform(100, 900));
    const auto one = [&](float x, float) { return 0.5F + slope * (x - crossing); };
    const auto other = [&](float x, float) { return 0.5F - slope * (x - crossing); };
    ScreenTriangles mesh;
    add_quad(mesh, 0, 0, width, height, false, 0, one);
    add_quad(mesh, 0, 0, width, height, true, 1, other);
    const Picture got = filled(mesh.mesh(), width, height);
    // Where the planes of the stored corners meet.
    const double left = static_cast<double>(one(0, 0)) - static_cast<double>(other(0, 0));
    const double right = static_cast<double>(one(width, 0)) - static_cast<double>(other(width, 0));
    const double line = width * left / (left - right);
    const auto a = stepped(one(0, 0), (one(width, 0) - one(0, 0)) / width, width);
    const auto b = stepped(other(0, 0), (other(width, 0) - other(0, 0)) / width, width);
    double naive_off = 0, off = 0;
    for (int x = 0; x < width; ++x) {
      const double beyond = std::fabs(x + 0.5 - line);
      const std::uint32_t want = x + 0.5 < line ? 0 : 1;
      for (int y = 0; y < height; ++y)
        if (got.at(x, y) != want) off = std::max(off, beyond);
      const auto i = static_cast<std::size_t>(x);
      if ((a[i] <= b[i] ? 0U : 1U) != want) naive_off = std::max(naive_off, beyond);
    }
    t.measure(naive_off, off, {slope, crossing});
  }
}

void steep_depth(Trial& t) {
  for (std::size_t n = t.samples(300, 30000); n-- > 0;) {
    const vec2 a(static_cast<float>(t.random.uniform(4, 60)), static_cast<float>(t.random.uniform(4, 60)));
    const vec2 along(static_cast<float>(t.random.uniform(-50, 50)),
                     static_cast<float>(t.random.uniform(-50, 50)));
    const vec2 across =
        vec2(-along.y, along.x) * static_cast<float>(0.7 / (1 + std::fabs(along.x) + std::fabs(along.y)));
    const auto far = static_cast<float>(std::fabs(t.random.magnitude(-4, 30)));
    const std::array<vec4, 3> p{vec4(a, 0, 1), vec4(a + along, 0, 1), vec4(a + along + across, far, 1)};
    ScreenTriangles mesh;
    mesh.add(p[0], p[1], p[2], 0);
    const Picture got = filled(mesh.mesh(), 64, 64);
    // The textbook: z = A x + B y + C, C multiplied out.
    const vec2 ab = vec2(p[1]) - a, ac = vec2(p[2]) - a;
    const float area = ab.x * ac.y - ab.y * ac.x;
    const float z_x = -far * ab.y / area, z_y = far * ab.x / area;
    const float z_0 = -(z_x * a.x + z_y * a.y);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        if (got.at(x, y) == kernels::no_face) continue;
        const float z = z_x * (static_cast<float>(x) + 0.5F) + z_y * (static_cast<float>(y) + 0.5F) + z_0;
        const auto outside = [&](float depth) {
          return static_cast<double>(std::max({-depth, depth - far, 0.0F})) / static_cast<double>(far);
        };
        t.measure(outside(z), outside(got.depth(x, y)), {a.x, a.y, along.x, along.y, far});
      }
  }
}

void mean_of_fragments(Trial& t) {
  const std::size_t n = t.samples(200000, 1000000);
  std::vector<float> values(n);
  for (float& v : values) v = static_cast<float>(std::exp(t.random.uniform(std::log(1e-3), std::log(1e3))));
  const auto textbook = [](const std::vector<float>& v) {
    float mean = 0, count = 0;
    for (const float x : v) mean += (x - mean) / ++count;
    return mean;
  };
  const auto robust = [](const std::vector<float>& v) {
    kernels::CompensatedSum<double> sum;
    for (const float x : v) sum.add(static_cast<double>(x));
    return static_cast<float>(sum.value() / static_cast<double>(v.size()));
  };
  const auto order_free = [](const std::vector<float>& v) {
    kernels::ExactSum sum;
    for (const float x : v) sum.add(static_cast<double>(x));
    return static_cast<float>(sum.value() / static_cast<double>(v.size()));
  };
  Rational sum = 0;
  for (const float v : values) sum += Rational(v);
  const Real want = Real(Rational(sum / Rational(n)));
  const float first = order_free(values);
  t.measure(ulps(textbook(values), want), std::max(ulps(robust(values), want), ulps(first, want)),
            {static_cast<double>(n)});
  for (int round = 0; round < 5; ++round) {
    for (std::size_t i = n; i-- > 1;) std::swap(values[i], values[t.random.below(i + 1)]);
    t.require(order_free(values) == first && robust(values) == first,
              "the order of fragments does not matter");
  }
  t.price([&] { keep(textbook(values)); }, [&] { keep(robust(values)); });
}

void broken_depth(Trial& t) {
  const std::array<float, 5> depths{nan, -0.0F, infinity, 0.25F, 0.75F};
  std::array<std::size_t, 5> order{0, 1, 2, 3, 4};
  const auto drawn_in = [&](const std::array<std::size_t, 5>& o) {
    ScreenTriangles mesh;
    for (const std::size_t k : o)
      add_quad(mesh, 0, 0, 8, 8, false, static_cast<std::uint32_t>(k),
               [&](float, float) { return depths[k]; });
    return filled(mesh.mesh(), 8, 8);
  };
  // The textbook: draw unless something nearer is there; NaN is never farther.
  const auto textbook = [&](const std::array<std::size_t, 5>& o) {
    float z = 1;
    for (const std::size_t k : o)
      if (!(depths[k] >= z)) z = depths[k];
    return z;
  };
  const Picture first = drawn_in(order);
  const float naive_first = textbook(order);
  do {
    const Picture got = drawn_in(order);
    const bool stored = std::any_of(got.z.begin(), got.z.end(), [](float z) { return !std::isfinite(z); });
    const float naive_z = textbook(order);
    t.tally(!std::isfinite(naive_z) || naive_z != naive_first, stored || !same_picture(got, first),
            {static_cast<double>(order[0]), static_cast<double>(order[1])});
  } while (std::next_permutation(order.begin(), order.end()));
  t.require(first.at(3, 3) == 1 && first.depth(3, 3) == 0, "the nearest finite depth is seen");
}

void without_coverage(Trial& t) {
  std::vector<float> alphas{0, 1e-45F, 1e-38F, 1e-20F, 1e-8F, 1e-3F, 1, nan, -1};
  for (std::size_t n = t.samples(1000, 100000); n-- > 0;)
    alphas.push_back(static_cast<float>(std::fabs(t.random.magnitude(-149, 0))));
  std::vector<float> colors(alphas.size());
  for (float& c : colors) c = static_cast<float>(std::fabs(t.random.magnitude(-20, 12)));
  std::vector<float> straight = colors;
  divide_by_alpha(alphas.data(), straight.data(), straight.size());
  std::vector<float> back = straight;
  multiply_by_alpha(alphas.data(), back.data(), back.size());
  for (std::size_t i = 0; i < alphas.size(); ++i) {
    const float naive_straight = colors[i] / alphas[i], naive_back = naive_straight * alphas[i];
    t.measure(ulps(naive_back, Real(colors[i])),
              std::isfinite(straight[i]) ? ulps(back[i], Real(colors[i])) : infinity, {alphas[i], colors[i]});
  }
  t.price(
      [&] {
        for (std::size_t i = 0; i < alphas.size(); ++i) straight[i] = colors[i] / alphas[i];
        keep(straight[0]);
      },
      [&] {
        std::copy(colors.begin(), colors.end(), straight.begin());
        divide_by_alpha(alphas.data(), straight.data(), straight.size());
        keep(straight[0]);
      });
}

// Layers of one pixel, premultiplied: colour in [0, alpha], alpha up to 2e-3.
struct ThinLayers {
  std::vector<float> color, alpha;
};

ThinLayers thin_layers(Trial& t, std::size_t n) {
  ThinLayers l;
  for (; n > 0; --n) {
    l.alpha.push_back(static_cast<float>(t.random.uniform(0, 2e-3)));
    l.color.push_back(l.alpha.back() * static_cast<float>(t.random.uniform(0, 1)));
  }
  return l;
}

// c = c + (1 - a) c_next from the front, as it is written in textbooks, in float.
float over_in_float(const ThinLayers& l) {
  float color = 0, alpha = 0;
  for (std::size_t i = 0; i < l.alpha.size(); ++i) {
    color += (1 - alpha) * l.color[i];
    alpha += (1 - alpha) * l.alpha[i];
  }
  return color;
}

float composite_all(const ThinLayers& l) {
  const float* color = l.color.data();
  float red = 0;
  kernels::simd::composite_layers(
      {{color, color, color, l.alpha.data()}, {1, 1, 1, 1}, static_cast<int>(l.alpha.size())}, 1,
      {&red, nullptr, nullptr, nullptr});
  return red;
}

void thousand_layers(Trial& t) {
  constexpr std::size_t layers = 1000;
  for (std::size_t n = t.samples(20, 400); n-- > 0;) {
    const ThinLayers l = thin_layers(t, layers);
    Real exact;  // from the back
    for (std::size_t i = layers; i-- > 0;)
      exact =
          Real(static_cast<double>(l.color[i])) + (Real(1.0) - Real(static_cast<double>(l.alpha[i]))) * exact;
    t.measure(ulps(over_in_float(l), exact), ulps(composite_all(l), exact), {l.color[0], l.alpha[0]});
  }
  const ThinLayers l = thin_layers(t, layers);
  t.price([&] { keep(over_in_float(l)); }, [&] { keep(composite_all(l)); });
}

void equal_depths(Trial& t) {
  std::array<std::uint32_t, 5> order{0, 1, 2, 3, 4};
  // Five times the same triangle, so that the depths are the same bits.
  const auto mesh_in = [](const std::array<std::uint32_t, 5>& o) {
    ScreenTriangles mesh;
    for (const auto source : o) {
      mesh.add({1, 1, 0.3F, 1}, {62, 5, 0.6F, 1}, {20, 60, 0.9F, 1}, source);
      mesh.add({62, 5, 0.6F, 1}, {60, 60, 0.2F, 1}, {20, 60, 0.9F, 1}, source);
    }
    return mesh;
  };
  const auto first_mesh = mesh_in(order);
  const Picture first = filled(first_mesh.mesh(), 64, 64);
  do {
    const auto mesh = mesh_in(order);
    Picture got;
    on_threads(1 + static_cast<int>(order[0]) * 3, [&] { got = filled(mesh.mesh(), 64, 64); });
    // The textbook keeps the last of equals.
    t.tally(order[4] != 4, !same_picture(got, first),
            {static_cast<double>(order[0]), static_cast<double>(order[4])});
  } while (std::next_permutation(order.begin(), order.end()));
  t.require(std::none_of(first.id.begin(), first.id.end(),
                         [](auto id) { return id != 0 && id != kernels::no_face; }),
            "the lowest source wins");
}

}  // namespace

std::vector<HardCase> depth() {
  return {
      {"ZBF-02", "planes 0.5 +- s (x - x0), s from 1e-7 to 1e-6 a px, over 1024 px",
       "z += dz/dx along the row, float", "kernels: bins, simd::fill_triangles",
       "the line where the stored planes meet", "the line within 1 px", "px", 1, nearly_parallel_planes},
      {"ZBF-03", "triangles less than 1 px wide with depths up to 2^30", "the plane of the depths, float",
       "kernels: bins, simd::fill_triangles", "the corners' depths", "within the corners' depths",
       "depth range outside", 0, steep_depth},
      {"ZBF-05", "1000 layers of alpha up to 0.002, random colours", "front to back in float",
       "kernels::simd::composite_layers", "MPFR, back to front", "both directions within 0.51 ulp", "ulp",
       0.51, thousand_layers},
      {"ZBF-07", "200000 values from 1e-3 to 1e3", "running mean in float",
       "kernels::CompensatedSum, ExactSum", "rationals", "within 2 ulp; the order does not matter", "ulp", 2,
       mean_of_fragments},
      {"ZBF-08", "depths NaN, -0, infinity, 0.25, 0.75 in all 120 orders", "draw unless z >= what is there",
       "kernels: bins, simd::fill_triangles", "truth table", "NaN is never stored; the order does not matter",
       "wrong pictures", 0, broken_depth},
      {"ZBF-09", "alpha 0, NaN, 1e-45 to 1; colours up to 4096", "c / alpha, float",
       "divide_by_alpha, multiply_by_alpha", "the colour itself", "finite; there and back within 1 ulp",
       "ulp", 1, without_coverage},
      {"ZBF-11", "five times the same polygon in 120 orders, 1 to 13 threads", "the last of equals stays",
       "kernels: bins, simd::fill_triangles", "comparison of bits", "one picture; the lowest source wins",
       "pictures that differ", 0, equal_depths},
  };
}

}  // namespace frustum::hard
