// Triangles in a tree of boxes: what stands between a point and a light, and what a ray meets first.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

namespace frustum::kernels {

// From `from` along `way`: to `from + way` for a light that has a place, without end for one that has none.
struct Sight {
  glm::dvec3 from, way;
  bool ends = true;
};

// All points from + t along, t > 0. `along` need not be of unit length.
struct Ray {
  glm::dvec3 from, along;
  double slack = 0;  // >= 0: how far `from` may be off the surface it starts on
};

struct RayHit {
  std::uint32_t face = 0xFFFFFFFF;                     // of the triangles given; this one where none is met
  double t = std::numeric_limits<double>::infinity();  // at from + t along
  double u = 0, v = 0;  // the weights there of the face's second and third corner
};

// A tree of boxes over triangles. Its shape steers only the time it takes: what is hidden or met is the same whatever
// the order in which triangles are asked.
//
// Two triangles that share a side leave no gap there: a way is sheared onto an axis, which gives a shared corner the
// same bits in both, and fl(a b) - fl(c d) has the sign of a b - c d or is 0, which counts as inside. Sides and corners
// belong to a triangle. One without area, or seen exactly edge-on, is not there (hard case RAY-11).
// Source: Woop, Benthin & Wald 2013, Watertight ray/triangle intersection, JCGT 2(1). Departures: decided in
// binary64 with one rounding a product (contraction would break the argument).
class TriangleTree {
 public:
  TriangleTree() = default;
  // Triangles with a corner that is not finite are left out. Cost: n log n; about 110 bytes a triangle.
  TriangleTree(std::span<const glm::dvec3> position, std::span<const glm::uvec3> triangle,
               const std::function<void()>& poll = {});

  // Whether a triangle hides sight.from from the light: the way crosses it, and the point and the light lie strictly on
  // different sides of its plane, the point by more than `slack`. So what starts on a triangle needs no offset along the
  // way. A point or a way that is not finite is not hidden.
  //   slack  >= 0: how far off its own surface the point may be; what it is nearer to than that, it lies on
  //   last   the triangle that was in the way last, asked first: neighbouring points tend to be in one shadow.
  //          Any number to begin with; it changes the time and never the answer.
  bool hide(const Sight& sight, double slack, std::uint32_t& last) const;

  // The triangle that the ray meets first: the least of (t, face). One whose plane lies within `slack` of the start is
  // not met, nor any by a ray that is not finite or goes nowhere.
  //   t is a mean of the corners' distances along the greatest component of `along`, with non-negative weights: off by a
  //   few u of the farthest corner's, however the ray grazes the triangle; and held within the ray's way through the
  //   triangle's own box, so that no box that is passed over could have held a lesser one.
  // Cost: log n boxes where triangles lie apart.
  RayHit nearest(const Ray& ray) const;

  std::size_t triangles() const { return triangles_.size(); }
  // Bytes that are taken for n triangles.
  static std::uint64_t bytes(std::uint64_t n) { return n * (sizeof(Triangle) + 2 * sizeof(Node) + 48); }

 private:
  struct Triangle {
    glm::dvec3 a, b, c, normal;  // unit, or 0 for a triangle without area, which is not there
    std::uint32_t face;
  };
  struct Node {
    glm::vec3 low, high;      // rounded outwards
    std::uint32_t first = 0;  // of its triangles; inner: index of the right child, the left one follows
    std::uint32_t count = 0;  // 0: inner
  };
  struct Builder;
  struct Shear;
  struct Slabs;
  static bool crosses(const Triangle& t, const Sight& sight, const Shear& shear, double slack);
  static void meet(const Triangle& t, const Ray& ray, const Shear& shear, const Slabs& slabs,
                   RayHit& nearest);
  template <class Visit>
  void walk(const Slabs& slabs, const double& end, const Visit& visit) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace frustum::kernels
