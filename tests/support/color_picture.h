// Pictures of given colours, one row of one sample, for the tests of colour nodes.
#pragma once

#include "runtime/buffers/image.h"
#include "runtime/core/error.h"
#include "runtime/core/node_type.h"
#include "tests/support/tiles.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace frustum::test {

template <class R>
Ref<Image> color_row(const std::vector<std::array<R, 4>>& rgba, Alpha alpha, std::string space,
                     std::array<const char*, 3> names = {"R", "G", "B"}) {
  constexpr PlaneKind real = plane_kind_of<R>;
  Frame frame{.window = {0, 0, static_cast<int>(rgba.size()), 1},
              .planes = {{names[0], real}, {names[1], real}, {names[2], real}},
              .color_space = std::move(space),
              .alpha = alpha};
  if (alpha != Alpha::none) frame.planes.push_back({"A", real});
  Raster raster(frame);
  for (std::size_t c = 0; c < frame.planes.size(); ++c)
    for (std::size_t x = 0; x < rgba.size(); ++x)
      raster.view().row<R>(static_cast<int>(c), 0, 0)[x] = rgba[x][c];
  return std::make_shared<const Image>(Image{std::move(raster)});
}

inline std::array<double, 3> color_at(const Raster& raster, int x) {
  return {raster.value(0, 0, x, 0), raster.value(1, 0, x, 0), raster.value(2, 0, x, 0)};
}

// One row as above in which samples and alpha differ: 48 x 37 px, random, for the law of tiles.
template <class R>
Ref<Image> random_colors(Alpha alpha = Alpha::premultiplied,
                         std::array<const char*, 3> names = {"R", "G", "B"}) {
  constexpr PlaneKind real = plane_kind_of<R>;
  Raster raster(
      Frame{.window = {-5, 3, 43, 40},
            .planes = {{"Z", real}, {names[2], real}, {"A", real}, {names[0], real}, {names[1], real}},
            .color_space = "lin_rec709",
            .alpha = alpha});
  std::uint32_t state = 12345;
  const auto random = [&] {
    return state = state * 1664525u + 1013904223u, static_cast<double>(state >> 8) * 0x1p-24;
  };
  for (int p = 0; p < 5; ++p)
    for (int y = 3; y < 40; ++y)
      for (int x = 0; x < 48; ++x)
        raster.view().row<R>(p, 0, y)[x] =
            x % 7 == 0 ? R(0) : static_cast<R>(p == 2 ? random() : 2 * random() - 0.5);
  return std::make_shared<const Image>(Image{std::move(raster)});
}

// The code of the error that preparing ends with; "" where there is none.
inline std::string color_error(NodeType type, std::string_view params, NodeInputs inputs) {
  try {
    const PixelRun run(std::move(type), params, std::move(inputs));
    return "";
  } catch (const NodeError& e) {
    return e.code;
  }
}

inline PixelRun color_run(NodeType type, std::string_view params, const Ref<Image>& image,
                          Precision precision = Precision::single) {
  return {std::move(type), params, {{"image", {image}}}, precision};
}

}  // namespace frustum::test
