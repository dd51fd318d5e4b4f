// Rays: what they meet whatever their length, the order of triangles and the side they graze; and how glass bends them.
#include "nodes/kernels/camera.h"
#include "nodes/kernels/triangle_tree.h"
#include "nodes/trace/camera.h"
#include "nodes/trace/refract.h"
#include "tests/hard/exact.h"
#include "tests/hard/naive.h"
#include "tests/hard/stages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

namespace frustum::hard {
namespace {

using glm::dvec3, glm::vec3;
using kernels::Ray, kernels::RayHit, kernels::TriangleTree;

constexpr std::uint32_t nothing = RayHit{}.face;

dvec3 place(Trial& t, double size = 1) {
  return {t.random.uniform(-size, size), t.random.uniform(-size, size), t.random.uniform(-size, size)};
}

// Moller & Trumbore 1997 in float, with the textbook's guard against small determinants.
std::optional<float> textbook_t(const std::array<vec3, 3>& p, const vec3& from, const vec3& way) {
  const auto cross = [](const vec3& a, const vec3& b) {
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  };
  const vec3 e1 = p[1] - p[0], e2 = p[2] - p[0], pv = cross(way, e2);
  const float det = naive::dot(e1, pv);
  if (std::fabs(det) < 1e-8F) return std::nullopt;
  const vec3 tv = from - p[0], qv = cross(tv, e1);
  const float u = naive::dot(tv, pv) / det, v = naive::dot(way, qv) / det, at = naive::dot(e2, qv) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && at > 0 ? std::optional(at) : std::nullopt;
}

struct Triangles {
  std::vector<dvec3> position;
  std::vector<glm::uvec3> face;
  void add(const dvec3& a, const dvec3& b, const dvec3& c) {
    const auto first = static_cast<std::uint32_t>(position.size());
    position.insert(position.end(), {a, b, c});
    face.emplace_back(first, first + 1, first + 2);
  }
  TriangleTree tree() const { return {position, face}; }
};

void lengths_of_ways(Trial& t) {
  for (std::size_t i = 0; i < t.samples(200, 5000); ++i) {
    Triangles one;
    one.add(place(t), place(t), place(t));
    const std::array<vec3, 3> p{vec3(one.position[0]), vec3(one.position[1]), vec3(one.position[2])};
    const dvec3 from = place(t, 4), way = (one.position[0] + one.position[1] + one.position[2]) / 3.0 - from;
    const TriangleTree tree = one.tree();
    const RayHit hit = tree.nearest({from, way});
    for (const int k : {-149, -66, 0, 66, 120}) {
      const RayHit scaled = tree.nearest({from, way * std::ldexp(1.0, k)});
      const auto textbook = textbook_t(p, vec3(from), vec3(way * std::ldexp(1.0, k)));
      t.tally(hit.face == 0 && !textbook, scaled.face != hit.face || scaled.t != std::ldexp(hit.t, -k),
              {double(k)});
    }
    t.require(tree.nearest({from, dvec3(0)}).face == nothing, "a way of no length meets nothing");
  }
}

// u and its neighbour's: the same two corners, the other way round.
void shared_edges(Trial& t) {
  for (std::size_t i = 0; i < t.samples(20000, 1000000); ++i) {
    const double bx = t.random.uniform(-1, 1), by = t.random.uniform(-1, 1);
    const double cx = bx * (1 + t.random.uniform(-1e-15, 1e-15)),
                 cy = by * (1 + t.random.uniform(-1e-15, 1e-15));
    const double contracted = std::fma(cx, by, -(cy * bx)), turned = std::fma(bx, cy, -(by * cx));
    volatile double cxby = cx * by, cybx = cy * bx, bxcy = bx * cy, bycx = by * cx;
    t.tally(contracted != -turned, cxby - cybx != -(bxcy - bycx), {bx, by, cx, cy});
  }
  // The kernel that is built: a ray along the edge that two triangles share meets one of them.
  for (std::size_t i = 0; i < t.samples(2000, 50000); ++i) {
    const dvec3 a = place(t), b = place(t), from = place(t, 5);
    Triangles two;
    two.add(a, b, a + place(t));
    two.position.push_back(a * 2.0 - two.position[2] + (b - a) * 0.5);
    two.face.emplace_back(1, 0, 3);
    const double s = t.random.uniform(0.01, 0.99);
    const RayHit hit = two.tree().nearest({from, (a + (b - a) * s - from) * t.random.uniform(0.1, 10)});
    t.require(hit.face != nothing, "two faces leave no gap", {s});
  }
}

void in_the_plane(Trial& t) {
  // A closed box, seen along its sides and edges.
  const std::array<dvec3, 8> c{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
  const std::array<std::array<std::size_t, 4>, 6> sides{
      {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
  Triangles box;
  for (const auto& s : sides) box.add(c[s[0]], c[s[1]], c[s[2]]), box.add(c[s[0]], c[s[2]], c[s[3]]);
  const TriangleTree tree = box.tree();
  for (const double along : {0.0, -0.0})
    for (const double y : {0.0, 0.25, 0.5, 1.0})
      for (const double x : {0.0, 1.0}) {
        const dvec3 from(x, y, -3), way(along, along, 1);
        const RayHit hit = tree.nearest({from, way});
        // Slabs with 1 / 0: 0 times infinity is no number, and every comparison with it is false.
        double near = 0, far = 10;
        for (glm::length_t k = 0; k < 3; ++k) {
          const double s = (0 - from[k]) * (1 / way[k]), e = (1 - from[k]) * (1 / way[k]);
          near = std::max(std::min(s, e), near), far = std::min(std::max(s, e), far);
        }
        const bool textbook = near <= far && near == near && far == far && near == 3;
        t.tally(!textbook, hit.face == nothing || hit.t != 3, {x, y, along});
      }
}

void flat_boxes(Trial& t) {
  // Four squares around a corner in a plane through it: aimed at the corner, one is met.
  for (std::size_t i = 0; i < t.samples(20000, 1000000); ++i) {
    const dvec3 middle = place(t), from = place(t, 4);
    Triangles flat;
    for (const double sx : {-1.0, 1.0})
      for (const double sz : {-1.0, 1.0}) {
        const dvec3 x = middle + dvec3(sx, 0, 0), z = middle + dvec3(0, 0, sz),
                    xz = middle + dvec3(sx, 0, sz);
        flat.add(middle, x, xz), flat.add(middle, xz, z);
      }
    const dvec3 way = middle - from;
    // The box of one square, without room for rounding.
    double near = 0, far = std::numeric_limits<double>::infinity();
    for (glm::length_t k = 0; k < 3; ++k) {
      const double inverse = 1 / way[k], s = (middle[k] - from[k]) * inverse,
                   e = (middle[k] + (k == 1 ? 0.0 : 1.0) - from[k]) * inverse;
      near = std::max(near, std::min(s, e)), far = std::min(far, std::max(s, e));
    }
    t.tally(!(near <= far), flat.tree().nearest({from, way}).face == nothing, {way.x, way.y, way.z});
  }
}

void near_the_critical_angle(Trial& t) {
  for (std::size_t i = 0; i < t.samples(20000, 1000000); ++i) {
    const auto eta = static_cast<float>(t.random.uniform(1.05, 2.05));
    float c = std::sqrt(1 - 1 / (eta * eta));
    for (std::size_t k = t.random.below(5); k > 0; --k) c = std::nextafter(c, i % 2 == 0 ? 0.0F : 1.0F);
    const vec3 d(std::sqrt(1 - c * c), -c, 0);
    // eta |x| against |d|, exactly: squares of floats in rationals.
    const Rational x(double(d.x)), y(double(d.y)), e{double(eta)}, beyond = e * e * x * x - (x * x + y * y);
    if (abs(beyond) < Rational(64 * u64)) continue;  // double cannot tell either
    const bool total = beyond > 0;
    const bool textbook = 1 - eta * eta * (1 - c * c) < 0;
    const trace::Refraction r = trace::refracted(kernels::normalized(dvec3(d)).value(), {0, 1, 0}, eta);
    t.tally(textbook != total, r.total != total, {eta, c});
    t.require(r.reflectance >= 0 && r.reflectance <= 1, "the share is between 0 and 1", {eta, c});
  }
}

void total_reflection(Trial& t) {
  for (const double eta : {1.0001, 1.2, 1.5, 2.4, 1e3})
    for (const double s : {1.0, 0.9999999, 0.99, 0.9}) {
      if (eta * s < 1) continue;
      const dvec3 d(s, -std::sqrt(1 - s * s), 0);
      const double root = std::sqrt(1 - eta * eta * s * s);  // NaN, which the textbook goes on with
      const trace::Refraction r = trace::refracted(d, {0, 1, 0}, eta);
      t.tally(root != root, !r.total || r.reflectance != 1 || r.along != dvec3(0), {eta, s});
    }
}

void matched_media(Trial& t) {
  for (const double angle : {0.0, 0.2, 0.9, 1.3, 1.55}) {
    const dvec3 d(std::sin(angle), -std::cos(angle), 0), n(0, 1, 0);
    const trace::Refraction same = trace::refracted(d, n, 1);
    // In float: the cosine from 1 - eta^2 (1 - c^2), scaled by the tangent's length.
    const float c = static_cast<float>(-d.y), k = std::sqrt(std::max(0.0F, 1 - (1 - c * c)));
    const double bent = std::fabs(static_cast<double>(k) + d.y);
    t.measure(bent / u64, kernels::norm(same.along - d) / u64 * std::cos(angle), {angle});
    for (const double off : {1e-7, -1e-7, 1e-4, -1e-4}) {
      const trace::Refraction r = trace::refracted(d, n, 1 + off);
      const double grazing = std::min(r.cos_in, r.cos_out);
      t.require(r.total || kernels::norm(r.along - d) <= 1.1 * std::fabs(off) / grazing + 1e-14,
                "it bends no more than the indices differ", {angle, off});
    }
  }
}

void far_cameras(Trial& t) {
  const kernels::Projection projection = kernels::perspective(0.7, 1, 0.1, 100);
  const kernels::Viewport viewport({1000, 1000});
  for (const double far : {1e3, 1e5, 1e7, 1e9})
    for (const double x : {500.5, 700.5, 999.5}) {
      const dvec3 eye(far, -far, far), target = eye + dvec3(0, 0, -1);
      const dvec3 there = trace::CameraRays(kernels::look_at(eye, target, {0, 1, 0}), projection, viewport)
                              .at({x, 400.5})
                              .along,
                  here = trace::CameraRays(kernels::look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}), projection,
                                           viewport)
                             .at({x, 400.5})
                             .along;
      const vec3 subtracted = vec3(eye + here) - vec3(eye);
      t.measure(kernels::norm(dvec3(subtracted) - here) / u64, kernels::norm(there - here) / u64, {far, x});
    }
}

void rays_that_are_none(Trial& t) {
  Triangles one;
  one.add({-1, -1, 0}, {1, -1, 0}, {0, 2, 0});
  const TriangleTree tree = one.tree();
  const std::array<vec3, 3> p{vec3(one.position[0]), vec3(one.position[1]), vec3(one.position[2])};
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf})
    for (glm::length_t k = 0; k < 6; ++k) {
      Ray ray{{0, 0, 3}, {0, 0, -1}};
      (k < 3 ? ray.from[k] : ray.along[k - 3]) = bad;
      // Written the other way round, as "no hit where u < 0 ...": every comparison with NaN lets it pass.
      const vec3 way(ray.along), from(ray.from), e1 = p[1] - p[0], tv = from - p[0];
      const float u = naive::dot(tv, way) / naive::dot(e1, way);
      t.tally(!(u < 0) && !(u > 1), tree.nearest(ray).face != nothing, {bad, double(k)});
    }
}

void any_order(Trial& t) {
  Triangles first;
  for (int i = 0; i < 60; ++i) {
    const dvec3 a = place(t), b = place(t), c = place(t);
    first.add(a, b, c), first.add(a, b, c);
  }
  std::vector<std::uint32_t> name(first.face.size());
  std::iota(name.begin(), name.end(), 0U);
  const TriangleTree tree = first.tree();
  for (int order = 0; order < 5; ++order) {
    for (std::size_t i = name.size(); i > 1; --i) std::swap(name[i - 1], name[t.random.below(i)]);
    // The two of a pair keep their order, so that the lower of them is the same one.
    for (std::size_t i = 0; i < name.size(); ++i)
      for (std::size_t j = i + 1; j < name.size(); ++j)
        if (name[i] / 2 == name[j] / 2 && name[i] > name[j]) std::swap(name[i], name[j]);
    Triangles other{first.position, {}};
    for (const std::uint32_t n : name) other.face.push_back(first.face[n]);
    const TriangleTree turned = other.tree();
    for (std::size_t i = 0; i < t.samples(300, 20000); ++i) {
      const dvec3 from = place(t, 3), way = place(t) - from;
      const RayHit hit = tree.nearest({from, way}), again = turned.nearest({from, way});
      // The last of the nearest in the order they come, as a loop with <= has it.
      std::uint32_t last = nothing;
      float least = std::numeric_limits<float>::infinity();
      for (const std::uint32_t n : name) {
        const auto& f = first.face[n];
        const auto at =
            textbook_t({vec3(first.position[f.x]), vec3(first.position[f.y]), vec3(first.position[f.z])},
                       vec3(from), vec3(way));
        if (at && *at <= least) least = *at, last = n;
      }
      const std::uint32_t face = again.face == nothing ? nothing : name[again.face];
      t.tally(last != hit.face, face != hit.face || again.t != hit.t, {way.x, way.y, way.z});
    }
  }
}

}  // namespace

std::vector<HardCase> rays() {
  return {
      {"RAY-05", "ways of 2^-149 to 2^120 times their length",
       "Moller and Trumbore in float, |det| < 1e-8 missed", "TriangleTree::nearest",
       "the way of usual length", "t scales by 2^-k, bit for bit", "wrong hits", 0, lengths_of_ways},
      {"RAY-09", "edges 1e-15 from the origin, from both sides", "fma(Cx, By, -(Cy Bx))",
       "two products, as in TriangleTree", "the neighbour's edge", "U(A, B) = -U(B, A)",
       "pairs that disagree", 0, shared_edges},
      {"RAY-12", "a box seen along its sides, +0 and -0 across", "slabs with 1 / 0", "TriangleTree::nearest",
       "truth table: the side belongs to the box", "on the boundary is a hit, at t = 3", "wrong hits", 0,
       in_the_plane},
      {"RAY-13", "squares without thickness, aimed at the corner that four share",
       "slabs without room for rounding", "TriangleTree::nearest",
       "truth table: the squares cover the corner", "one is met", "misses", 0, flat_boxes},
      {"RAY-17", "indices 1.05 to 2.05, directions in float within 4 ulp of the critical angle",
       "1 - eta^2 (1 - c^2) in float", "trace::refracted", "rationals", "the side is decided right",
       "wrong sides", 0, near_the_critical_angle},
      {"RAY-18", "eta s at and beyond 1", "sqrt(1 - eta^2 s^2)", "trace::refracted", "truth table",
       "all is mirrored, and nothing is NaN", "wrong results", 0, total_reflection},
      {"RAY-20", "eta = 1, 1 +- 1e-7, 1 +- 1e-4", "the cosine from 1 - (1 - c^2) in float",
       "trace::refracted", "the direction itself", "|d' - d| cos <= 4 u at eta = 1", "u", 4, matched_media},
      {"RAY-24", "eyes 1e3 to 1e9 from the origin", "P(r, c) - eye in float", "trace::CameraRays",
       "the camera at the origin", "the same direction", "u", 4, far_cameras},
      {"RAY-25", "NaN and infinity in each component", "no hit where u < 0 or u > 1", "TriangleTree::nearest",
       "truth table", "no hit", "hits", 0, rays_that_are_none},
      {"RAY-26", "120 triangles, each there twice, in five orders", "the last of the nearest, in float",
       "TriangleTree::nearest", "the first order", "the same face and t", "other hits", 0, any_order},
  };
}

}  // namespace frustum::hard
