// Shadows: whole of a surface and no more, at any scale, and light only where it may be; shading of polygons.
#include "nodes/kernels/lighting.h"
#include "nodes/kernels/polygon_colors.h"
#include "nodes/kernels/seen_face.h"
#include "nodes/kernels/triangle_tree.h"
#include "nodes/shade/shadow_map.h"
#include "nodes/vector/reflect.h"
#include "tests/hard/exact.h"
#include "tests/hard/naive.h"
#include "tests/hard/stages.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

using glm::dvec2, glm::dvec3, glm::vec3;
using kernels::TriangleTree, kernels::Sight;

struct Body {
  std::vector<vec3> position;
  std::vector<glm::uvec3> triangle;
  std::vector<dvec3> wide() const { return {position.begin(), position.end()}; }
  std::array<vec3, 3> corners(const glm::uvec3& t) const {
    return {position[t.x], position[t.y], position[t.z]};
  }
};

// Of 2 rings segments triangles; a star where `bumps` is not 0.
Body ball(std::uint32_t segments, std::uint32_t rings, double radius, double bumps = 0) {
  Body b;
  for (std::uint32_t j = 0; j <= rings; ++j)
    for (std::uint32_t i = 0; i < segments; ++i) {
      const double u = 2 * M_PI * i / segments, v = M_PI * j / rings;
      const double r = radius * (1 + bumps * std::cos(7 * u) * std::sin(5 * v));
      // Poles are one point, and hold exactly.
      const double ring = j == 0 || j == rings ? 0 : std::sin(v);
      b.position.emplace_back(dvec3(ring * std::cos(u), std::cos(v), -ring * std::sin(u)) * r);
    }
  for (std::uint32_t j = 0; j < rings; ++j)
    for (std::uint32_t i = 0; i < segments; ++i) {
      const std::uint32_t k = (i + 1) % segments, a = j * segments + i, c = a + segments;
      b.triangle.emplace_back(a, c, c - i + k);
      b.triangle.emplace_back(a, c - i + k, a - i + k);
    }
  return b;
}

// Moller & Trumbore 1997 in float, any hit beyond `least`.
bool textbook_hit(const Body& b, const vec3& from, const vec3& way, float least) {
  for (const glm::uvec3& t : b.triangle) {
    const auto [p, q, r] = b.corners(t);
    const vec3 e1 = q - p, e2 = r - p;
    const auto cross = [](const vec3& x, const vec3& y) {
      return vec3(x.y * y.z - x.z * y.y, x.z * y.x - x.x * y.z, x.x * y.y - x.y * y.x);
    };
    const vec3 pv = cross(way, e2);
    const float det = naive::dot(e1, pv);
    if (det == 0) continue;
    const vec3 tv = from - p;
    const float u = naive::dot(tv, pv) / det;
    const vec3 qv = cross(tv, e1);
    const float v = naive::dot(way, qv) / det, at = naive::dot(e2, qv) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && at > least) return true;
  }
  return false;
}

void watertight(Trial& t) {
  const Body star = ball(64, 63, 1, 0.3);  // 8064 triangles
  const TriangleTree all(star.wide(), star.triangle);
  std::uint32_t last = 0;
  std::size_t naive_tests = 0;
  for (std::size_t f = 0; f < star.triangle.size(); ++f)
    for (int c = 0; c < 3; ++c)
      for (const float share : {0.0F, 0.5F, 0.3F}) {
        const auto corner = star.corners(star.triangle[f]);
        const auto k = static_cast<std::size_t>(c);
        const vec3 at = corner[k] * (1 - share) + corner[(k + 1) % 3] * share;
        // The textbook's test is linear in the triangles: every 97th way shows what it does.
        const bool leak = naive_tests++ % 97 == 0 && !textbook_hit(star, vec3(0), at, 0);
        const kernels::RayHit hit = all.nearest({dvec3(0), dvec3(at)});
        const bool hidden = all.hide({dvec3(0), dvec3(at), false}, 0, last);
        t.tally(leak, !hidden || !(hit.t < 1 + 1e-6), {at.x, at.y, at.z});
      }
}

void acne_across_scales(Trial& t) {
  for (const double radius : {1e-8, 1e-3, 1.0, 1e3, 1e6, 1e8}) {
    const Body b = ball(24, 12, radius);
    const TriangleTree all(b.wide(), b.triangle);
    std::uint32_t last = 0;
    for (const glm::uvec3& f : b.triangle) {
      const auto [p, q, r] = b.corners(f);
      const kernels::SeenFace face = kernels::seen_face(dvec3(p), dvec3(q), dvec3(r), u32);
      if (face.normal == dvec3(0)) continue;
      for (const float v : {0.2F, 0.4F}) {
        const vec3 at = p + (q - p) * 0.3F + (r - p) * v;
        const bool hidden =
            all.hide({kernels::on_face(face, dvec3(at)), face.normal, false}, face.slack, last);
        t.tally(textbook_hit(b, at, vec3(face.normal), 1e-4F), hidden, {radius, at.x, at.y, at.z});
      }
    }
  }
}

// A wall 1e-5 thick on a floor, with the sun low behind it: the floor is dark right from its foot.
void thin_wall(Trial& t) {
  Body b{{{-1, 0, 0},
          {1, 0, 0},
          {1, 1, 0},
          {-1, 1, 0},
          {-1, 0, -1e-5F},
          {1, 0, -1e-5F},
          {1, 1, -1e-5F},
          {-1, 1, -1e-5F},
          {-1, 0, -1},
          {-1, 0, 1},
          {1, 0, 1},
          {1, 0, -1}},
         {{0, 1, 2}, {0, 2, 3}, {5, 4, 7}, {5, 7, 6}, {8, 9, 10}, {8, 10, 11}}};
  const TriangleTree all(b.wide(), b.triangle);
  const kernels::SeenFace ground = kernels::seen_face({-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, u32);
  std::uint32_t last = 0;
  for (const double slope : {0.05, 0.5, 1.0})
    for (const double away : {2e-6, 5e-6, 1e-5, 5e-5, 1e-3, 0.1}) {
      const vec3 p(0.123F, 0, static_cast<float>(away));
      const dvec3 to_sun(0.1, slope, -1);
      t.tally(!textbook_hit(b, p, vec3(to_sun), 1e-4F),
              !all.hide({kernels::on_face(ground, dvec3(p)), to_sun, false}, ground.slack, last),
              {slope, away});
      const vec3 q(0.123F, 0, static_cast<float>(-1e-5 - away));
      t.require(!all.hide({kernels::on_face(ground, dvec3(q)), to_sun, false}, ground.slack, last),
                "light in front", {slope, away});
    }
}

// Points of faces that turn away from a light, with normals that do not.
void light_from_below(Trial& t) {
  const Body b = ball(12, 6, 1);
  const TriangleTree all(b.wide(), b.triangle);
  std::uint32_t last = 0;
  const std::array lights{kernels::LightSource<double>{false, {1, 1, 1}, {0.6, 0.64, 0.48}, {}}};
  const dvec3 l(0.6, 0.64, 0.48);
  const kernels::LightSetup<double> setup{lights, {}, kernels::Highlight::none, kernels::Exponent<double>(1)};
  for (const glm::uvec3& f : b.triangle) {
    const auto [p, q, r] = b.corners(f);
    const kernels::SeenFace face = kernels::seen_face(dvec3(p), dvec3(q), dvec3(r), u32);
    const dvec3 at(p * 0.4F + q * 0.35F + r * 0.25F);
    if (face.normal == dvec3(0) || !(kernels::dot(face.normal, l) < 0) || !(kernels::dot(at, l) > 0))
      continue;
    const auto light = kernels::receive(setup, {at.x, at.y, at.z}, {at.x, at.y, at.z}).diffuse[0];
    const bool hidden = all.hide({kernels::on_face(face, at), l, false}, face.slack, last);
    t.measure(light, hidden ? 0 : light, {at.x, at.y, at.z});
  }
}

void edge_on_bias(Trial& t) {
  const shadow_map::View view{kernels::look_at({0, 5, 0}, {0, 0, 0}, {0, 0, 1}).eye_from_world,
                              kernels::orthographic(4, 1, 1, 9), kernels::Viewport({64, 64})};
  for (const double tilt : {0.0, 1e-300, 1e-30, 1e-10, 1.0})
    for (const double bias : {0.0, 1.0, 4.0}) {
      const kernels::SeenFace face{dvec3(0), kernels::normalized(dvec3(1, tilt, 0)).value(), 0};
      const auto seen = shadow_map::seen_from_light(view, face, dvec3(0)).value();
      const double textbook =
          bias * 0.5 * (std::fabs(-face.normal.x / face.normal.y) + std::fabs(face.normal.z / face.normal.y));
      const double ours = shadow_map::depth_tolerance(seen, face, bias, 0.5, 0x1p-8, u32);
      t.tally(textbook != textbook, !(ours > 0), {tilt, bias});
    }
}

void orientation_of_polygons(Trial& t) {
  const std::array<dvec2, 4> square{{{-20, -20}, {20, -20}, {20, 20}, {-20, 20}}};
  const std::array<dvec3, 4> bright{{dvec3(1), dvec3(0), dvec3(0), dvec3(0)}};
  for (int degrees = 0; degrees <= 90; degrees += 5)
    for (const dvec2& p : {dvec2(0.3, 0.7), dvec2(-12, 3), dvec2(9, -11), dvec2(15, 2)}) {
      const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
      const auto turned = [&](const dvec2& q) { return dvec2(c * q.x - s * q.y, s * q.x + c * q.y); };
      std::array<dvec2, 4> corner;
      std::transform(square.begin(), square.end(), corner.begin(), turned);
      const kernels::ColoredPolygon level{square, bright}, tilted{corner, bright};
      const auto a = kernels::scan_line_color(level, p), b = kernels::scan_line_color(tilted, turned(p));
      const double naive_change = a && b ? std::fabs(a->x - b->x) : 1;
      t.measure(
          naive_change,
          std::fabs(kernels::mean_value_color(level, p).x - kernels::mean_value_color(tilted, turned(p)).x),
          {double(degrees), p.x, p.y});
      // Colours that are linear over the plane are met wherever the polygon lies.
      std::array<dvec3, 4> linear;
      for (std::size_t i = 0; i < 4; ++i) linear[i] = dvec3(corner[i].x * 0.25 - corner[i].y * 0.5 + 3);
      const dvec2 q = turned(p);
      const double want = q.x * 0.25 - q.y * 0.5 + 3;
      t.require(std::fabs(kernels::mean_value_color({corner, linear}, q).x - want) <= 18 * 16 * u64,
                "linear colours", {double(degrees)});
    }
}

void reflection_off_unit(Trial& t) {
  for (const double size : {1 - 1e-6, 1 + 1e-6, 1e-3, 1e3})
    for (const double angle : {0.0, 0.5, 1.2, 1.57079}) {
      const dvec3 n = dvec3(0.36, 0.48, 0.8) * size,
                  l = dvec3(0.36, 0.48, 0.8) * std::cos(angle) + dvec3(0.8, -0.6, 0) * std::sin(angle);
      const double length = kernels::norm(l);
      const dvec3 textbook = n * (2 * naive::dot(n, l)) - l;
      const dvec3 got = vector::mirrored(l, n).value();
      t.measure(std::fabs(kernels::norm(textbook) - length) / length / u64,
                std::fabs(kernels::norm(got) - length) / length / u64, {size, angle});
    }
}

}  // namespace

std::vector<HardCase> shadows() {
  return {
      {"ZBF-04", "faces that a light sees edge on, biases of 0 to 4 slopes", "bias times slope",
       "shadow_map::depth_tolerance", "truth table", "a number above 0", "NaN results", 0, edge_on_bias},
      {"SHD-07", "a square with one bright corner, turned by 0 to 90 degrees", "bilinear along scan lines",
       "kernels::mean_value_color", "the same point of the square, not turned",
       "the colour does not change; linear colours are met", "change of colour", 1e-6,
       orientation_of_polygons},
      {"SHD-09", "faces of a coarse ball that turn away from a light, with normals that do not",
       "max(0, n.l)", "kernels::TriangleTree", "truth table", "no light from below the surface", "light", 0,
       light_from_below},
      {"SHD-10", "normals of lengths 1 - 1e-6 to 1e3, light from straight on to grazing", "2 n (n.l) - l",
       "vector::mirrored", "the length of l", "| |r| - |l| | <= 4 u |l|", "u |l|", 4, reflection_off_unit},
      {"RAY-08", "ways from inside a star of 8064 triangles through its corners and sides",
       "Moller and Trumbore in float", "kernels::TriangleTree", "truth table: the star is closed",
       "every way meets the star", "leaks", 0, watertight},
      {"RAY-14", "balls of radius 1e-8 to 1e8, ways straight up from their faces", "hits beyond t = 1e-4",
       "kernels::TriangleTree with seen_face's slack", "truth table: the ball is convex",
       "no face hides itself", "self-hits", 0, acne_across_scales},
      {"RAY-15", "the floor behind a wall 1e-5 thick, from 2e-6 to 0.1 off its foot", "hits beyond t = 1e-4",
       "kernels::TriangleTree with seen_face's slack", "truth table", "dark behind the wall, light before it",
       "leaks", 0, thin_wall},
  };
}

}  // namespace frustum::hard
