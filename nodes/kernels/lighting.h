// Light reflected by rows of points: Lambert, Phong, Blinn. The truth for every Real; simd/lighting.cpp has
// the twin for float, operation by operation.
//
// For unit vectors n (normal), l (to the light), v (to the eye), each light of colour c adds
//   diffuse   c max(0, n.l)
//   specular  c max(0, r.v)^e, r = 2 n (n.l) - l   (Phong)   or   c max(0, n.h)^e, h = l + v normalised
//             (Blinn)
// and nothing where n.l <= 0: errata E33 to E36 of the course. Vectors without a length, and NaN, give no
// light.
#pragma once

#include "nodes/kernels/elementary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace frustum::kernels {

template <std::floating_point R>
using Triple = std::array<R, 3>;

template <std::floating_point R>
struct LightSource {
  bool is_point = false;
  Triple<R> color{};
  Triple<R> place{};        ///< unit vector towards a directional light, or the position of a point light
  Triple<R> attenuation{};  ///< of a point light: colour / (x + y d + z d^2)
  bool is_spot = false;     ///< a point light that shines into a cone
  bool is_patch =
      false;         ///< a point light that is a piece of a flat lamp: as strong as the cosine from its axis
  Triple<R> axis{};  ///< of the cone or the piece: unit vector along which it shines
  R cone_scale = 0,
    cone_offset = 1;      ///< strength times t^2, t = cosine from the axis * scale + offset in [0, 1]
  bool falls_off = true;  ///< false: attenuation is (1, 0, 0), which divides by 1 at every distance
};

/// Between the inner and the outer angle from its axis a spot fades like the square of a ramp in the cosine
/// (as glTF's KHR_lights_punctual recommends). A ramp is at least 2^-12 wide, so that the rounding of a
/// float's cosine moves the strength by no more than 2^-11.
struct Cone {
  double scale, offset;
  Cone(double inner, double outer)
      : scale(1 / std::max(std::cos(inner) - std::cos(outer), 0x1p-12)), offset(-std::cos(outer) * scale) {}
};

enum class Highlight : std::uint8_t { none, phong, blinn };

/// x^shininess for x in [0, 1]. Whole exponents up to 2^10 are powers by squaring: off by e 2^-23 at most,
/// and several times faster than pow; x^0 is 1 even for 0.
template <std::floating_point R>
struct Exponent {
  R shininess = 1;
  int whole = 1;  ///< the exponent where it is whole and at most 2^10, otherwise -1

  explicit Exponent(double e = 1)
      : shininess(static_cast<R>(e)),
        whole(e >= 0 && e <= 1024 && e == std::floor(e) ? static_cast<int>(e) : -1) {}
  R operator()(R x) const {
    if (whole < 0) return kernels::pow(x, shininess);
    R result = 1;
    for (int e = whole; e != 0; e >>= 1, x = x * x)
      if ((e & 1) != 0) result = result * x;
    return result;
  }
};

template <std::floating_point R>
struct LightSetup {
  std::span<const LightSource<R>> lights;
  Triple<R> eye{};
  Highlight highlight = Highlight::none;
  Exponent<R> exponent{};
};

/// A point light is at most this strong: at a distance of 1e-20 its 1 / d^2 is infinite in float, and times a
/// colour of 0 it would be NaN (hard case SHD-06).
inline constexpr double greatest_strength = 0x1p96;

inline constexpr std::uint32_t nothing_there = 0xFFFFFFFFu;

/// Which elements of a row count: those whose tag is `wanted`, or every one that is not `nothing_there`.
struct Selection {
  const std::uint32_t* tag = nullptr;
  std::uint32_t wanted = nothing_there;
  bool has(std::size_t x) const {
    return wanted == nothing_there ? tag[x] != nothing_there : tag[x] == wanted;
  }
};

/// Rows of points. Normals need no unit length; `sign` (null: +1) turns them. Positions may be null where no
/// light and no highlight depends on them.
///   reach  by light a row of the share of it that reaches each point, null where all of it does; empty: all of all
template <std::floating_point R>
struct PointRows {
  std::array<const R*, 3> normal{}, position{};
  const R* sign = nullptr;
  std::span<const R* const> reach = {};
  std::size_t first = 0;  ///< of the points, in the rows of `reach`
  const R* reach_of(std::size_t light) const {
    return reach.empty() || reach[light] == nullptr ? nullptr : reach[light] + first;
  }
};

/// Rows of light received: before the surface's colours. `specular` may be null where no surface has a highlight.
template <std::floating_point R>
struct LightRows {
  std::array<R*, 3> diffuse{}, specular{};
};

template <std::floating_point R>
struct LightInput {
  std::array<const R*, 3> diffuse{}, specular{};
  LightInput() = default;
  LightInput(const LightRows<R>& rows)
      : diffuse{rows.diffuse[0], rows.diffuse[1], rows.diffuse[2]},
        specular{rows.specular[0], rows.specular[1], rows.specular[2]} {}
  LightInput(std::array<const R*, 3> d, std::array<const R*, 3> s) : diffuse(d), specular(s) {}
};

template <std::floating_point R>
R dot3(const Triple<R>& a, const Triple<R>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// v / |v|; zero where |v|^2 is zero, infinite or underflows.
template <std::floating_point R>
Triple<R> unit3(const Triple<R>& v) {
  const R square = dot3(v, v);
  const R inverse = square > R(0) ? R(1) / std::sqrt(square) : R(0);
  return {v[0] * inverse, v[1] * inverse, v[2] * inverse};
}

template <std::floating_point R>
struct Received {
  Triple<R> diffuse{}, specular{};
};

/// The cosine of the highlight's angle, in [0, 1].
template <std::floating_point R>
R highlight_cosine(Highlight kind, const Triple<R>& n, const Triple<R>& l, const Triple<R>& v, R n_l) {
  R x;
  if (kind == Highlight::phong) {
    x = R(2) * n_l * dot3(n, v) - dot3(l, v);
  } else {
    const Triple<R> h{l[0] + v[0], l[1] + v[1], l[2] + v[2]};
    const R square = dot3(h, h);
    x = square > R(0) ? dot3(n, h) / std::sqrt(square) : R(0);
  }
  x = x > R(0) ? x : R(0);
  return x < R(1) ? x : R(1);
}

///   share  by light, share(i) in [0, 1]: how much of the i-th reaches the point
template <std::floating_point R, class Share>
Received<R> receive(const LightSetup<R>& s, const Triple<R>& normal, const Triple<R>& p, const Share& share) {
  Received<R> sum;
  const Triple<R> n = unit3(normal);
  Triple<R> v{};
  if (s.highlight != Highlight::none) v = unit3<R>({s.eye[0] - p[0], s.eye[1] - p[1], s.eye[2] - p[2]});
  for (std::size_t i = 0; i < s.lights.size(); ++i) {
    const LightSource<R>& light = s.lights[i];
    Triple<R> l = light.place;
    R strength = share(i);
    if (light.is_point) {
      const Triple<R> d{l[0] - p[0], l[1] - p[1], l[2] - p[2]};
      const R square = dot3(d, d), distance = std::sqrt(square);
      l = unit3(d);
      if (light.falls_off) {
        R weaker =
            R(1) / (light.attenuation[0] + light.attenuation[1] * distance + light.attenuation[2] * square);
        weaker = weaker < R(greatest_strength) ? weaker : R(greatest_strength);
        strength = strength * weaker;
      }
      if (light.is_spot) {
        R t = light.cone_offset - dot3(l, light.axis) * light.cone_scale;
        t = t > R(0) ? t : R(0);
        t = t < R(1) ? t : R(1);
        strength = strength * (t * t);
      }
      if (light.is_patch) {
        const R cosine = -dot3(l, light.axis);
        strength = strength * (cosine > R(0) ? cosine : R(0));
      }
    }
    const R n_l = dot3(n, l);
    if (!(n_l > R(0))) continue;
    const R diffuse = n_l * strength;
    for (std::size_t k = 0; k < 3; ++k) sum.diffuse[k] = sum.diffuse[k] + light.color[k] * diffuse;
    if (s.highlight == Highlight::none) continue;
    const R specular = s.exponent(highlight_cosine(s.highlight, n, l, v, n_l)) * strength;
    for (std::size_t k = 0; k < 3; ++k) sum.specular[k] = sum.specular[k] + light.color[k] * specular;
  }
  return sum;
}

template <std::floating_point R>
Received<R> receive(const LightSetup<R>& s, const Triple<R>& normal, const Triple<R>& p) {
  return receive(s, normal, p, [](std::size_t) { return R(1); });
}

/// Light received by the selected points of a row; other elements of `out` are left unspecified.
template <std::floating_point R>
void receive_light(const LightSetup<R>& s, const PointRows<R>& in, Selection which, std::size_t n,
                   const LightRows<R>& out) {
  for (std::size_t x = 0; x < n; ++x) {
    if (!which.has(x)) continue;
    const R sign = in.sign == nullptr ? R(1) : in.sign[x];
    const Triple<R> normal{in.normal[0][x] * sign, in.normal[1][x] * sign, in.normal[2][x] * sign};
    Triple<R> p{};
    if (in.position[0] != nullptr) p = {in.position[0][x], in.position[1][x], in.position[2][x]};
    const Received<R> r = receive(s, normal, p, [&](std::size_t i) {
      const R* row = in.reach_of(i);
      return row == nullptr ? R(1) : row[x];
    });
    for (std::size_t k = 0; k < 3; ++k) {
      out.diffuse[k][x] = r.diffuse[k];
      if (out.specular[k] != nullptr) out.specular[k][x] = r.specular[k];
    }
  }
}

template <std::floating_point R>
struct SurfaceColors {
  Triple<R> ambient{};  ///< ambient light, already times the surface's ambient and diffuse shares
  Triple<R> diffuse{}, specular{};
  Triple<R> emission{};      ///< light of the surface's own
  bool adds_ambient = true;  ///< false: `ambient` is 0 and is not added
};

template <std::floating_point R>
struct ColorRows {
  std::array<R*, 4> plane{};  ///< R G B A; null where nobody reads it
};

/// albedo (ambient + diffuse d) + specular s + emission with alpha 1 at the selected points; elsewhere transparent
/// black, or what was there if `keep`. Where no colour is -0 or NaN, leaving out terms that are 0 keeps every bit:
/// emission, which is always added, turns a -0 that a negative albedo makes into 0 either way.
///   albedo   three rows, or null for 1
///   opacity  a row that scales colour and alpha at last, or null for 1
template <std::floating_point R>
void reflect_light(const SurfaceColors<R>& c, const LightInput<R>& light,
                   const std::array<const R*, 3>& albedo, const R* opacity, Selection which, bool keep,
                   std::size_t n, const ColorRows<R>& out) {
  for (std::size_t x = 0; x < n; ++x) {
    const bool selected = which.has(x);
    if (!selected && keep) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      if (out.plane[k] == nullptr) continue;
      R color = 0;
      if (selected) {
        color = c.diffuse[k] * light.diffuse[k][x];
        if (c.adds_ambient) color = c.ambient[k] + color;
        if (albedo[k] != nullptr) color = albedo[k][x] * color;
        if (light.specular[k] != nullptr) color = color + c.specular[k] * light.specular[k][x];
        color = color + c.emission[k];
        if (opacity != nullptr) color = color * opacity[x];
      }
      out.plane[k][x] = color;
    }
    if (out.plane[3] != nullptr) out.plane[3][x] = !selected ? R(0) : opacity != nullptr ? opacity[x] : R(1);
  }
}

/// The number in `table` of the face that each point of a row shows; 1 where the table has none.
template <std::floating_point R>
void numbers_of_faces(std::span<const R> table, const std::uint32_t* id, std::size_t n, R* out) {
  for (std::size_t x = 0; x < n; ++x) out[x] = id[x] < table.size() ? table[id[x]] : R(1);
}

// ----- once per face and pixel: the samples of a pixel in groups that see the same face

/// Takes from each pixel first <= x < last of a row the face of its first sample that is left, and the mean
/// over all of its samples with that face of `planes` numbers, summed in the order of the samples.
///   left  row s at left + s stride: the ids still to be taken, nothing_there where there is none; those
///         taken are set to
///         nothing_there
///   in    plane p of sample s at in[p samples + s]
///   face  the face taken, or nothing_there; mean: a row per plane, unspecified where there is no face
/// Returns whether any pixel had a face left.
template <std::floating_point R>
bool take_face(std::uint32_t* left, std::size_t samples, std::size_t stride, std::size_t first,
               std::size_t last, std::span<const R* const> in, std::uint32_t* face,
               std::span<R* const> mean) {
  bool any = false;
  for (std::size_t x = first; x < last; ++x) {
    std::uint32_t id = nothing_there;
    for (std::size_t s = samples; s-- > 0;)
      if (left[s * stride + x] != nothing_there) id = left[s * stride + x];
    face[x] = id;
    if (id == nothing_there) continue;
    any = true;
    R count = 0;
    for (std::size_t s = 0; s < samples; ++s) count = count + (left[s * stride + x] == id ? R(1) : R(0));
    for (std::size_t p = 0; p < mean.size(); ++p) {
      R sum = 0;
      for (std::size_t s = 0; s < samples; ++s)
        if (left[s * stride + x] == id) sum = sum + in[p * samples + s][x];
      mean[p][x] = sum / count;
    }
    for (std::size_t s = 0; s < samples; ++s)
      if (left[s * stride + x] == id) left[s * stride + x] = nothing_there;
  }
  return any;
}

/// Copies the planes of `from` that `to` has where `id` is `face` and there is a face.
template <std::floating_point R>
void put_face(const std::uint32_t* id, const std::uint32_t* face, std::size_t first, std::size_t last,
              const ColorRows<R>& from, const ColorRows<R>& to) {
  for (std::size_t x = first; x < last; ++x) {
    if (id[x] != face[x] || face[x] == nothing_there) continue;
    for (std::size_t k = 0; k < 4; ++k)
      if (to.plane[k] != nullptr) to.plane[k][x] = from.plane[k][x];
  }
}

}  // namespace frustum::kernels
