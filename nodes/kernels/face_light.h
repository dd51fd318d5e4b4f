// Light that is found once per face, vertex or corner, and how it reaches the samples of a row.
#pragma once

#include "nodes/kernels/lighting.h"
#include "nodes/kernels/sample_positions.h"
#include "nodes/kernels/shading_scene.h"
#include "nodes/kernels/vector.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>

namespace frustum::kernels {

template <std::floating_point R>
Triple<R> triple(const glm::vec<3, R>& v) {
  return {v.x, v.y, v.z};
}

/// The normal of a triangle that is counter-clockwise seen from where it points; zero for a triangle without
/// area.
template <std::floating_point R>
glm::vec<3, R> face_normal(const glm::vec<3, R>& a, const glm::vec<3, R>& b, const glm::vec<3, R>& c) {
  return normalized_or(cross(b - a, c - a), glm::vec<3, R>(0));
}

/// -1 where `eye` lies behind the triangle's plane, +1 in front of it and on it.
template <std::floating_point R>
R seen_side(const glm::vec<3, R>& a, const glm::vec<3, R>& b, const glm::vec<3, R>& c, const Triple<R>& eye) {
  const glm::vec<3, R> to_eye = glm::vec<3, R>(eye[0], eye[1], eye[2]) - a;
  return dot(cross(b - a, c - a), to_eye) < R(0) ? R(-1) : R(1);
}

/// Flat shading: one value for the whole face, at its centroid with its own normal.
template <std::floating_point R>
Received<R> light_face(const ShadingScene<R>& s, std::size_t face, const glm::vec<3, R>& a,
                       const glm::vec<3, R>& b, const glm::vec<3, R>& c) {
  const glm::vec<3, R> normal = face_normal(a, b, c) * s.side_of(face), centre = (a + b + c) / R(3);
  return receive(s.setup(s.surface(face)), triple(normal), triple(centre));
}

/// Shares of a triangle's corners at points of the screen, correct in perspective: a_k = b_k / w_k / sum(b_j
/// / w_j) with b linear on the screen (errata E21). Never negative, sum 1 within rounding; a triangle without
/// area gives its first corner.
template <std::floating_point R>
class CornerShares {
 public:
  /// Corners as (x_px, y_px, z, 1/w).
  CornerShares(const glm::vec<4, R>& a, const glm::vec<4, R>& b, const glm::vec<4, R>& c)
      : origin_(a), ab_(b.x - a.x, b.y - a.y), ac_(c.x - a.x, c.y - a.y), inverse_w_{a.w, b.w, c.w} {
    const R area = difference_of_products(ab_.x, ac_.y, ac_.x, ab_.y);
    inverse_area_ = area != R(0) ? R(1) / area : R(0);
  }
  Triple<R> at(R x, R y) const {
    const R px = x - origin_.x, py = y - origin_.y;
    const auto positive = [](R t) { return t > R(0) ? t : R(0); };
    const R b = positive((px * ac_.y - ac_.x * py) * inverse_area_),
            c = positive((ab_.x * py - px * ab_.y) * inverse_area_);
    Triple<R> share{positive(R(1) - b - c) * inverse_w_[0], b * inverse_w_[1], c * inverse_w_[2]};
    const R sum = share[0] + share[1] + share[2];
    if (!(sum > R(0))) return {1, 0, 0};
    for (R& t : share) t = t / sum;
    return share;
  }

 private:
  glm::vec<4, R> origin_;
  glm::vec<2, R> ab_, ac_;
  Triple<R> inverse_w_;
  R inverse_area_;
};

/// What was lit, one element a face, a vertex or a corner.
template <std::floating_point R>
struct FaceLight {
  enum class Domain : std::uint8_t { face, vertex, corner };
  Domain domain = Domain::face;
  std::span<const Received<R>> received;
  std::span<const glm::uvec3> triangles;
  std::span<const glm::vec<4, R>> screen;  ///< by vertex (x_px, y_px, z, 1/w); not needed for faces

  const Received<R>& at_corner(std::uint32_t face, std::size_t c) const {
    return received[domain == Domain::corner ? 3 * std::size_t{face} + c
                                             : triangles[face][static_cast<glm::length_t>(c)]];
  }
};

/// Light of the faces `id` at the samples of one row: that of the face, or its corners' by their shares there.
///   x0, y  absolute pixel of id[0]; sample: which of the pattern's
///   out    diffuse, then specular light, n each; specular rows may be null. 0 where there is no face.
template <std::floating_point R>
void face_light_row(const FaceLight<R>& light, const SamplePositions& pattern, const std::uint32_t* id,
                    int sample, int x0, int y, std::size_t n, const std::array<R*, 6>& out) {
  const auto put = [&](std::size_t x, const Received<R>& r) {
    for (std::size_t k = 0; k < 3; ++k) {
      out[k][x] = r.diffuse[k];
      if (out[3 + k] != nullptr) out[3 + k][x] = r.specular[k];
    }
  };
  std::optional<CornerShares<R>> shares;
  std::array<const Received<R>*, 3> corner{};
  std::uint32_t current = nothing_there;
  for (std::size_t x = 0; x < n; ++x) {
    const std::uint32_t f = id[x];
    if (f >= light.triangles.size()) {
      put(x, {});
      continue;
    }
    if (light.domain == FaceLight<R>::Domain::face) {
      put(x, light.received[f]);
      continue;
    }
    if (f != current) {
      current = f;
      const glm::uvec3& t = light.triangles[f];
      shares.emplace(light.screen[t[0]], light.screen[t[1]], light.screen[t[2]]);
      for (std::size_t c = 0; c < 3; ++c) corner[c] = &light.at_corner(f, c);
    }
    const int px = x0 + static_cast<int>(x);
    const std::size_t at = pattern.index(sample, px, y);
    const R sx = static_cast<R>(pattern.x[at]) * R(0x1p-12), sy = static_cast<R>(pattern.y[at]) * R(0x1p-12);
    const Triple<R> w = shares->at(static_cast<R>(px) + sx, static_cast<R>(y) + sy);
    Received<R> r;
    for (std::size_t k = 0; k < 3; ++k) {
      r.diffuse[k] =
          w[0] * corner[0]->diffuse[k] + w[1] * corner[1]->diffuse[k] + w[2] * corner[2]->diffuse[k];
      r.specular[k] =
          w[0] * corner[0]->specular[k] + w[1] * corner[1]->specular[k] + w[2] * corner[2]->specular[k];
    }
    put(x, r);
  }
}

}  // namespace frustum::kernels
