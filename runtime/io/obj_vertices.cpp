#include "runtime/io/obj_vertices.h"

#include <utility>

namespace frustum::obj {
namespace {

// As many are looked through one by one; a file of fans around one v would make that quadratic.
constexpr std::int32_t few = 16;

}  // namespace

void VertexSet::append(const Corner& corner, Variant& after) {
  after.next = static_cast<std::uint32_t>(extra_.size() + 1);
  extra_.push_back({corner.vt, corner.vn});  // `after` may be gone from here on
}

std::int32_t VertexSet::add(const Corner& corner) {
  const auto v = static_cast<std::size_t>(corner.v);
  std::uint32_t& count = first_vertex_[v];
  if (count == 0) {
    count = 1;
    first_[v] = {corner.vt, corner.vn};
    return 0;
  }
  Variant* at = &first_[v];
  std::uint32_t last = 0;
  for (std::int32_t number = 0;; ++number) {
    if (at->vt == corner.vt && at->vn == corner.vn) return number;
    if (number + 1 == few) return add_to_many(corner, last);
    if (at->next == 0) break;
    last = at->next;
    at = &extra_[last - 1];
  }
  append(corner, *at);
  return static_cast<std::int32_t>(count++);
}

std::int32_t VertexSet::add_to_many(const Corner& corner, std::uint32_t last) {
  std::uint32_t& count = first_vertex_[static_cast<std::size_t>(corner.v)];
  const auto [at, fresh] =
      many_.try_emplace({corner.v, corner.vt, corner.vn}, static_cast<std::int32_t>(count));
  if (!fresh) return at->second;
  std::uint32_t& tail = last_.try_emplace(corner.v, last).first->second;
  append(corner, extra_[tail - 1]);
  tail = static_cast<std::uint32_t>(extra_.size());
  return static_cast<std::int32_t>(count++);
}

void VertexSet::finish() {
  std::uint32_t vertices = 0;
  for (std::uint32_t& n : first_vertex_) vertices += std::exchange(n, vertices);
}

}  // namespace frustum::obj
