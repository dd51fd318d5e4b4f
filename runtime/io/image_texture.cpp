#include "runtime/io/image_texture.h"

#include "nodes/kernels/half.h"
#include "nodes/kernels/image_pyramid.h"
#include "runtime/buffers/image.h"
#include "runtime/core/error.h"
#include "runtime/io/color.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <iterator>
#include <optional>

namespace frustum {
namespace {

// Which planes are colour: R, G, B, or one plane three times. Throws NodeError where there is neither.
struct Source {
  std::array<int, 3> color{};
  std::optional<int> alpha;
};

Source find_source(const Frame& f) {
  if (f.samples() > 1)
    throw NodeError("sampled_image",
                    "a texture takes one value a pixel; supersample.resolve filters samples to that");
  if (f.window.empty()) throw NodeError("empty_image", "the image has no pixels");
  Source s{.color = {}, .alpha = f.find("A")};
  const auto r = f.find("R"), g = f.find("G"), b = f.find("B");
  if (r && g && b)
    s.color = {*r, *g, *b};
  else if (f.planes.size() != 1)
    throw NodeError("missing_plane", "the image needs planes R, G and B, or just one plane");
  for (const int plane : s.color)
    if (f.planes[static_cast<std::size_t>(plane)].kind == PlaneKind::u32)
      throw NodeError("wrong_plane_kind", fmt::format("plane {} counts; a texture takes real numbers",
                                                      f.planes[static_cast<std::size_t>(plane)].name));
  return s;
}

// One row in linear light, interleaved. Straight alpha is multiplied in at the end, premultiplied taken out
// for a curve.
void convert_row(const Raster& raster, const Source& source, const ColorConversion& conversion, bool opaque,
                 int y, std::span<float> rgba) {
  const Frame& f = raster.frame();
  const auto width = static_cast<std::size_t>(f.window.width());
  std::array<std::vector<float>, 4> row;
  for (std::size_t k = 0; k < 4; ++k) {
    row[k].assign(width, 1.0f);
    const std::optional<int> plane = k < 3 ? std::optional(source.color[k]) : source.alpha;
    if (!plane) continue;
    for (std::size_t x = 0; x < width; ++x)
      row[k][x] = static_cast<float>(raster.value(*plane, 0, f.window.x0 + static_cast<int>(x), y));
  }
  const bool divides = source.alpha && f.alpha == Alpha::premultiplied && (opaque || !conversion.linear());
  const bool multiplies = source.alpha && !opaque && (divides || f.alpha == Alpha::straight);
  for (std::size_t k = 0; k < 3 && divides; ++k)
    for (std::size_t x = 0; x < width; ++x)
      if (row[3][x] > 0) row[k][x] /= row[3][x];
  conversion.apply(row[0].data(), row[1].data(), row[2].data(), width);
  for (std::size_t x = 0; x < width; ++x)
    for (std::size_t k = 0; k < 4; ++k) {
      const bool multiply = k < 3 && multiplies && (row[3][x] > 0 || f.alpha == Alpha::straight);
      rgba[4 * x + k] = multiply ? row[k][x] * row[3][x] : row[k][x];
    }
  for (std::size_t x = 0; x < width && opaque; ++x) rgba[4 * x + 3] = 1;
}

MipPyramid::Level first_level(const Raster& raster, const Source& source, const ColorConversion& conversion,
                              bool opaque) {
  const Rect w = raster.frame().window;
  const std::size_t row = 4 * static_cast<std::size_t>(w.width());
  MipPyramid::Level level{w.width(), w.height(),
                          std::vector<float>(row * static_cast<std::size_t>(w.height()))};
  tbb::parallel_for(0, w.height(), [&](int y) {
    convert_row(raster, source, conversion, opaque, w.y0 + y,
                std::span(level.rgba).subspan(row * static_cast<std::size_t>(y), row));
  });
  return level;
}

MipPyramid::Level next_level(const MipPyramid::Level& from) {
  MipPyramid::Level to{std::max(1, from.width / 2), std::max(1, from.height / 2), {}};
  const std::size_t row = 4 * static_cast<std::size_t>(to.width);
  to.rgba.resize(row * static_cast<std::size_t>(to.height));
  tbb::parallel_for(0, to.height, [&](int y) {
    kernels::halve_row(from.rgba, from.width, from.height, y,
                       std::span(to.rgba).subspan(row * static_cast<std::size_t>(y), row));
  });
  return to;
}

// Puts the numbers of a level into 16 bits. A mean goes no further than what it is of: only the first level can fail.
void halve_numbers(MipPyramid::Level& level) {
  const std::size_t row = 4 * static_cast<std::size_t>(level.width);
  level.half_rgba.resize(level.rgba.size());
  tbb::parallel_for(0, level.height, [&](int y) {
    const std::size_t first = row * static_cast<std::size_t>(y);
    for (std::size_t i = first; i < first + row; ++i) {
      const float n = level.rgba[i];
      if (std::abs(n) > kernels::most_half)
        throw NodeError(
            "beyond_half",
            fmt::format("texel {},{} of the picture holds {:.6g}, and half goes to {}: store it in single",
                        (i - first) / 4, y, n, kernels::most_half),
            at_param("storage"));
      level.half_rgba[i] = kernels::to_half(n);
    }
  });
  level.rgba = {};
}

}  // namespace

Ref<Texture> make_texture(const Raster& picture, const TextureOptions& options, Context& ctx) {
  const Frame& f = picture.frame();
  const Source source = find_source(f);
  const std::string_view space = f.color_space.empty() ? linear_rec709 : f.color_space;
  const ColorConversion conversion = ColorConfig::open({})->conversion(space, linear_rec709);
  MipPyramid pyramid{
      .levels = {}, .wrap_u = options.wrap_u, .wrap_v = options.wrap_v, .alpha_cutoff = options.alpha_cutoff};
  pyramid.levels.push_back(first_level(picture, source, conversion, options.opaque));
  while (options.pyramid && (pyramid.levels.back().width > 1 || pyramid.levels.back().height > 1)) {
    ctx.poll();
    pyramid.levels.push_back(next_level(pyramid.levels.back()));
    if (options.half) halve_numbers(*std::prev(pyramid.levels.end(), 2));
  }
  if (options.half) halve_numbers(pyramid.levels.back());
  return std::make_shared<const Texture>(std::move(pyramid));
}

}  // namespace frustum
