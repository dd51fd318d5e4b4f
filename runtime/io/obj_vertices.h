// The vertices that an OBJ file's corners make: one for each distinct (v, vt, vn).
#pragma once

#include "runtime/io/obj_parse.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace frustum::obj {

// What is at one v: its vt and vn, and the next vertex there.
struct Variant {
  std::int32_t vt = absent, vn = absent;
  std::uint32_t next = 0;  // from 1, among those that are not the first of their v; 0 ends the list
};

// Vertices are numbered by v, then by first use. Corners are added, in order; finish() ends that.
class VertexSet {
 public:
  explicit VertexSet(std::size_t positions) : first_(positions), first_vertex_(positions + 1) {}

  // The number of the corner's (vt, vn) among those at its v. Some 4 ns; log n beyond the first few at a v.
  std::int32_t add(const Corner& corner);
  void finish();

  std::size_t size() const { return first_vertex_.back(); }
  std::uint32_t vertex(std::int32_t v, std::int32_t number) const {
    return first_vertex_[static_cast<std::size_t>(v)] + static_cast<std::uint32_t>(number);
  }

  // Calls body(vertex, v, variant) for every vertex, in parallel over v.
  template <class Body>
  void for_each(Body&& body) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, first_.size(), 1 << 14), [&](const auto& range) {
      for (std::size_t v = range.begin(); v < range.end(); ++v) {
        const Variant* at = &first_[v];
        for (std::uint32_t i = first_vertex_[v]; i < first_vertex_[v + 1]; ++i) {
          body(static_cast<std::size_t>(i), v, *at);
          if (at->next != 0) at = &extra_[at->next - 1];
        }
      }
    });
  }

 private:
  std::int32_t add_to_many(const Corner& corner, std::uint32_t last);
  void append(const Corner& corner, Variant& after);

  std::vector<Variant> first_, extra_;
  std::vector<std::uint32_t> first_vertex_;  // until finish(): how many there are at each v
  // Where a v has many: the numbers of the later ones by (v, vt, vn), and the last of each v, in extra_.
  std::map<std::array<std::int32_t, 3>, std::int32_t> many_;
  std::map<std::int32_t, std::uint32_t> last_;
};

}  // namespace frustum::obj
