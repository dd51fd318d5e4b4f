#include "nodes/kernels/occluders.h"

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
struct Occluders::Builder {
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

Occluders::Occluders(std::span<const glm::dvec3> position, std::span<const glm::uvec3> triangle,
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
    triangles_.push_back({a, b, c, normalized_or(cross(b - a, c - a), glm::dvec3(0))});
  }
}

// The way along one axis, so that the triangle is met where it covers the origin of the other two.
struct Occluders::Shear {
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

bool Occluders::crosses(const Triangle& t, const Sight& sight, const Shear& shear, double slack) {
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

bool Occluders::hide(const Sight& sight, double slack, std::uint32_t& last) const {
  if (nodes_.empty() || !std::isfinite(largest_component(sight.from)) ||
      !(largest_component(sight.way) > 0) || !std::isfinite(largest_component(sight.way)))
    return false;
  const Shear shear(sight.way);
  if (last < triangles_.size() && crosses(triangles_[last], sight, shear, slack)) return true;
  // 1 / 0 times 0 would be NaN; 2^-1000 stands for 0, and 2^1000 times any length in the scene is far beyond it.
  glm::dvec3 inverse;
  for (glm::length_t k = 0; k < 3; ++k)
    inverse[k] = 1 / (std::fabs(sight.way[k]) > 0x1p-1000 ? sight.way[k] : 0x1p-1000);
  // Three roundings each of the ends of a box's interval: widened so that none is missed.
  constexpr double wider = 1 + 8 * 0x1p-53;
  const double end = sight.ends ? 1 : std::numeric_limits<double>::infinity();
  const auto meets = [&](const Node& n) {
    double near = 0, far = end;
    for (glm::length_t k = 0; k < 3; ++k) {
      const double s = (static_cast<double>(n.low[k]) - sight.from[k]) * inverse[k],
                   t = (static_cast<double>(n.high[k]) - sight.from[k]) * inverse[k];
      near = std::max(near, std::min(s, t)), far = std::min(far, std::max(s, t) * wider);
    }
    return near <= far;
  };
  // A tree by areas may be as deep as it has triangles, but each level of the stack holds one right child.
  std::array<std::uint32_t, 64> stack;
  std::vector<std::uint32_t> overflow;
  std::size_t top = 0;
  std::uint32_t node = 0;
  while (true) {
    const Node& n = nodes_[node];
    if (meets(n)) {
      if (n.count == 0) {
        if (top < stack.size())
          stack[top++] = n.first;
        else
          overflow.push_back(n.first);
        ++node;
        continue;
      }
      for (std::uint32_t i = n.first; i < n.first + n.count; ++i)
        if (crosses(triangles_[i], sight, shear, slack)) {
          last = i;
          return true;
        }
    }
    if (!overflow.empty()) {
      node = overflow.back(), overflow.pop_back();
    } else if (top > 0) {
      node = stack[--top];
    } else {
      return false;
    }
  }
}

}  // namespace frustum::kernels
