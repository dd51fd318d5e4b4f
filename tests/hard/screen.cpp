#include "tests/hard/screen.h"

#include "nodes/kernels/camera.h"
#include "nodes/kernels/clip.h"
#include "nodes/kernels/simd/fill_triangles.h"
#include "nodes/kernels/simd/interpolate_attributes.h"
#include "nodes/project/viewport.h"

namespace frustum::hard {
namespace {

using Quad = __float128;
using Row = std::array<Quad, 3>;  // x, y, w

Quad determinant(const Row& a, const Row& b, const Row& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// With e_i the determinants of the ray and two corners, the ray meets sum e_i p_i / sum e_i.
class Rays {
 public:
  explicit Rays(const ClipTriangle& t) {
    for (std::size_t i = 0; i < 3; ++i)
      p_[i] = {Quad(t[i].x), Quad(t[i].y), Quad(t[i].w)}, z_[i] = Quad(t[i].z);
    whole_ = determinant(p_[0], p_[1], p_[2]);
  }
  bool meets(double x_ndc, double y_ndc) const {
    const Row ray{Quad(x_ndc), Quad(y_ndc), Quad(1)};
    const std::array<Quad, 3> e{determinant(ray, p_[1], p_[2]), determinant(p_[0], ray, p_[2]),
                                determinant(p_[0], p_[1], ray)};
    if (whole_ == 0) return false;
    const Quad sign = whole_ > 0 ? Quad(1) : Quad(-1);
    Quad z = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (e[i] * sign < 0) return false;
      z += e[i] * z_[i];
    }
    z = z / whole_;
    return z >= -1 && z <= 1;
  }

 private:
  std::array<Row, 3> p_;
  std::array<Quad, 3> z_;
  Quad whole_;
};

}  // namespace

void ScreenTriangles::add(const glm::vec4& a, const glm::vec4& b, const glm::vec4& c, std::uint32_t source) {
  const auto first = static_cast<std::uint32_t>(position.size());
  position.insert(position.end(), {a, b, c});
  face.push_back({first, first + 1, first + 2});
  origin.push_back(source);
}

Picture filled(const kernels::ScreenMesh<float>& mesh, int width, int height,
               const kernels::SamplePositions& pattern, int x0, int y0) {
  const auto size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  Picture out{width, height, std::vector<std::uint32_t>(size), std::vector<float>(size)};
  const kernels::PixelRect window{x0, y0, x0 + width, y0 + height};
  const auto bins = kernels::bin_triangles(mesh, pattern, window);
  kernels::simd::fill_triangles({mesh, pattern, &bins}, window, {out.id.data(), width, 0},
                                {out.z.data(), width, 0});
  if (!mesh.origin.empty())
    for (auto& id : out.id)
      if (id != kernels::no_face) id = mesh.origin[id];
  return out;
}

std::vector<float> interpolated(const kernels::ScreenMesh<float>& mesh, const Picture& picture,
                                const std::vector<float>& values, int x0, int y0) {
  std::vector<float> out(picture.id.size());
  kernels::Attribute<float> attribute{values.data(), 1, kernels::AttributeDomain::vertex};
  attribute.value[0] = {out.data(), picture.width, 0};
  const kernels::AttributeScene<float> scene{mesh, kernels::centre_sample()};
  kernels::simd::interpolate_attributes(scene, {x0, y0, x0 + picture.width, y0 + picture.height},
                                        {picture.id.data(), picture.width, 0}, {{&attribute, 1}});
  return out;
}

Picture drawn(std::span<const ClipTriangle> triangles, int width, int height, double guard_band) {
  const auto planes = kernels::view_volume({}, guard_band);
  const kernels::Viewport viewport({width, height});
  ScreenTriangles out;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto& t = triangles[i];
    unsigned any = 0;
    for (const auto& p : t) any |= kernels::outcode(planes, p);
    const auto ring = kernels::clip_triangle(planes, static_cast<std::uint8_t>(any), t[0], t[1], t[2]);
    std::vector<glm::vec4> clip, screen(ring.size);
    for (std::size_t k = 0; k < ring.size; ++k) clip.push_back(ring.vertex[k].p);
    std::vector<std::uint8_t> no_point(ring.size);
    project::clip_to_screen<float>(true, viewport, clip, screen, no_point);
    for (std::size_t k = 2; k < ring.size; ++k)
      if ((no_point[0] | no_point[k - 1] | no_point[k]) == 0) out.add(screen[0], screen[k - 1], screen[k], i);
  }
  return filled(out.mesh(), width, height);
}

Picture drawn_without_clipping(std::span<const ClipTriangle> triangles, int width, int height) {
  ScreenTriangles out;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    std::array<glm::vec4, 3> screen;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec4 p = triangles[i][k], ndc = p * (1 / p.w);
      screen[k] = {(ndc.x + 1) * static_cast<float>(width) / 2, (1 - ndc.y) * static_cast<float>(height) / 2,
                   ndc.z, 1 / p.w};
    }
    out.add(screen[0], screen[1], screen[2], i);
  }
  return filled(out.mesh(), width, height);
}

std::vector<int> seen(const ClipTriangle& triangle, int width, int height) {
  const Rays rays(triangle);
  constexpr double off = 0x1p-6;
  const auto x_ndc = [&](double px) { return (2 * px - width) / width; };
  const auto y_ndc = [&](double px) { return (height - 2 * px) / height; };
  std::vector<int> out;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // The middle too: what is thinner than the probes' distance slips between them.
      int hits = rays.meets(x_ndc(x + 0.5), y_ndc(y + 0.5)) ? 1 : 0;
      for (const double dx : {-off, off})
        for (const double dy : {-off, off})
          hits += rays.meets(x_ndc(x + 0.5 + dx), y_ndc(y + 0.5 + dy)) ? 1 : 0;
      out.push_back(hits == 5 ? 1 : (hits == 0 ? 0 : -1));
    }
  return out;
}

std::size_t wrong_pixels(const Picture& picture, const std::vector<int>& seen) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i] >= 0 && (picture.id[i] != kernels::no_face) != (seen[i] == 1)) ++wrong;
  return wrong;
}

}  // namespace frustum::hard
