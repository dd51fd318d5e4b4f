// Colours of a picture, pixel by pixel: without their coverage and in the space that is wanted.
#pragma once

#include "runtime/buffers/image.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/io/color.h"

#include <fmt/format.h>

#include <array>
#include <span>
#include <utility>

namespace frustum {

// The colour space of a picture: lin_rec709 where it names none.
inline std::string color_space_of(const Frame& frame) {
  return frame.color_space.empty() ? std::string(linear_rec709) : frame.color_space;
}

// Where the three or four numbers of a colour come from, and what becomes of coverage.
struct ColorPixels {
  Precision precision = Precision::single;
  std::array<RealPlane, 4> color = {};
  RealPlane alpha = {};                            // none: opaque
  bool divides = false;                            // the colours are premultiplied by alpha
  bool multiplies = false;                         // the result is to be
  std::optional<ColorConversion> conversion = {};  // none: the numbers as they are

  // Names the planes to be read. The result has the coverage of the picture.
  static ColorPixels of(const Tiled<Image>& image, std::initializer_list<const char*> names,
                        Precision precision) {
    const Frame& frame = image.frame();
    ColorPixels p{.precision = precision};
    std::size_t c = 0;
    for (const char* name : names) p.color[c++] = read_real(image, name, precision);
    if (frame.find("A")) p.alpha = read_real(image, "A", precision);
    p.divides = p.multiplies = p.alpha && frame.alpha == Alpha::premultiplied;
    return p;
  }

  // Colours in `to`, a space of the embedded configuration, as the picture's own has to be: a picture in a space
  // of another configuration has to be converted first. Throws NodeError("unknown_color_space").
  void convert(const Frame& frame, std::string_view to) {
    const ColorConversion c = ColorConfig::embedded().conversion(color_space_of(frame), to);
    if (!c.identity()) conversion = c;
  }
};

// The frame of a result: the pixels and samples of `from`, real planes of these names, and A where `from` has it.
inline Frame color_frame(const Frame& from, std::initializer_list<const char*> names, Precision precision) {
  Frame to = from;
  to.planes.clear();
  for (const char* name : names) to.planes.push_back({name, real_kind(precision)});
  if (from.find("A")) to.planes.push_back({"A", real_kind(precision)});
  return to;
}

namespace detail {

// Coverage below this is none: quotients of values up to 2^63 stay finite in float (hard case ZBF-09).
inline constexpr double least_coverage = 0x1p-64;

// One row of straight colours in the wanted space, in `rows`.
template <class R, std::size_t m>
void gather_colors(const ColorPixels& p, const Tile& in, int sample, int y, const R* alpha,
                   const std::array<std::span<R>, m>& rows, std::span<R> scratch) {
  for (std::size_t c = 0; c < m; ++c) {
    const R* from = real_row<R>(in, p.color[c], sample, y, scratch);
    for (std::size_t x = 0; x < rows[c].size(); ++x)
      rows[c][x] = p.divides && alpha[x] >= R(least_coverage) ? from[x] / alpha[x] : from[x];
  }
  if (p.conversion) p.conversion->apply(rows[0].data(), rows[1].data(), rows[2].data(), rows[0].size());
}

}  // namespace detail

// Fills the first planes of `out` with f(colour) of every pixel, n numbers of m, and its plane A with the
// coverage of `in`. Premultiplied colours are divided by their alpha first, and the result is multiplied again;
// light without coverage (alpha below 2^-64), such as a glow, goes as it is, and what shows nothing at all (0
// everywhere) gives a premultiplied result of 0. Nothing is done where `out` is read by nobody.
template <class R, std::size_t m, std::size_t n, class F>
void fill_colors(const ColorPixels& p, const Tile& in, const Tile& out, Arena& arena, F f) {
  if (out.empty()) return;
  const Tile from = in.part(out.rect());
  const auto width = static_cast<std::size_t>(out.rect().width());
  std::array<std::span<R>, m> rows;
  for (auto& row : rows) row = arena.take<R>(width);
  const auto scratch = arena.take<R>(width), coverage = arena.take<R>(width);
  for (int sample = 0; sample < out.samples(); ++sample)
    for (int y = out.rect().y0; y < out.rect().y1; ++y) {
      const R* alpha = real_row<R>(from, p.alpha, sample, y, coverage);
      detail::gather_colors<R, m>(p, from, sample, y, alpha, rows, scratch);
      std::array<R*, n> to{};
      for (std::size_t k = 0; k < n; ++k) to[k] = out_row<R>(out, static_cast<int>(k), sample, y);
      for (std::size_t x = 0; x < width; ++x) {
        std::array<R, m> color;
        for (std::size_t c = 0; c < m; ++c) color[c] = rows[c][x];
        std::array<R, n> result = f(color);
        if (p.multiplies) {
          const bool covers = alpha[x] >= R(detail::least_coverage);
          const bool nothing = p.divides && alpha[x] == 0 && color == std::array<R, m>{};
          for (R& v : result) v = nothing ? R(0) : covers ? v * alpha[x] : v;
        }
        for (std::size_t k = 0; k < n; ++k)
          if (to[k] != nullptr) to[k][x] = result[k];
      }
      if (p.alpha && out.frame().planes.size() > n)
        if (R* const a = out_row<R>(out, static_cast<int>(n), sample, y)) std::copy_n(alpha, width, a);
    }
}

// Fills the one plane of `out` with 1 where f(colour) holds and 0 elsewhere. Colours as above.
template <class R, class F>
void fill_flags(ColorPixels p, const Tile& in, const Tile& out, Arena& arena, F f) {
  p.multiplies = false;
  fill_colors<R, 3, 1>(p, in, out, arena,
                       [&](const std::array<R, 3>& v) { return std::array<R, 1>{f(v) ? R(1) : R(0)}; });
}

// The linear space with the primaries of an embedded one: of itself where it is linear, xyz_d65 or data. Throws
// NodeError("unknown_color_space").
std::string linear_space_of(std::string_view space);

// Luminances of the primaries of a linear embedded space, which are the shares of R, G and B in Y; their sum is 1.
// Those of xyz_d65 are 0, 1, 0, and those of data too.
std::array<double, 3> luminance_weights(std::string_view linear_space);

}  // namespace frustum
