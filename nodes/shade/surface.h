// Shading of visible points: how a row of samples gets its colours. The arithmetic of light itself is
// nodes/kernels/lighting.h; what is lit once per face or corner, nodes/kernels/face_light.h.
#pragma once

#include "nodes/kernels/face_light.h"
#include "nodes/kernels/shading_scene.h"
#include "nodes/kernels/simd/lighting.h"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace frustum::shading {

using kernels::nothing_there;
using kernels::Received;
using kernels::Triple;

template <std::floating_point R>
using Surface = kernels::ShadedSurface<R>;
template <std::floating_point R>
using Scene = kernels::ShadingScene<R>;

// ----- rows

/// Elements [first, second) of a row.
using Run = std::pair<std::size_t, std::size_t>;

/// Runs of pixels whose samples do not all show one face (id: a row of n for each sample), joined over gaps too short
/// to be worth a row of vectors of their own. `differs` is working memory for n.
inline void find_mixed(std::span<const std::uint32_t* const> id, std::size_t n,
                       std::span<std::uint32_t> differs, std::vector<Run>& runs) {
  constexpr std::size_t gap = 16;
  std::fill(differs.begin(), differs.end(), 0u);
  for (std::size_t k = 1; k < id.size(); ++k)
    for (std::size_t x = 0; x < n; ++x) differs[x] |= id[k][x] ^ id[0][x];
  runs.clear();
  for (std::size_t x = 0; x < n; ++x) {
    if (differs[x] == 0) continue;
    if (!runs.empty() && x < runs.back().second + gap)
      runs.back().second = x + 1;
    else
      runs.emplace_back(x, x + 1);
  }
}

/// Light by rows for float goes to the vector kernels, for double to their scalar twins.
template <std::floating_point R>
void receive_row(const kernels::LightSetup<R>& setup, const kernels::PointRows<R>& in,
                 kernels::Selection which, std::size_t n, const kernels::LightRows<R>& out) {
  if constexpr (sizeof(R) == 4)
    kernels::simd::receive_light(setup, in, which, n, out);
  else
    kernels::receive_light(setup, in, which, n, out);
}

template <std::floating_point R>
void reflect_row(const kernels::SurfaceColors<R>& colors, const kernels::LightInput<R>& light,
                 const std::array<const R*, 3>& albedo, const R* opacity, kernels::Selection which, bool keep,
                 std::size_t n, const kernels::ColorRows<R>& out) {
  if constexpr (sizeof(R) == 4)
    kernels::simd::reflect_light(colors, light, albedo, opacity, which, keep, n, out);
  else
    kernels::reflect_light(colors, light, albedo, opacity, which, keep, n, out);
}

/// A number of each point's face: see kernels::numbers_of_faces.
template <std::floating_point R>
void face_number_row(std::span<const R> table, const std::uint32_t* id, std::size_t n, R* out) {
  if constexpr (sizeof(R) == 4)
    kernels::simd::numbers_of_faces(table, id, n, out);
  else
    kernels::numbers_of_faces<R>(table, id, n, out);
}

template <std::floating_point R>
bool take_face_row(std::uint32_t* left, std::size_t samples, std::size_t n, std::span<const R* const> in,
                   std::uint32_t* face, std::span<R* const> mean) {
  if constexpr (sizeof(R) == 4)
    return kernels::simd::take_face(left, samples, n, in, face, mean);
  else
    return kernels::take_face(left, samples, n, 0, n, in, face, mean);
}

template <std::floating_point R>
void put_face_row(const std::uint32_t* id, const std::uint32_t* face, std::size_t n,
                  const kernels::ColorRows<R>& from, const kernels::ColorRows<R>& to) {
  if constexpr (sizeof(R) == 4)
    kernels::simd::put_face(id, face, n, from, to);
  else
    kernels::put_face(id, face, 0, n, from, to);
}

/// Working memory for one row of n points.
template <std::floating_point R>
struct RowScratch {
  kernels::LightRows<R> light;
  R *side = nullptr, *opacity = nullptr;
  std::uint32_t* tag = nullptr;
  std::vector<std::uint8_t>* present = nullptr;  ///< one flag a surface
};

/// A row of points to shade: either points to light (normal set), or light already received.
template <std::floating_point R>
struct PointRow {
  const std::uint32_t* id = nullptr;
  std::array<const R*, 3> normal{}, position{};
  kernels::LightInput<R> received{};
  std::array<const R*, 3> albedo{};
  std::span<const R* const> reach{};  ///< as kernels::PointRows
};

template <std::floating_point R>
void clear_row(std::size_t n, const kernels::ColorRows<R>& out) {
  for (R* plane : out.plane)
    if (plane != nullptr) std::fill_n(plane, n, R(0));
}

/// Copies the planes that both have.
template <std::floating_point R>
void copy_row(const kernels::ColorRows<R>& from, std::size_t n, const kernels::ColorRows<R>& to) {
  for (std::size_t k = 0; k < 4; ++k)
    if (to.plane[k] != nullptr) std::copy_n(from.plane[k], n, to.plane[k]);
}

/// Adds as much of `light` as reaches each point of the run; all of it for null.
template <std::floating_point R>
void add_row(const R* light, const R* reach, const Run& run, R* to) {
  for (std::size_t x = run.first; x < run.second; ++x)
    to[x] = to[x] + (reach == nullptr ? light[x] : light[x] * reach[x]);
}

/// Whether a point of the row that shows a face is not opaque; null: all are. Blocks of a fixed length vectorise.
template <std::floating_point R>
bool any_clear(const std::uint32_t* id, const R* alpha, std::size_t n) {
  if (alpha == nullptr) return false;
  constexpr std::size_t block = 16;
  const auto clear = [&](std::size_t x) -> std::uint32_t {
    return static_cast<std::uint32_t>(id[x] != nothing_there) & static_cast<std::uint32_t>(alpha[x] != R(1));
  };
  std::uint32_t any = 0;
  std::size_t x = 0;
  for (; x + block <= n && any == 0; x += block)
    for (std::size_t k = 0; k < block; ++k) any |= clear(x + k);
  for (; x < n; ++x) any |= clear(x);
  return any != 0;
}

/// Light falls on the straight colour: where a point is not opaque, premultiplied albedo is divided by its opacity, in
/// rows of `to` that `albedo` points to then.
template <std::floating_point R>
void straighten_row(const R* alpha, std::size_t n, const std::array<R*, 3>& to,
                    std::array<const R*, 3>& albedo) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t x = 0; x < n; ++x)
      to[c][x] = alpha[x] > R(0) && alpha[x] != R(1) ? albedo[c][x] / alpha[x] : albedo[c][x];
    albedo[c] = to[c];
  }
}

/// Scales colours by the opacity of each point. What is not there has no light, however bright: 0 times infinity would
/// be NaN. Where nothing is seen colours stay 0, whatever the albedo says there (0 times a negative lobe is -0).
template <std::floating_point R>
void cover_row(const std::uint32_t* id, const R* alpha, std::size_t n, const kernels::ColorRows<R>& out) {
  for (R* plane : out.plane)
    for (std::size_t x = 0; x < n && plane != nullptr; ++x)
      plane[x] = id[x] == nothing_there || alpha[x] == R(0) ? R(0) : plane[x] * alpha[x];
}

/// Premultiplied colours of a row of faces, each as opaque as the scene says; transparent black where nothing is seen.
template <std::floating_point R>
void shade_row(const Scene<R>& s, const PointRow<R>& in, std::size_t n, const RowScratch<R>& scratch,
               const kernels::ColorRows<R>& out) {
  kernels::PointRows<R> points{in.normal, in.position, nullptr, in.reach};
  if (in.normal[0] != nullptr && !s.side.empty()) {
    face_number_row<R>(s.side, in.id, n, scratch.side);
    points.sign = scratch.side;
  }
  const R* opacity = s.opacity.empty() ? nullptr : scratch.opacity;
  if (opacity != nullptr) face_number_row<R>(s.opacity, in.id, n, scratch.opacity);
  const auto draw = [&](const Surface<R>& surface, kernels::Selection which, bool keep) {
    const bool lit = in.normal[0] == nullptr;
    if (!lit) receive_row(s.setup(surface), points, which, n, scratch.light);
    reflect_row(surface.colors, lit ? in.received : kernels::LightInput<R>(scratch.light), in.albedo, opacity,
                which, keep, n, out);
  };
  if (s.surface_of.empty()) return draw(s.surfaces[0], {in.id, nothing_there}, false);

  auto& present = *scratch.present;
  present.assign(s.surfaces.size(), 0);
  for (std::size_t x = 0; x < n; ++x) {
    scratch.tag[x] = in.id[x] < s.surface_of.size() ? s.surface_of[in.id[x]] : nothing_there;
    if (scratch.tag[x] != nothing_there) present[scratch.tag[x]] = 1;
  }
  bool keep =
      false;  // the first surface drawn also clears what none covers; the last one does where none is present
  for (std::size_t m = 0; m < s.surfaces.size(); ++m) {
    if (present[m] == 0 && (keep || m + 1 < s.surfaces.size())) continue;
    draw(s.surfaces[m], {scratch.tag, static_cast<std::uint32_t>(m)}, keep);
    keep = true;
  }
}

}  // namespace frustum::shading
