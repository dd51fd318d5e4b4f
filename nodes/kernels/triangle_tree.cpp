#include "nodes/kernels/triangle_tree.h"

#include "nodes/kernels/surface_measures.h"
#include "nodes/kernels/vector.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <limits>

namespace frustum::kernels {
namespace {

// Rounded towards -infinity and +infinity.
float below(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float above(double x) { return -below(-x); }

double surface(const Box& b) {
  if (b.empty()) return 0;
  const glm::dvec3 d = b.high - b.low;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

constexpr std::size_t leaf_size = 4, bins = 16;
// Below this many a thread of its own costs more than it saves.
constexpr std::size_t parallel_size = 4096;

}  // namespace

// Binned surface area heuristic. Source: Wald 2007, On fast construction of SAH-based bounding volume
// hierarchies, doi:10.1109/RT.2007.4342588.
struct TriangleTree::Builder {
  struct Item {
    Box box;
    std::uint32_t triangle;
    double centre(glm::length_t axis) const { return box.low[axis] * 0.5 + box.high[axis] * 0.5; }
  };
  std::vector<Item> items;
  std::vector<Node>& nodes;
  const std::function<void()>& poll;

  // A cell of n items takes at most 2 n - 1 nodes, so that both halves know their place beforehand.
  void build(std::size_t node, std::size_t begin, std::size_t end) {
    Box box, centres;
    for (std::size_t i = begin; i < end; ++i) {
      box.add(items[i].box);
      centres.add(glm::dvec3(items[i].centre(0), items[i].centre(1), items[i].centre(2)));
    }
    Node& n = nodes[node];
    for (glm::length_t k = 0; k < 3; ++k) n.low[k] = below(box.low[k]), n.high[k] = above(box.high[k]);
    if (end - begin <= leaf_size) {
      n.first = static_cast<std::uint32_t>(begin), n.count = static_cast<std::uint32_t>(end - begin);
      return;
    }
    const std::size_t middle = divide(begin, end, centres);
    const std::size_t left = node + 1, right = node + 2 * (middle - begin);
    n.first = static_cast<std::uint32_t>(right), n.count = 0;
    if (end - begin < parallel_size) {
      build(left, begin, middle), build(right, middle, end);
      return;
    }
    if (poll) poll();
    tbb::parallel_invoke([&] { build(left, begin, middle); }, [&] { build(right, middle, end); });
  }

  // Where to part the items, which come into order; half and half where their middles coincide.
  std::size_t divide(std::size_t begin, std::size_t end, const Box& centres) {
    const glm::dvec3 size = centres.high - centres.low;
    const glm::length_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    if (!(size[axis] > 0)) return begin + (end - begin) / 2;
    const double scale = static_cast<double>(bins) / size[axis];
    const auto bin_of = [&](const Item& item) {
      return std::min(bins - 1, static_cast<std::size_t>((item.centre(axis) - centres.low[axis]) * scale));
    };
    std::array<Box, bins> box;
    std::array<std::size_t, bins> count{};
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t b = bin_of(items[i]);
      box[b].add(items[i].box), ++count[b];
    }
    const std::size_t cut = cheapest_cut(box, count);
    const auto at = [&](std::size_t i) { return items.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto part =
        std::partition(at(begin), at(end), [&](const Item& item) { return bin_of(item) < cut; });
    const auto middle = static_cast<std::size_t>(part - items.begin());
    return middle == begin || middle == end ? begin + (end - begin) / 2 : middle;
  }

  // The first bin of the right half.
  static std::size_t cheapest_cut(const std::array<Box, bins>& box,
                                  const std::array<std::size_t, bins>& count) {
    std::array<double, bins> right{};
    Box sum;
    std::size_t n = 0;
    for (std::size_t b = bins; b-- > 1;)
      sum.add(box[b]), n += count[b], right[b] = surface(sum) * static_cast<double>(n);
    double least = std::numeric_limits<double>::infinity();
    std::size_t cut = bins / 2;
    sum = {}, n = 0;
    for (std::size_t b = 1; b < bins; ++b) {
      sum.add(box[b - 1]), n += count[b - 1];
      const double cost = surface(sum) * static_cast<double>(n) + right[b];
      if (cost < least) least = cost, cut = b;
    }
    return cut;
  }
};

TriangleTree::TriangleTree(std::span<const glm::dvec3> position, std::span<const glm::uvec3> triangle,
                           const std::function<void()>& poll) {
  const Triangles<double> mesh{position, triangle};
  Builder builder{{}, nodes_, poll};
  builder.items.reserve(triangle.size());
  for (std::size_t f = 0; f < triangle.size(); ++f) {
    if (!mesh.finite(f)) continue;
    Box box;
    for (const glm::dvec3& p : mesh.corners(f)) box.add(p);
    builder.items.push_back({box, static_cast<std::uint32_t>(f)});
  }
  if (builder.items.empty()) return;
  nodes_.resize(2 * builder.items.size() - 1);
  builder.build(0, 0, builder.items.size());
  triangles_.reserve(builder.items.size());
  for (const auto& item : builder.items) {
    const auto [a, b, c] = mesh.corners(item.triangle);
    triangles_.push_back({a, b, c, normalized_or(cross(b - a, c - a), glm::dvec3(0)), item.triangle});
  }
}

// The way along one axis, so that the triangle is met where it covers the origin of the other two.
struct TriangleTree::Shear {
  explicit Shear(const glm::dvec3& way) {
    const glm::dvec3 size(std::fabs(way.x), std::fabs(way.y), std::fabs(way.z));
    z = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    x = (z + 1) % 3, y = (z + 2) % 3;
    by_x = way[x] / way[z], by_y = way[y] / way[z];
  }
  glm::dvec2 operator()(const glm::dvec3& v) const { return {v[x] - by_x * v[z], v[y] - by_y * v[z]}; }
  glm::length_t x, y, z;
  double by_x, by_y;
};

bool TriangleTree::crosses(const Triangle& t, const Sight& sight, const Shear& shear, double slack) {
  const glm::dvec3 a = t.a - sight.from;
  const double height = -dot(t.normal, a), change = dot(t.normal, sight.way);
  if (!(std::fabs(height) > slack)) return false;
  // Towards the plane, and to its other side where the way ends.
  if (height > 0 ? !(change < 0) : !(change > 0)) return false;
  if (sight.ends && !(std::fabs(change) > std::fabs(height))) return false;
  const glm::dvec2 p = shear(a), q = shear(t.b - sight.from), r = shear(t.c - sight.from);
  const double u = r.x * q.y - r.y * q.x, v = p.x * r.y - p.y * r.x, w = q.x * p.y - q.y * p.x;
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

// The way of a ray through boxes.
struct TriangleTree::Slabs {
  glm::dvec3 from, inverse, pad{0};

  // 1 / 0 times 0 would be NaN; 2^-1000 stands for 0, and 2^1000 times any length in the scene is far beyond it. A ray that
  // runs along a side of the box is in it: what it is off there, 0 or a rounding, counts for less than `pad`.
  Slabs(const glm::dvec3& start, const glm::dvec3& along) : from(start) {
    for (glm::length_t k = 0; k < 3; ++k) {
      const bool moves = std::fabs(along[k]) > 0x1p-1000;
      inverse[k] = 1 / (moves ? along[k] : 0x1p-1000);
      pad[k] = moves ? 0 : 0x1p960;
    }
  }

  struct Interval {
    double near, far;
  };
  // Where the ray is in the box, t >= 0. The near end grows with the box's near sides, roundings included: no box begins
  // before one that holds it.
  template <class Corner>
  Interval within(const Corner& low, const Corner& high) const {
    // Three roundings each of the ends: widened so that no box is missed.
    constexpr double wider = 1 + 8 * 0x1p-53;
    Interval in{0, std::numeric_limits<double>::max()};
    for (glm::length_t k = 0; k < 3; ++k) {
      const double s = (static_cast<double>(low[k]) - from[k]) * inverse[k],
                   t = (static_cast<double>(high[k]) - from[k]) * inverse[k];
      in.near = std::max(in.near, std::min(s, t) - pad[k]);
      in.far = std::min(in.far, std::max(s, t) * wider + pad[k]);
    }
    return in;
  }
};

// Calls visit(triangle) for those in boxes that are entered no later than `end`, which visit may lessen; nearer boxes
// first. A visit that returns true is the last.
template <class Visit>
void TriangleTree::walk(const Slabs& slabs, const double& end, const Visit& visit) const {
  struct Waiting {
    std::uint32_t node;
    double enter;
  };
  constexpr double never = std::numeric_limits<double>::infinity();
  const auto enter = [&](std::uint32_t n) {
    const auto in = slabs.within(nodes_[n].low, nodes_[n].high);
    return in.near <= in.far ? in.near : never;
  };
  // A tree by areas may be as deep as it has triangles, but each level of the stack holds one child.
  std::array<Waiting, 64> stack;
  std::vector<Waiting> overflow;
  std::size_t top = 0;
  Waiting at{0, enter(0)};
  while (true) {
    if (at.enter < never && at.enter <= end) {
      const Node& n = nodes_[at.node];
      if (n.count == 0) {
        Waiting near{at.node + 1, enter(at.node + 1)}, far{n.first, enter(n.first)};
        if (far.enter < near.enter) std::swap(near, far);
        if (far.enter <= end) {
          if (top < stack.size())
            stack[top++] = far;
          else
            overflow.push_back(far);
        }
        at = near;
        continue;
      }
      for (std::uint32_t i = n.first; i < n.first + n.count; ++i)
        if (visit(i)) return;
    }
    if (!overflow.empty()) {
      at = overflow.back(), overflow.pop_back();
    } else if (top > 0) {
      at = stack[--top];
    } else {
      return;
    }
  }
}

namespace {

bool leads_somewhere(const glm::dvec3& from, const glm::dvec3& along) {
  return std::isfinite(largest_component(from)) && largest_component(along) > 0 &&
         std::isfinite(largest_component(along));
}

}  // namespace

bool TriangleTree::hide(const Sight& sight, double slack, std::uint32_t& last) const {
  if (nodes_.empty() || !leads_somewhere(sight.from, sight.way)) return false;
  const Shear shear(sight.way);
  if (last < triangles_.size() && crosses(triangles_[last], sight, shear, slack)) return true;
  const double end = sight.ends ? 1 : std::numeric_limits<double>::max();
  bool hidden = false;
  walk(Slabs(sight.from, sight.way), end, [&](std::uint32_t i) {
    hidden = crosses(triangles_[i], sight, shear, slack);
    if (hidden) last = i;
    return hidden;
  });
  return hidden;
}

void TriangleTree::meet(const Triangle& t, const Ray& ray, const Shear& shear, const Slabs& slabs,
                        RayHit& nearest) {
  const glm::dvec3 a = t.a - ray.from, b = t.b - ray.from, c = t.c - ray.from;
  const glm::dvec2 p = shear(a), q = shear(b), r = shear(c);
  const double u = r.x * q.y - r.y * q.x, v = p.x * r.y - p.y * r.x, w = q.x * p.y - q.y * p.x;
  if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) return;
  if (!(std::fabs(dot(t.normal, a)) > ray.slack)) return;
  const double sum = (u + v) + w;
  if (sum == 0) return;
  const double of_a = u / sum, of_b = v / sum, of_c = w / sum;
  const double mean = ((of_a * a[shear.z] + of_b * b[shear.z]) + of_c * c[shear.z]) / ray.along[shear.z];
  if (!(mean > 0)) return;
  const glm::dvec3 low = glm::dvec3(std::min({t.a.x, t.b.x, t.c.x}), std::min({t.a.y, t.b.y, t.c.y}),
                                    std::min({t.a.z, t.b.z, t.c.z})),
                   high = glm::dvec3(std::max({t.a.x, t.b.x, t.c.x}), std::max({t.a.y, t.b.y, t.c.y}),
                                     std::max({t.a.z, t.b.z, t.c.z}));
  const double distance = std::max(mean, slabs.within(low, high).near);
  if (distance < nearest.t || (distance == nearest.t && t.face < nearest.face))
    nearest = {t.face, distance, of_b, of_c};
}

RayHit TriangleTree::nearest(const Ray& ray) const {
  RayHit found;
  if (nodes_.empty() || !leads_somewhere(ray.from, ray.along)) return found;
  const Shear shear(ray.along);
  const Slabs slabs(ray.from, ray.along);
  walk(slabs, found.t, [&](std::uint32_t i) {
    meet(triangles_[i], ray, shear, slabs, found);
    return false;
  });
  return found;
}

}  // namespace frustum::kernels
