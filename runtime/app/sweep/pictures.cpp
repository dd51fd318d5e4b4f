#include "runtime/app/sweep/pictures.h"

#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/app/metrics/metrics.h"
#include "runtime/app/metrics/picture.h"
#include "runtime/app/png.h"
#include "runtime/app/sweep/srgb_codes.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace frustum {
namespace {

// Values of a colour map from black over red and yellow to white; like inferno, but its ends are black and
// white.
std::array<double, 3> heat(double t) {
  constexpr std::array<std::array<double, 3>, 6> stops{{{0, 0, 0},
                                                        {0.26, 0.04, 0.41},
                                                        {0.58, 0.15, 0.40},
                                                        {0.87, 0.32, 0.23},
                                                        {0.99, 0.65, 0.04},
                                                        {1, 1, 0.9}}};
  const double at = std::clamp(t, 0.0, 1.0) * (stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  std::array<double, 3> out{};
  for (std::size_t c = 0; c < 3; ++c)
    out[c] = stops[i][c] + (at - static_cast<double>(i)) * (stops[i + 1][c] - stops[i][c]);
  return out;
}

// Encoded sRGB values of a thumbnail, one value a pixel.
using Encoded = std::array<Grid, 3>;

// A thumbnail's size: smaller by a whole factor.
struct Reduction {
  int factor, width, height;
};
Reduction reduction_of(const Rect& window) {
  const int factor = (window.width() + thumbnail_width - 1) / thumbnail_width;
  return {factor, (window.width() + factor - 1) / factor, (window.height() + factor - 1) / factor};
}

// Pixels of the original in one of the thumbnail: fewer at the right and lower border.
double area(const Rect& window, const Reduction& r, int x, int y) {
  return std::min(r.factor, window.width() - x * r.factor) *
         std::min(r.factor, window.height() - y * r.factor);
}

// One row of three planes as linear light that a display can show, multiplied by alpha, and what alpha leaves
// of what is behind it.
class LightRows {
 public:
  struct Row {
    std::array<std::vector<float>, 3> rgb;
    std::vector<float> alpha, behind;  // behind: 0 to 1; of a picture without alpha 0
  };

  explicit LightRows(const Raster& raster)
      : raster_(raster),
        planes_(color_planes(raster.frame())),
        alpha_(raster.frame().alpha != Alpha::none ? raster.frame().find("A") : std::nullopt),
        to_linear_(to_linear_light(raster)) {}

  void read(int y, Row& row) const {
    for (std::size_t c = 0; c < 3; ++c) read_plane(planes_[c], y, row.rgb[c]);
    if (alpha_) read_plane(*alpha_, y, row.alpha);
    const std::size_t width = row.rgb[0].size();
    // Encoded values were multiplied by alpha as they are: color.convert does the same.
    const bool divided = alpha_ && raster_.frame().alpha == Alpha::premultiplied && !to_linear_.linear();
    if (divided)
      for (std::vector<float>& plane : row.rgb)
        for (std::size_t i = 0; i < width; ++i)
          if (row.alpha[i] > 0) plane[i] /= row.alpha[i];
    to_linear_.apply(row.rgb[0].data(), row.rgb[1].data(), row.rgb[2].data(), width);
    const bool straight = alpha_ && raster_.frame().alpha == Alpha::straight;
    for (std::vector<float>& plane : row.rgb)
      for (std::size_t i = 0; i < width; ++i) {
        const bool multiply = straight || (divided && row.alpha[i] > 0);
        const float v = multiply ? plane[i] * row.alpha[i] : plane[i];
        plane[i] = std::isnan(v) ? 0 : std::clamp(v, 0.0f, 1.0f);
      }
    row.behind.assign(width, 0);
    for (std::size_t i = 0; alpha_ && i < width; ++i)
      row.behind[i] = row.alpha[i] < 1 ? 1 - std::max(row.alpha[i], 0.0f) : 0;
  }

 private:
  void read_plane(int plane, int y, std::vector<float>& out) const {
    const Rect& window = raster_.frame().window;
    out.resize(static_cast<std::size_t>(window.width()));
    if (raster_.frame().planes[static_cast<std::size_t>(plane)].kind == PlaneKind::f32)
      std::copy_n(raster_.view().row<float>(plane, 0, window.y0 + y), out.size(), out.data());
    else
      for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = static_cast<float>(raster_.value(plane, 0, window.x0 + static_cast<int>(i), window.y0 + y));
  }

  const Raster& raster_;
  std::vector<int> planes_;
  std::optional<int> alpha_;
  ColorConversion to_linear_;
};

// The light of a checkerboard behind a picture, so that transparent is told from black: the greys 153 and 204
// of an sRGB display. A large picture has some 48 squares along its longer side, a small one a square a pixel.
double checkerboard(const Reduction& r, int x, int y) {
  const int square = (std::max(r.width, r.height) + 47) / 48;
  return ((x / square + y / square) & 1) != 0 ? 0.6038 : 0.3185;
}

// The mean light of the pixels over a checkerboard, encoded.
Encoded colors(const Raster& raster) {
  const Rect& window = raster.frame().window;
  const Reduction r = reduction_of(window);
  const LightRows light(raster);
  static const SrgbCodes code_of;
  Encoded out;
  out.fill(Grid(r.width, r.height));
  tbb::parallel_for(0, r.height, [&](int y) {
    LightRows::Row row;
    std::vector<double> behind(static_cast<std::size_t>(r.width));
    for (int v = y * r.factor; v < std::min(window.height(), (y + 1) * r.factor); ++v) {
      light.read(v, row);
      for (int x = 0; x < window.width(); ++x) {
        const auto i = static_cast<std::size_t>(x);
        for (std::size_t c = 0; c < 3; ++c) out[c].at(x / r.factor, y) += static_cast<double>(row.rgb[c][i]);
        behind[static_cast<std::size_t>(x / r.factor)] += static_cast<double>(row.behind[i]);
      }
    }
    for (int x = 0; x < r.width; ++x) {
      const double back = behind[static_cast<std::size_t>(x)] * checkerboard(r, x, y);
      for (Grid& g : out) g.at(x, y) = code_of((g.at(x, y) + back) / area(window, r, x, y)) / 255.0;
    }
  });
  return out;
}

std::array<double, 3> color_of_id(std::uint32_t id) {
  if (id == std::numeric_limits<std::uint32_t>::max()) return {0.1, 0.1, 0.1};
  const std::uint32_t h = (id + 1) * 2654435761u;
  return {0.3 + 0.7 * (h >> 24) / 255.0, 0.3 + 0.7 * (h >> 16 & 255) / 255.0,
          0.3 + 0.7 * (h >> 8 & 255) / 255.0};
}

// Of each pixel of the thumbnail the first of the original: numbers in grey, ids in colours.
Encoded first_plane(const Raster& raster) {
  const Frame& f = raster.frame();
  const Reduction r = reduction_of(f.window);
  Encoded out;
  out.fill(Grid(r.width, r.height));
  const bool ids = f.planes.front().kind == PlaneKind::u32;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto value = [&](int x, int y) {
    return raster.value(0, 0, f.window.x0 + x * r.factor, f.window.y0 + y * r.factor);
  };
  for (int y = 0; !ids && y < r.height; ++y)
    for (int x = 0; x < r.width; ++x)
      if (const double v = value(x, y); std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  for (int y = 0; y < r.height; ++y)
    for (int x = 0; x < r.width; ++x) {
      const double v = value(x, y), grey = high > low && std::isfinite(v) ? (v - low) / (high - low) : 0;
      const auto c = ids ? color_of_id(static_cast<std::uint32_t>(v)) : std::array{grey, grey, grey};
      for (std::size_t k = 0; k < 3; ++k) out[k].at(x, y) = c[k];
    }
  return out;
}

// The largest error in each pixel of the thumbnail, so that lone ones stay visible.
Encoded error_colors(const Raster& raster, const Raster& reference) {
  const Rect& window = raster.frame().window;
  const Reduction r = reduction_of(window);
  const auto map = error_map(raster, reference);
  const auto largest = std::max_element(map.begin(), map.end());
  const double scale = largest == map.end() || *largest == 0 ? 1 : static_cast<double>(*largest);
  Grid worst(r.width, r.height);
  tbb::parallel_for(0, r.height, [&](int y) {
    for (int v = y * r.factor; v < std::min(window.height(), (y + 1) * r.factor); ++v) {
      const float* row = map.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(window.width());
      for (int x = 0; x < window.width(); ++x) {
        double& e = worst.at(x / r.factor, y);
        e = std::max(e, static_cast<double>(row[x]));
      }
    }
  });
  Encoded out;
  out.fill(Grid(r.width, r.height));
  for (std::size_t i = 0; i < worst.values.size(); ++i) {
    const double e = worst.values[i];
    const auto c = heat(std::isinf(e) ? 1 : std::sqrt(e / scale));  // the root shows small errors too
    for (std::size_t k = 0; k < 3; ++k) out[k].values[i] = c[k];
  }
  return out;
}

void save(const std::filesystem::path& path, const Encoded& rgb) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < rgb[0].values.size(); ++i)
    for (const Grid& plane : rgb)
      bytes.push_back(static_cast<std::uint8_t>(std::clamp(plane.values[i], 0.0, 1.0) * 255 + 0.5));
  write_text(path, png_file(rgb[0].width, rgb[0].height, bytes));
}

}  // namespace

void save_pictures(const std::filesystem::path& folder, const std::string& name, const Buffer& buffer,
                   const Buffer* reference) {
  if (!buffer.type().is_pixels()) return;
  const Raster& raster = buffer.type().raster(buffer.data());
  if (raster.frame().planes.empty() || raster.frame().window.empty()) return;
  const auto picture = [&] {
    save(folder / (name + ".png"), no_picture(raster.frame()).empty() ? colors(raster) : first_plane(raster));
  };
  if (reference == nullptr) return picture();
  tbb::parallel_invoke(picture, [&] {
    save(folder / (name + ".error.png"), error_colors(raster, reference->type().raster(reference->data())));
  });
}

std::string data_uri(const std::filesystem::path& png) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(png, none)) return {};
  const std::string bytes = read_text(png);
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out = "data:image/png;base64,";
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

}  // namespace frustum
