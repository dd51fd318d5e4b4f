#include "runtime/io/weld.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <tuple>

namespace frustum {

template <class R>
std::vector<Ref<Column>> weld_exact(std::span<const glm::vec<3, R>> corners, const Context& ctx) {
  using Vec3 = glm::vec<3, R>;
  struct Corner {
    Vec3 p;
    std::uint32_t number;
  };
  std::vector<Corner> sorted(corners.size());
  tbb::parallel_for(std::size_t{0}, corners.size(), [&](std::size_t i) {
    sorted[i] = {corners[i] + Vec3(0), static_cast<std::uint32_t>(i)};  // -0 + 0 is 0
  });
  ctx.poll();
  tbb::parallel_sort(sorted.begin(), sorted.end(), [](const Corner& a, const Corner& b) {
    return std::tie(a.p.x, a.p.y, a.p.z, a.number) < std::tie(b.p.x, b.p.y, b.p.z, b.number);
  });
  ctx.poll();
  // The first corner at each position stands for all of them.
  std::vector<std::uint32_t> first(corners.size());
  std::size_t vertices = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool fresh = i == 0 || sorted[i].p != sorted[i - 1].p;
    first[sorted[i].number] = fresh ? sorted[i].number : first[sorted[i - 1].number];
    vertices += fresh;
  }
  sorted = {};
  auto position = Column::make<Vec3>("position", Domain::vertex, vertices, Space::object);
  auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, corners.size() / 3);
  const auto to = position->template values<Vec3>();
  const auto faces = triangle->template values<glm::uvec3>();
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (first[i] == i) {
      to[next] = corners[i] + Vec3(0);
      first[i] = next++;
    } else {
      first[i] = first[first[i]];  // already a vertex: it stands before this corner
    }
    faces[i / 3][static_cast<glm::length_t>(i % 3)] = first[i];
  }
  return {triangle, position};
}
template std::vector<Ref<Column>> weld_exact(std::span<const glm::vec3>, const Context&);
template std::vector<Ref<Column>> weld_exact(std::span<const glm::dvec3>, const Context&);

}  // namespace frustum
