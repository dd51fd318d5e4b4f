// What stands between a point and a light: triangles in a tree of boxes, each decided without gaps.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace frustum::kernels {

// From `from` along `way`: to `from + way` for a light that has a place, without end for one that has none.
struct Sight {
  glm::dvec3 from, way;
  bool ends = true;
};

// A tree of boxes over triangles. Its shape steers only the time it takes: whether something stands in the
// way is true or false whatever the order in which triangles are asked.
//
// A triangle hides the point from the light where the way crosses it, sides and corners included, and the point and
// the light lie strictly on different sides of its plane, the point by more than `slack`. Two triangles that share a side
// leave no gap there: the way is sheared onto an axis, which gives a shared corner the same bits in both,
// and fl(a b) - fl(c d) has the sign of a b - c d or is 0, which counts as inside.
// Source: Woop, Benthin & Wald 2013, Watertight ray/triangle intersection, JCGT 2(1). Departures: decided in
// binary64 with one rounding a product (contraction would break the argument), and by sides of the plane
// instead of a distance along the way, so that what starts on a triangle needs no offset along the way.
class Occluders {
 public:
  Occluders() = default;
  // Triangles with a corner that is not finite are left out. Cost: n log n; about 100 bytes a triangle.
  Occluders(std::span<const glm::dvec3> position, std::span<const glm::uvec3> triangle,
            const std::function<void()>& poll = {});

  // Whether a triangle hides sight.from from the light. A point or a way that is not finite is not hidden.
  //   slack  >= 0: how far off its own surface the point may be; what it is nearer to than that, it lies on
  //   last   the triangle that was in the way last, asked first: neighbouring points tend to be in one shadow.
  //          Any number to begin with; it changes the time and never the answer.
  bool hide(const Sight& sight, double slack, std::uint32_t& last) const;

  std::size_t triangles() const { return triangles_.size(); }
  // Bytes that are taken for n triangles.
  static std::uint64_t bytes(std::uint64_t n) { return n * (sizeof(Triangle) + 2 * sizeof(Node) + 48); }

 private:
  struct Triangle {
    glm::dvec3 a, b, c, normal;  // unit, or 0 for a triangle without area, which hides nothing
  };
  struct Node {
    glm::vec3 low, high;      // rounded outwards
    std::uint32_t first = 0;  // of its triangles; inner: index of the right child, the left one follows
    std::uint32_t count = 0;  // 0: inner
  };
  struct Builder;
  struct Shear;
  static bool crosses(const Triangle& t, const Sight& sight, const Shear& shear, double slack);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace frustum::kernels
