// Culling, and what lies far outside the picture.
#include "nodes/cull/backface.h"
#include "nodes/cull/frustum.h"
#include "tests/hard/exact.h"
#include "tests/hard/screen.h"
#include "tests/hard/stages.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

using glm::vec3, glm::vec4;
constexpr float largest = std::numeric_limits<float>::max();

void conservative_culling(Trial& t) {
  std::vector<vec4> positions;
  std::vector<glm::uvec3> faces;
  const auto all_outside = [&](std::size_t f, auto&& outside) {
    const auto& v = faces[f];
    for (int axis = 0; axis < 3; ++axis)
      for (const float sign : {1.0F, -1.0F})
        if (outside(positions[v.x], axis, sign) && outside(positions[v.y], axis, sign) &&
            outside(positions[v.z], axis, sign))
          return true;
    return false;
  };
  // The textbook culls what has left the cube after the divide.
  const auto after_the_divide = [](const vec4& p, int axis, float sign) {
    return sign * (p[axis] * (1 / p.w)) > 1;
  };
  const auto before_it = [](const vec4& p, int axis, float sign) { return sign * p[axis] > p.w; };  // exact
  for (std::size_t n = t.samples(100000, 10000000); n-- > 0;) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (int k = 0; k < 3; ++k) {
      // Within an ulp of a side, to either side of it; in every tenth face some corner is behind the eye.
      const float size =
          std::ldexp(static_cast<float>(t.random.uniform(0.5, 1)), static_cast<int>(t.random.below(40)) - 20);
      const std::size_t where = t.random.below(3);
      vec4 p(size, 0.5F * size, 0.25F * size,
             where == 0 ? size : std::nextafter(size, where == 1 ? 0 : largest));
      if (t.random.below(30) == 0) p *= -1.0F;
      positions.push_back(p);
    }
    faces.push_back({first, first + 1, first + 2});
  }
  const auto kept = cull::faces_not_outside<float>({}, positions, faces);
  std::size_t next = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const bool keeps = next < kept.size() && kept[next] == f, gone = all_outside(f, before_it);
    next += keeps ? 1 : 0;
    const vec4& p = positions[3 * f];
    t.tally(!gone && all_outside(f, after_the_divide), !gone && !keeps, {p.x, p.y, p.z, p.w});
    t.require(!gone || !keeps, "nothing outside is kept", {p.x, p.w});
  }
  positions.resize(30000), faces.resize(10000);
  t.price(
      [&] {
        std::vector<std::uint32_t> out;
        for (std::uint32_t f = 0; f < faces.size(); ++f)
          if (!all_outside(f, after_the_divide)) out.push_back(f);
        keep(out.size());
      },
      [&] { keep(cull::faces_not_outside<float>({}, positions, faces).size()); });
}

void edge_on_faces(Trial& t) {
  std::vector<vec3> positions;
  std::vector<glm::uvec3> faces;
  std::vector<int> want;
  const auto textbook = [](const vec3& a, const vec3& b, const vec3& c) {
    const vec3 n = glm::cross(b - a, c - a);
    const float d = -(n.x * a.x + n.y * a.y + n.z * a.z);
    return (d > 0) - (d < 0);
  };
  for (std::size_t i = t.samples(20000, 1000000); i-- > 0;) {
    // The eye is the origin; a plane through it, corners at 1e7, each moved by an ulp or not at all.
    const auto number = [&](double size) { return static_cast<float>(t.random.uniform(-size, size)); };
    const vec3 u(number(1e7), number(1e7), number(1e7)), v(number(1e7), number(1e7), number(1e7));
    std::array<vec3, 3> p{u, v, u * 0.5F + v * 0.25F};
    const auto k = t.random.below(3);
    const auto axis = static_cast<int>(t.random.below(3));
    if (t.random.below(2) == 0) p[k][axis] = std::nextafter(p[k][axis], largest);
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), p.begin(), p.end());
    faces.push_back({first, first + 1, first + 2});
    std::array<std::array<Rational, 3>, 3> m;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) m[r][c] = Rational(p[r][static_cast<int>(c)]);
    const Rational det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) +
                         m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
                         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    want.push_back(-sgn(det));  // front is where the corners turn counter-clockwise seen from the eye
  }
  std::vector<int> got(faces.size(), 0);
  const auto showing = [&](int wanted) {
    return cull::faces_showing<cull::Rows::eye_perspective, vec3>(wanted, positions, faces);
  };
  for (const int wanted : {1, -1})
    for (const auto f : showing(wanted)) got[f] = wanted;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& a = faces[f];
    const vec3& p = positions[a.x];
    t.tally(textbook(p, positions[a.y], positions[a.z]) != want[f], got[f] != want[f], {p.x, p.y, p.z});
  }
  for (auto& p : positions)
    for (int i = 0; i < 3; ++i) p[i] = static_cast<float>(t.random.uniform(-1, 1));
  t.price(
      [&] {
        std::vector<std::uint32_t> out;
        for (std::uint32_t f = 0; f < faces.size(); ++f)
          if (textbook(positions[faces[f].x], positions[faces[f].y], positions[faces[f].z]) > 0)
            out.push_back(f);
        keep(out.size());
      },
      [&] { keep(showing(1).size()); });
}

void beyond_the_guard_band(Trial& t) {
  // The textbook: corners in 1/256 px as 32-bit integers, which wrap around.
  const auto textbook = [](const ClipTriangle& triangle, int size) {
    std::array<std::array<std::int32_t, 2>, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto fixed = [&](float ndc, float sign) {
        const double px = (static_cast<double>(sign * ndc) + 1) * size / 2 * 256;
        return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::int64_t>(px)));
      };
      p[k] = {fixed(triangle[k].x / triangle[k].w, 1), fixed(triangle[k].y / triangle[k].w, -1)};
    }
    const auto edge = [&](std::size_t i, std::size_t j, int x, int y) {
      const auto w = [](std::int32_t v) { return static_cast<std::uint32_t>(v); };
      const std::uint32_t e =
          (w(p[j][0]) - w(p[i][0])) * (w(y) - w(p[i][1])) - (w(p[j][1]) - w(p[i][1])) * (w(x) - w(p[i][0]));
      return static_cast<std::int32_t>(e);
    };
    Picture out{
        size, size, std::vector<std::uint32_t>(static_cast<std::size_t>(size * size), kernels::no_face), {}};
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const int px = x * 256 + 128, py = y * 256 + 128;
        const int a = edge(0, 1, px, py), b = edge(1, 2, px, py), c = edge(2, 0, px, py);
        if ((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0))
          out.id[static_cast<std::size_t>(y * size + x)] = 0;
      }
    return out;
  };
  std::vector<ClipTriangle> inputs;
  for (std::size_t n = t.samples(20, 1000); n-- > 0;) {
    ClipTriangle triangle;
    for (auto& p : triangle)
      p = {static_cast<float>(t.random.magnitude(0, 24)), static_cast<float>(t.random.magnitude(0, 24)), 0,
           1};
    inputs.push_back(triangle);
  }
  for (const auto& triangle : inputs) {
    const auto want = seen(triangle, 64, 64);
    const auto errors = [&](double band) {
      return static_cast<double>(wrong_pixels(drawn({&triangle, 1}, 64, 64, band), want));
    };
    t.measure(static_cast<double>(wrong_pixels(textbook(triangle, 64), want)),
              std::max(errors(1), errors(1e4)),
              {triangle[0].x, triangle[0].y, triangle[1].x, triangle[1].y, triangle[2].x, triangle[2].y});
  }
  t.price(
      [&] {
        for (const auto& x : inputs) keep(textbook(x, 64).id[0]);
      },
      [&] {
        for (const auto& x : inputs) keep(drawn({&x, 1}, 64, 64).id[0]);
      });
}

}  // namespace

std::vector<HardCase> culling() {
  return {
      {"CLP-09", "faces within an ulp of the sides, some with corners behind the eye",
       "outside the cube after the divide", "cull::faces_not_outside", "exact comparison",
       "nothing visible is culled, nothing outside is kept", "visible faces culled", 0, conservative_culling},
      {"CLP-10", "faces in planes through the eye, corners at 1e7, moved by an ulp",
       "sign of n.(eye - a), float", "cull::faces_showing", "rationals",
       "the sign is exact; edge-on is neither side", "wrong sides", 0, edge_on_faces},
      {"CLP-14", "corners up to 2^24 half-widths off the screen", "edge functions in 32-bit integers",
       "clip with guard bands 1 and 10000, viewport and fill kernels", "rays through pixels, 113 bits",
       "the pixels of the rays, but for those on an edge", "wrong pixels", 0, beyond_the_guard_band},
  };
}

}  // namespace frustum::hard
