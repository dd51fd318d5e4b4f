// Attributes of the faces seen at samples: perspective-correct or affine, with screen derivatives.
#pragma once

#include <array>

#include "nodes/kernels/fill_triangles.h"

namespace frustum::kernels {

// hyperbolic is straight in the scene (perspective-correct); affine is straight on the screen and wrong in
// perspective.
enum class Interpolation { hyperbolic, affine };

// What the rows of a column belong to: its element `row(face, corner)` is the corner's.
enum class AttributeDomain { vertex, corner, face };

// A column of `width` (1 to 4) numbers a row and the planes to fill from it. A plane without data is not
// computed.
template <std::floating_point R>
struct Attribute {
  const R* data;
  int width;
  AttributeDomain domain;
  std::array<PlaneView<R>, 4> value{}, dx{}, dy{};  // per component; derivatives per px

  std::size_t row(const ScreenMesh<R>& mesh, std::uint32_t face, int corner) const {
    if (domain == AttributeDomain::vertex) return mesh.face[face][corner];
    return domain == AttributeDomain::corner ? std::size_t{3} * face + static_cast<std::size_t>(corner)
                                             : face;
  }
  bool differentiates() const {
    const auto asked = [](const PlaneView<R>& p) { return p.data != nullptr; };
    return std::any_of(dx.begin(), dx.end(), asked) || std::any_of(dy.begin(), dy.end(), asked);
  }
};

template <std::floating_point R>
struct AttributeScene {
  ScreenMesh<R> mesh;
  SamplePositions pattern;
  Interpolation interpolation = Interpolation::hyperbolic;
};

// The planes to fill for one rectangle.
template <std::floating_point R>
struct AttributePlanes {
  std::span<const Attribute<R>> attributes;
  PlaneView<R> w{};  // the distance 1 / (1/w); not computed without data
};

// Fills the planes at every sample of `rect` (absolute pixels) from the faces `id` that fill_triangles found
// there; samples with no_face get 0.
//   value = (a + u (b - a)) + v (c - a), held within the three corners' values,
// where a belongs to the corner of greatest weight and u, v are the other two weights. So a constant
// attribute keeps its bits, a sample on a corner gets the corner's bits, and nothing leaves the corners'
// range. Weights come in binary64 from the snapped corners, so that they are exact but for the last rounding
// while extent_px < 2^16. A pure function of (x, y, sample). This is the truth that
// simd/interpolate_attributes.h is held against.
template <std::floating_point R>
void interpolate_attributes(const AttributeScene<R>& scene, PixelRect rect, PlaneView<const std::uint32_t> id,
                            const AttributePlanes<R>& planes);

// The weights of one sample: of corner `base`, the greatest, and u, v of the two that follow it, with
// derivatives per px.
struct SampleWeights {
  int base;
  double u, v, u_dx, v_dx, u_dy, v_dy, w;
};

// A triangle's corners as weights need them. Edge k lies opposite corner k; units are those of the grids.
class WeightedCorners {
 public:
  template <std::floating_point R>
  WeightedCorners(const ScreenMesh<R>& mesh, std::uint32_t face, Interpolation interpolation) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec<4, R>& p = mesh.position[mesh.face[face][static_cast<int>(k)]];
      x_[k] = snap(static_cast<double>(p.x), mesh.corner_bits);
      y_[k] = snap(static_cast<double>(p.y), mesh.corner_bits);
      per_w_[k] = static_cast<double>(p.w);
      q_[k] = interpolation == Interpolation::hyperbolic ? per_w_[k] : 1;
    }
    affine_ = interpolation == Interpolation::affine;
  }

  // At the sample (offset_x, offset_y) * 2^-12 px into pixel (x, y).
  SampleWeights at(int x, int y, int offset_x, int offset_y) const;

 private:
  std::array<double, 3> x_, y_, per_w_, q_;
  bool affine_;
};

inline SampleWeights WeightedCorners::at(int x, int y, int offset_x, int offset_y) const {
  constexpr double scale = sample_unit / corner_unit;
  const double sx = x * double{sample_unit} + offset_x, sy = y * double{sample_unit} + offset_y;
  std::array<double, 3> e, g, g_dx, g_dy;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t from = (k + 1) % 3, to = (k + 2) % 3;
    const double ex = x_[to] - x_[from], ey = y_[to] - y_[from];
    e[k] = ex * (sy - y_[from] * scale) - ey * (sx - x_[from] * scale);
    g[k] = e[k] * q_[k];
    g_dx[k] = ey * -double{sample_unit} * q_[k];
    g_dy[k] = ex * double{sample_unit} * q_[k];
  }
  const double inverse = 1 / ((g[0] + g[1]) + g[2]);
  const double s_dx = (g_dx[0] + g_dx[1]) + g_dx[2], s_dy = (g_dy[0] + g_dy[1]) + g_dy[2];
  std::array<double, 3> m, m_dx, m_dy;
  for (std::size_t k = 0; k < 3; ++k) {
    m[k] = g[k] * inverse;
    m_dx[k] = (g_dx[k] - m[k] * s_dx) * inverse;
    m_dy[k] = (g_dy[k] - m[k] * s_dy) * inverse;
  }
  const std::size_t b = m[0] >= m[1] && m[0] >= m[2] ? 0
                        : m[1] >= m[2]               ? 1
                                                     : 2,
                    i = (b + 1) % 3, j = (b + 2) % 3;
  const auto distance = [&](std::size_t k) { return 1 / per_w_[k]; };
  const double w =
      affine_ ? (distance(b) + m[i] * (distance(i) - distance(b))) + m[j] * (distance(j) - distance(b))
              : ((e[0] + e[1]) + e[2]) * inverse;
  return {static_cast<int>(b), m[i], m[j], m_dx[i], m_dx[j], m_dy[i], m_dy[j], w};
}

// Fills one sample of one attribute.
template <std::floating_point R>
void interpolate_attribute(const Attribute<R>& attribute, const ScreenMesh<R>& mesh, std::uint32_t face,
                           const SampleWeights& weights, int sample, int x, int y) {
  const auto width = static_cast<std::size_t>(attribute.width);
  std::array<const R*, 3> corner;
  for (int k = 0; k < 3; ++k)
    corner[static_cast<std::size_t>(k)] =
        attribute.data + attribute.row(mesh, face, (weights.base + k) % 3) * width;
  const R u = static_cast<R>(weights.u), v = static_cast<R>(weights.v);
  for (std::size_t i = 0; i < width; ++i) {
    const R a = corner[0][i], b = corner[1][i], c = corner[2][i], ab = b - a, ac = c - a;
    const auto put = [&](const PlaneView<R>& plane, R number) {
      if (plane.data != nullptr) plane.row(sample, y)[x] = number;
    };
    const R least = std::min({a, b, c}), greatest = std::max({a, b, c});
    R value = (a + u * ab) + v * ac;
    value = value < least ? least : value;
    put(attribute.value[i], value > greatest ? greatest : value);
    put(attribute.dx[i], static_cast<R>(weights.u_dx) * ab + static_cast<R>(weights.v_dx) * ac);
    put(attribute.dy[i], static_cast<R>(weights.u_dy) * ab + static_cast<R>(weights.v_dy) * ac);
  }
}

template <std::floating_point R>
void interpolate_attributes(const AttributeScene<R>& scene, PixelRect rect, PlaneView<const std::uint32_t> id,
                            const AttributePlanes<R>& planes) {
  const int width = rect.x1 - rect.x0, height = rect.y1 - rect.y0;
  for (int s = 0; s < scene.pattern.samples; ++s)
    for (int y = 0; y < height; ++y) {
      const auto clear = [&](const PlaneView<R>& plane) {
        if (plane.data != nullptr) std::fill_n(plane.row(s, y), width, R(0));
      };
      clear(planes.w);
      for (const Attribute<R>& a : planes.attributes)
        for (std::size_t i = 0; i < static_cast<std::size_t>(a.width); ++i)
          clear(a.value[i]), clear(a.dx[i]), clear(a.dy[i]);
      const std::uint32_t* faces = id.row(s, y);
      std::optional<WeightedCorners> corners;
      for (int x = 0; x < width; ++x) {
        if (faces[x] == no_face) continue;
        if (!corners || faces[x] != faces[x - 1]) corners.emplace(scene.mesh, faces[x], scene.interpolation);
        const std::size_t at = scene.pattern.index(s, rect.x0 + x, rect.y0 + y);
        const SampleWeights weights =
            corners->at(rect.x0 + x, rect.y0 + y, scene.pattern.x[at], scene.pattern.y[at]);
        if (planes.w.data != nullptr) planes.w.row(s, y)[x] = static_cast<R>(weights.w);
        for (const Attribute<R>& a : planes.attributes)
          interpolate_attribute(a, scene.mesh, faces[x], weights, s, x, y);
      }
    }
}

}  // namespace frustum::kernels
