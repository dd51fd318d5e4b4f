#include "runtime/io/normals.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>

namespace frustum {

template <class R>
std::uint64_t finish_vertex_normals(Column& normals, std::span<const glm::uvec3> triangles,
                                    std::span<const glm::vec<3, R>> positions, const Context& ctx) {
  using Vec3 = glm::vec<3, R>;
  const auto out = normals.values<Vec3>();
  const auto for_each = [&](auto&& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, out.size(), 1 << 14), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
    });
    ctx.poll();
  };
  std::atomic<std::uint64_t> missing{0};
  for_each([&](std::size_t i) {
    const auto n = unit(glm::dvec3(out[i]));
    if (!n) missing.fetch_add(1, std::memory_order_relaxed);
    out[i] = n ? Vec3(*n) : Vec3(0);
  });
  if (missing == 0) return 0;
  std::vector<glm::dvec3> sums(out.size(), glm::dvec3(0));
  add_area_normals<Vec3>(
      triangles.size(),
      [&](std::size_t t, int k) { return std::size_t{triangles[t][static_cast<glm::length_t>(k)]}; },
      positions, sums, ctx);
  for_each([&](std::size_t i) {
    if (out[i] == Vec3(0)) out[i] = Vec3(unit(sums[i]).value_or(glm::dvec3(0, 0, 1)));
  });
  return missing;
}
template std::uint64_t finish_vertex_normals(Column&, std::span<const glm::uvec3>, std::span<const glm::vec3>,
                                             const Context&);
template std::uint64_t finish_vertex_normals(Column&, std::span<const glm::uvec3>,
                                             std::span<const glm::dvec3>, const Context&);

}  // namespace frustum
