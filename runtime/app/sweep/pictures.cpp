#include "runtime/app/sweep/pictures.h"

#include "nodes/kernels/transfer.h"
#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/app/metrics/metrics.h"
#include "runtime/app/metrics/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

// Encoded sRGB values, one value a pixel.
using Encoded = std::array<Grid, 3>;

Encoded colors(const Raster& raster) {
  Picture p = picture_of(raster);
  for (Grid& g : p.rgb)
    for (double& v : g.values)
      v = kernels::encode(kernels::Curve::srgb, std::isnan(v) ? 0.0 : std::clamp(v, 0.0, 1.0));
  return p.rgb;
}

std::array<double, 3> color_of_id(std::uint32_t id) {
  if (id == std::numeric_limits<std::uint32_t>::max()) return {0.1, 0.1, 0.1};
  const std::uint32_t h = (id + 1) * 2654435761u;
  return {0.3 + 0.7 * (h >> 24) / 255.0, 0.3 + 0.7 * (h >> 16 & 255) / 255.0,
          0.3 + 0.7 * (h >> 8 & 255) / 255.0};
}

// The first plane: numbers in grey, ids in colours.
Encoded first_plane(const Raster& raster) {
  const Frame& f = raster.frame();
  Encoded out;
  out.fill(Grid(f.window.width(), f.window.height()));
  const bool ids = f.planes.front().kind == PlaneKind::u32;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int y = f.window.y0; !ids && y < f.window.y1; ++y)
    for (int x = f.window.x0; x < f.window.x1; ++x)
      if (const double v = raster.value(0, 0, x, y); std::isfinite(v))
        low = std::min(low, v), high = std::max(high, v);
  for (int y = f.window.y0; y < f.window.y1; ++y)
    for (int x = f.window.x0; x < f.window.x1; ++x) {
      const double v = raster.value(0, 0, x, y),
                   grey = high > low && std::isfinite(v) ? (v - low) / (high - low) : 0;
      const auto c = ids ? color_of_id(static_cast<std::uint32_t>(v)) : std::array{grey, grey, grey};
      for (std::size_t k = 0; k < 3; ++k) out[k].at(x - f.window.x0, y - f.window.y0) = c[k];
    }
  return out;
}

Encoded error_colors(const Raster& raster, const Raster& reference) {
  const auto map = error_map(raster, reference);
  const auto largest = std::max_element(map.begin(), map.end());
  const double scale = largest == map.end() || *largest == 0 ? 1 : static_cast<double>(*largest);
  Encoded out;
  out.fill(Grid(raster.frame().window.width(), raster.frame().window.height()));
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double e = static_cast<double>(map[i]);
    const auto c = heat(std::isinf(e) ? 1 : std::sqrt(e / scale));  // the root shows small errors too
    for (std::size_t k = 0; k < 3; ++k) out[k].values[i] = c[k];
  }
  return out;
}

// Smaller by a whole factor: the mean of the pixels (or the largest, which keeps lone errors visible).
Grid shrunk(const Grid& g, int factor, bool largest) {
  Grid out((g.width + factor - 1) / factor, (g.height + factor - 1) / factor);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      double sum = 0, max = 0;
      int n = 0;
      for (int v = y * factor; v < std::min(g.height, (y + 1) * factor); ++v)
        for (int u = x * factor; u < std::min(g.width, (x + 1) * factor); ++u, ++n)
          sum += g.at(u, v), max = std::max(max, g.at(u, v));
      out.at(x, y) = largest ? max : sum / n;
    }
  return out;
}

void save(const std::filesystem::path& path, const Encoded& rgb, bool largest) {
  const int factor = (rgb[0].width + thumbnail_width - 1) / thumbnail_width;
  Raster out(
      Frame{.window = {0, 0, (rgb[0].width + factor - 1) / factor, (rgb[0].height + factor - 1) / factor},
            .planes = {{"R"}, {"G"}, {"B"}},
            .color_space = "srgb"});
  for (int c = 0; c < 3; ++c) {
    const Grid g = shrunk(rgb[static_cast<std::size_t>(c)], factor, largest);
    for (int y = 0; y < g.height; ++y)
      for (int x = 0; x < g.width; ++x) out.view().row<float>(c, 0, y)[x] = static_cast<float>(g.at(x, y));
  }
  std::filesystem::create_directories(path.parent_path());
  save_raster(out, path.string());
}

}  // namespace

void save_pictures(const std::filesystem::path& folder, const std::string& name, const Buffer& buffer,
                   const Buffer* reference) {
  if (!buffer.type().is_pixels()) return;
  const Raster& raster = buffer.type().raster(buffer.data());
  if (raster.frame().planes.empty() || raster.frame().window.empty()) return;
  save(folder / (name + ".png"), no_picture(raster.frame()).empty() ? colors(raster) : first_plane(raster),
       false);
  if (reference != nullptr)
    save(folder / (name + ".error.png"), error_colors(raster, reference->type().raster(reference->data())),
         true);
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
