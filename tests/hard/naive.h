// Textbook formulas that several cases hold against ours, written as the textbook has them.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cmath>

namespace frustum::hard::naive {

template <class R>
R dot(const glm::vec<3, R>& a, const glm::vec<3, R>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class R>
glm::vec<3, R> normalized(const glm::vec<3, R>& v) {
  return v / std::sqrt(dot(v, v));
}

// Rodrigues: cos t I + sin t [k] + (1 - cos t) k k'.
template <class R>
glm::mat<3, 3, R> rotation(const glm::vec<3, R>& axis, R angle) {
  const glm::vec<3, R> k = normalized(axis);
  const R c = std::cos(angle), s = std::sin(angle), v = 1 - c;
  return {{c + v * k.x * k.x, v * k.x * k.y + s * k.z, v * k.x * k.z - s * k.y},
          {v * k.x * k.y - s * k.z, c + v * k.y * k.y, v * k.y * k.z + s * k.x},
          {v * k.x * k.z + s * k.y, v * k.y * k.z - s * k.x, c + v * k.z * k.z}};
}

// Cramer's rule: the adjugate divided by the determinant.
template <class R>
glm::mat<3, 3, R> inverse(const glm::mat<3, 3, R>& m) {
  const auto minor = [&](int r, int c) {
    const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
    return m[c1][r1] * m[c2][r2] - m[c1][r2] * m[c2][r1];
  };
  const R det = m[0][0] * minor(0, 0) + m[1][0] * minor(0, 1) + m[2][0] * minor(0, 2);
  glm::mat<3, 3, R> inverse;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) inverse[c][r] = minor(c, r) / det;
  return inverse;
}

}  // namespace frustum::hard::naive
