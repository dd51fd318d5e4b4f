// Shading, and the two cases of surfaces whose kernels exist.
#include "nodes/kernels/bicubic.h"
#include "nodes/kernels/lighting.h"
#include "nodes/kernels/simd/lighting.h"
#include "nodes/kernels/vector.h"
#include "tests/hard/exact.h"
#include "tests/hard/naive.h"
#include "tests/hard/stages.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

using glm::dvec3, glm::vec3;
using kernels::Highlight;
constexpr float infinity = std::numeric_limits<float>::infinity();
using Colour = std::array<float, 3>;

// Diffuse and specular light at one point, by the vector kernel that shade.surface calls.
struct Received {
  Colour diffuse{}, specular{};
  bool finite() const {
    return std::all_of(diffuse.begin(), diffuse.end(), [](float x) { return std::isfinite(x); }) &&
           std::all_of(specular.begin(), specular.end(), [](float x) { return std::isfinite(x); });
  }
};
Received received(const kernels::LightSetup<float>& setup, const vec3& normal, const vec3& position) {
  std::array<std::vector<float>, 12> rows;
  for (auto& row : rows) row.assign(64, 0);
  kernels::PointRows<float> in;
  kernels::LightRows<float> out;
  for (std::size_t k = 0; k < 3; ++k) {
    rows[k][0] = normal[static_cast<int>(k)], rows[3 + k][0] = position[static_cast<int>(k)];
    in.normal[k] = rows[k].data(), in.position[k] = rows[3 + k].data();
    out.diffuse[k] = rows[6 + k].data(), out.specular[k] = rows[9 + k].data();
  }
  std::vector<std::uint32_t> tag(64, kernels::nothing_there);
  tag[0] = 0;
  kernels::simd::receive_light(setup, in, {tag.data()}, 1, out);
  Received r;
  for (std::size_t k = 0; k < 3; ++k) r.diffuse[k] = out.diffuse[k][0], r.specular[k] = out.specular[k][0];
  return r;
}

kernels::LightSource<float> directional(const vec3& to_light) {
  return {.is_point = false, .color = {1, 1, 1}, .place = {to_light.x, to_light.y, to_light.z}};
}

void vanishing_normal(Trial& t) {
  const std::array lights{directional({0, 0, 1})};
  const kernels::LightSetup<float> setup{lights, {0, 0, 5}, Highlight::blinn, kernels::Exponent<float>(20)};
  const auto textbook = [](const vec3& n) {
    return std::max(naive::dot(naive::normalized(n), vec3(0, 0, 1)), 0.0F);
  };
  for (const vec3& n : {vec3(0), vec3(-0.0F, 0, 0), vec3(1e-30F, 0, 0) - vec3(1e-30F, 0, 0)}) {
    const float naive_light = textbook(n);
    t.tally(!(naive_light == naive_light), !received(setup, n, vec3(0)).finite(), {n.x, n.y, n.z});
  }
  // A little off the point the light is that of the unit normal again.
  for (const float size : {1e-6F, 1e-3F, 1.0F}) {
    const float light = received(setup, vec3(0, 0.6F, 0.8F) * size, vec3(0)).diffuse[0];
    t.require(std::fabs(light - 0.8F) <= 4 * u32, "the light of the unit normal", {size});
  }
}

void vanishing_half_vector(Trial& t) {
  for (int k = 0; k <= 30; ++k)
    for (const float sign : {1.0F, -1.0F}) {
      // The eye looks from behind the point, straight at the light, or 10^-k off.
      const float off = k == 0 ? 0 : sign * static_cast<float>(std::pow(10, -k));
      const std::array lights{directional({0, 0, 1})};
      const kernels::LightSetup<float> setup{
          lights, {off, 0, -1}, Highlight::blinn, kernels::Exponent<float>(20)};
      const Received r = received(setup, vec3(0, 0, 1), vec3(0));
      const vec3 v = naive::normalized(vec3(off, 0, -1)), h = naive::normalized(vec3(0, 0, 1) + v);
      const float textbook = std::pow(std::max(h.z, 0.0F), 20.0F);
      t.tally(!std::isfinite(textbook) || h.z != h.z, !r.finite() || r.specular[0] < 0 || r.specular[0] > 1,
              {off});
    }
}

void large_shininess(Trial& t) {
  for (const auto& [angle, n] : {std::pair{1e-4, 1e6}, {3e-4, 1e7}, {1e-3, 1e5}}) {
    const std::array lights{directional({0, 0, 1})};
    // The eye is 2 t off the light, so that the half vector is t off the normal.
    const auto x = static_cast<float>(std::tan(2 * angle));
    const kernels::LightSetup<float> setup{lights, {x, 0, 1}, Highlight::blinn, kernels::Exponent<float>(n)};
    const float got = received(setup, vec3(0, 0, 1), vec3(0)).specular[0];
    const Real want = exact([&, n = n] {
      const Real t2 = atan2(Real(x), Real(1.0));
      return exp(Real(n) * log(cos(t2 / Real(2.0))));
    });
    const vec3 h = naive::normalized(vec3(0, 0, 1) + naive::normalized(vec3(x, 0, 1)));
    const auto textbook = std::pow(h.z, static_cast<float>(n));
    const double unit = u32 * (1 + n * angle * angle);
    t.measure(distance(textbook, want, want) / unit, distance(got, want, want) / unit, {angle, n});
  }
}

void corners_of_pow(Trial& t) {
  for (const float e : {0.0F, 0.5F, 50.5F, 1000.0F, 1e4F, 1e30F, infinity})
    for (const float x : {-1e-9F, -1.0F, 0.0F, 1e-30F, 0.5F, 0x1.fffffep-1F, 1.0F}) {
      const kernels::Exponent<float> exponent(e);
      const float held = std::clamp(x, 0.0F, 1.0F);  // as highlight_cosine gives it
      const float got = exponent(held), textbook = std::pow(x, e);
      t.tally(!(textbook >= 0 && textbook <= 1), !(got >= 0 && got <= 1), {x, e});
      if (e == 0) t.require(got == 1, "x^0 = 1, also of 0", {x});
    }
}

void attenuation(Trial& t) {
  for (const float distance_to : {0.0F, 1e-30F, 1e-20F, 1e-10F, 1.0F, 1e20F, 1e30F})
    for (const float intensity : {0.0F, 1.0F}) {
      const std::array<kernels::LightSource<float>, 1> lights{{{.is_point = true,
                                                                .color = {intensity, 1, 0},
                                                                .place = {0, 0, distance_to},
                                                                .attenuation = {0, 0, 1}}}};
      const kernels::LightSetup<float> setup{
          lights, {0, 0, 5}, Highlight::phong, kernels::Exponent<float>(10)};
      const Received r = received(setup, vec3(0, 0, 1), vec3(0));
      const float textbook = intensity * (1 / (distance_to * distance_to));
      t.tally(!std::isfinite(textbook), !r.finite(), {distance_to, intensity});
      t.require(intensity != 0 || r.diffuse[0] == 0, "a light of intensity 0 gives none", {distance_to});
    }
}

void pole_of_a_patch(Trial& t) {
  // A patch of a paraboloid whose row u = 0 collapses into the pole, where it is level: points of a row share
  // a distance r_i, and a quarter turn in v is a cubic. The limit of the normal is +z.
  for (const double angle : {30.0, 60.0, 90.0, 120.0})
    for (const double radius : {1e-3, 1.0, 1e5}) {
      kernels::BicubicNet net;
      const double half = angle * M_PI / 360, k = 4.0 / 3 * std::tan(half / 2);
      const std::array<std::array<double, 2>, 4> arc{
          {{1, 0},
           {1, k},
           {std::cos(2 * half) + k * std::sin(2 * half), std::sin(2 * half) - k * std::cos(2 * half)},
           {std::cos(2 * half), std::sin(2 * half)}}};
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
          const double r = radius * static_cast<double>(i) / 3;
          net[4 * i + j] = {arc[j][0] * r, arc[j][1] * r,
                            i < 2 ? 0 : -0.1 * radius * static_cast<double>(i - 1)};
        }
      const double extent = kernels::net_extent(net);
      for (const double v : {0.0, 0.25, 0.5, 1.0}) {
        const dvec3 got = kernels::bicubic_normal(net, extent, 0, v);
        const dvec3 textbook = naive::normalized(glm::dvec3(kernels::cross(
            kernels::bicubic_derivative(net, 0, v, 1, 0), kernels::bicubic_derivative(net, 0, v, 0, 1))));
        const auto off = [](const dvec3& n) {
          const double angle_off = std::atan2(std::hypot(n.x, n.y), n.z);
          return angle_off == angle_off ? angle_off : std::numeric_limits<double>::infinity();
        };
        t.measure(off(textbook), off(got), {angle, radius, v});
      }
    }
}

}  // namespace

std::vector<HardCase> shading() {
  return {
      {"SHD-01", "interpolated normals that cancel, and 1e-6 off", "n / |n| in float",
       "kernels::simd::receive_light", "truth table", "finite; the light of the unit normal a little off",
       "NaN results", 0, vanishing_normal},
      {"SHD-03", "the eye straight behind the light, and 10^-k off", "(l + v) / |l + v| in float",
       "kernels::simd::receive_light", "truth table", "finite, in [0, 1]", "NaN results", 0,
       vanishing_half_vector},
      {"SHD-04", "half vectors 1e-4 to 1e-3 off the normal, exponents 1e5 to 1e7", "(n.h)^e in float",
       "kernels::simd::receive_light", "MPFR", "relative error <= 8 u (1 + e t^2)", "u (1 + e t^2)", 8,
       large_shininess},
      {"SHD-05", "bases -1 to 1, exponents 0 to infinity", "pow in float",
       "kernels::Exponent after highlight_cosine", "truth table", "in [0, 1] always; x^0 = 1",
       "powers outside", 0, corners_of_pow},
      {"SHD-06", "point lights at distances 0, 1e-30 to 1e30, colours of 0 and 1", "c / d^2 in float",
       "kernels::simd::receive_light", "truth table", "finite; 0 times infinity is never formed",
       "values not finite", 0, attenuation},
      {"SRF-01", "patches with a side collapsed to a point, of sizes 1e-3 to 1e5",
       "dP/du x dP/dv, normalised", "kernels::bicubic_normal", "the surface's own normal",
       "within 1e-6 rad of the limit", "rad", 1e-6, pole_of_a_patch},
  };
}

}  // namespace frustum::hard
