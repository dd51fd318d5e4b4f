// Why a face is not seen: it lies outside the view volume, it faces away, or others hide it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "nodes/kernels/box_triangles.h"
#include "nodes/kernels/clip.h"
#include "nodes/kernels/predicates.h"

namespace frustum::classify {

enum class Reason : std::uint32_t {
  visible,          // at one sample or more
  outside,          // nothing of it is inside the view volume
  back_facing,      // it faces away, or is seen edge-on
  hidden,           // it covers samples, and something nearer covers every one of them
  between_samples,  // it is too small or too thin to cover a sample
  undefined         // a corner is not finite
};
inline constexpr std::size_t reasons = 6;

// What the picture knows of a source face.
struct Found {
  std::uint64_t seen = 0;  // samples
  bool covers = false;     // a sample or more, seen or not
};

// Whether a triangle in clip space has area inside the view volume. A corner or an edge that touches it from
// outside has none.
template <std::floating_point R>
bool inside_volume(const glm::vec<4, R>& a, const glm::vec<4, R>& b, const glm::vec<4, R>& c,
                   kernels::ClipSpace space) {
  const auto code = [&](const glm::vec<4, R>& p) -> unsigned {
    return kernels::volume_outcode(space, R(1), p);
  };
  if ((code(a) & code(b) & code(c)) != 0) return false;
  const auto cutting = static_cast<std::uint8_t>(code(a) | code(b) | code(c));
  return kernels::clip_triangle(kernels::view_volume(space), cutting, a, b, c).size > 0;
}

// The reason of one face. What is seen is visible whatever it faces; of several reasons the first in their order.
template <std::floating_point R>
Reason reason(const glm::vec<4, R>& a, const glm::vec<4, R>& b, const glm::vec<4, R>& c,
              kernels::ClipSpace space, const Found& found) {
  const auto finite = [](const glm::vec<4, R>& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.w);
  };
  if (!finite(a) || !finite(b) || !finite(c)) return Reason::undefined;
  if (found.seen > 0) return Reason::visible;
  if (!inside_volume(a, b, c, space)) return Reason::outside;
  const auto row = [&](const glm::vec<4, R>& p) {
    return glm::vec<3, R>(p.x, space.y_down ? -p.y : p.y, p.w);
  };
  // The signed volume of the eye and the three corners: exact, and right for corners behind the eye.
  if (kernels::determinant_sign(row(a), row(b), row(c)) <= 0) return Reason::back_facing;
  return found.covers ? Reason::hidden : Reason::between_samples;
}

// Whether the face covers a sample of the window. Cost: O(pixels of its box) where it covers none.
template <std::floating_point R>
bool covers_a_sample(const kernels::ScreenMesh<R>& mesh, std::uint32_t face,
                     const kernels::SamplePositions& pattern, const kernels::PixelRect& window) {
  kernels::BoxCounts counts;
  kernels::BoxedTriangle box{};
  kernels::box_triangle(mesh, face, kernels::sample_box(pattern), window, &box, counts);
  if (counts.boxed == 0) return false;
  const auto t = kernels::screen_triangle(mesh, face, R(1));
  for (int s = 0; s < pattern.samples; ++s)
    for (int y = window.y0 + box.y0; y <= window.y0 + box.y1; ++y)
      for (int x = window.x0 + box.x0; x <= window.x0 + box.x1; ++x) {
        const std::size_t i = pattern.index(s, x, y);
        if (std::all_of(t->edge.begin(), t->edge.end(), [&](const kernels::Edge& e) {
              return kernels::Edge::covers(e.at_pixel(x, y), e.at_offset(pattern.x[i], pattern.y[i]));
            }))
          return true;
      }
  return false;
}

}  // namespace frustum::classify
