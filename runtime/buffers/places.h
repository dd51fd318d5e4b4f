// Where the points of a picture lie, for textures that fill space: by their coordinates, or in the world.
#pragma once

#include "nodes/kernels/noise.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/core/node_type.h"

#include <glm/vec3.hpp>

#include <array>
#include <utility>

namespace frustum {

enum class Domain3 : std::uint8_t { uv, world };
constexpr auto choices(Domain3) {
  return std::array{std::pair{Domain3::uv, "uv"}, std::pair{Domain3::world, "world"}};
}

// The planes of a place: x y z, by_x of each, by_y of each; those of the third coordinate of uv do not exist.
struct PlacePlanes {
  std::array<RealPlane, 9> plane{};
  int id = -1;
};

// Names the planes to read; those of derivatives only where `slopes` is set. Throws as read_real does.
inline PlacePlanes read_places(const Tiled<Image>& points, Domain3 domain, bool slopes, Precision precision) {
  constexpr std::array uv{"uv.u", "uv.v", "", "uv.du_dx", "uv.dv_dx", "", "uv.du_dy", "uv.dv_dy", ""};
  constexpr std::array world{"P.x",     "P.y",     "P.z",     "P.dx_dx", "P.dy_dx",
                             "P.dz_dx", "P.dx_dy", "P.dy_dy", "P.dz_dy"};
  PlacePlanes p;
  for (std::size_t i = 0; i < (slopes ? 9 : 3); ++i) {
    const std::string_view name = domain == Domain3::uv ? uv[i] : world[i];
    if (!name.empty()) p.plane[i] = read_real(points, name, precision);
  }
  p.id = points.try_read("id").value_or(-1);
  return p;
}

// Calls body(rows, sample, y) for every row of `out`'s rectangle, with the rows of places beside it.
template <class R, class Body>
void for_each_place_row(const PlacePlanes& p, const Tile& points, const Tile& out, Arena& arena,
                        const Body& body) {
  std::array<std::span<R>, 9> wide;
  if constexpr (sizeof(R) == 8)
    for (auto& row : wide) row = arena.take<R>(static_cast<std::size_t>(out.rect().width()));
  for (int s = 0; s < out.samples(); ++s)
    for (int y = out.rect().y0; y < out.rect().y1; ++y) {
      kernels::PlaceRows<R> rows;
      for (std::size_t i = 0; i < 9; ++i) {
        const R* row = real_row<R>(points, p.plane[i], s, y, wide[i]);
        (i < 3 ? rows.at : i < 6 ? rows.by_x : rows.by_y)[i % 3] = row;
      }
      rows.id = p.id < 0 ? nullptr : points.row<const std::uint32_t>(p.id, s, y);
      body(rows, s, y);
    }
}

// The frame of a colour for every point.
inline Frame color_frame(const Frame& points, Precision precision) {
  const PlaneKind kind = real_kind(precision);
  return {.window = points.window,
          .pattern = points.pattern,
          .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
          .color_space = std::string(linear_rec709),
          .alpha = Alpha::premultiplied};
}

// A texture of mixes between two colours while it fills tiles: its node's parameters, which name `domain`, `bounded`,
// `low` and `high`, and the planes it reads.
template <class Params>
struct SpaceTexture {
  Params look;
  PlacePlanes places;
  Precision precision;
};

// What it shows by itself: points without ids all have a place, those at the origin, too.
template <class State>
Rect seen_without_ids(const State& s, Rect rect) {
  return s.places.id < 0 ? rect : Rect{};
}

template <class Outputs, class Params, class Inputs>
Prepared<SpaceTexture<Params>, Outputs> prepare_space_texture(const Inputs& in, const Params& p,
                                                              Context& ctx) {
  return {{p, read_places(in.points, p.domain, p.bounded, ctx.precision), ctx.precision},
          {color_frame(in.points.frame(), ctx.precision)}};
}

// Fills a tile with low + mix (high - low), alpha 1; transparent black where nothing is seen. mix_row(rows,
// n, mix) gives a row.
template <class R, class MixRow>
void paint_mix(const PlacePlanes& places, const Tile& points, const Tile& out, Arena& arena,
               const glm::dvec3& low, const glm::dvec3& high, const MixRow& mix_row) {
  const auto n = static_cast<std::size_t>(out.rect().width());
  const auto mix = arena.take<R>(n);
  for_each_place_row<R>(places, points, out, arena,
                        [&](const kernels::PlaceRows<R>& rows, int sample, int y) {
                          mix_row(rows, n, mix.data());
                          for (int c = 0; c < 4; ++c) {
                            R* to = out_row<R>(out, c, sample, y);
                            if (to == nullptr) continue;
                            const R from = c < 3 ? static_cast<R>(low[c]) : R(1),
                                    across = c < 3 ? static_cast<R>(high[c]) - from : R(0);
                            for (std::size_t x = 0; x < n; ++x)
                              to[x] = rows.covers(x) ? from + mix[x] * across : R(0);
                          }
                        });
}

}  // namespace frustum
