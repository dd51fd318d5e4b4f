#include "runtime/app/metrics/picture.h"

#include "runtime/buffers/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace frustum {

std::vector<int> color_planes(const Frame& f) {
  std::vector<int> out;
  for (const char* name : {"R", "G", "B"})
    if (const auto p = f.find(name)) out.push_back(*p);
  if (out.size() == 3) return out;
  if (const auto y = f.find("Y")) return {*y, *y, *y};
  return {};
}

ColorConversion to_linear_light(const Raster& raster) {
  const std::string& space = raster.frame().color_space;
  const ColorConfig& config = ColorConfig::embedded();
  return config.conversion(space.empty() ? std::string(linear_rec709) : config.resolve(space), linear_rec709);
}

double mean(const Grid& g) {
  if (g.values.empty()) return 0;
  return std::accumulate(g.values.begin(), g.values.end(), 0.0) / static_cast<double>(g.values.size());
}

bool Picture::has_nan() const {
  return std::any_of(rgb.begin(), rgb.end(), [](const Grid& g) {
    return std::any_of(g.values.begin(), g.values.end(), [](double v) { return std::isnan(v); });
  });
}

std::string no_picture(const Frame& f) {
  if (f.samples() != 1) return fmt::format("it has {} samples a pixel", f.samples());
  if (color_planes(f).empty()) return "it has no planes R, G, B or Y";
  return {};
}

Picture picture_of(const Raster& raster) {
  const Frame& f = raster.frame();
  const auto planes = color_planes(f);
  const auto alpha = f.alpha == Alpha::straight ? f.find("A") : std::nullopt;
  Picture p;
  p.rgb.fill(Grid(f.window.width(), f.window.height()));
  const ColorConversion to_linear = to_linear_light(raster);
  for (int y = 0; y < p.height(); ++y) {
    std::array<double*, 3> row{};
    for (std::size_t c = 0; c < 3; ++c) {
      row[c] = p.rgb[c].values.data() + p.rgb[c].index(0, y);
      for (int x = 0; x < p.width(); ++x)
        row[c][x] = raster.value(planes[c], 0, f.window.x0 + x, f.window.y0 + y);
    }
    to_linear.apply(row[0], row[1], row[2], static_cast<std::size_t>(p.width()));
    for (int x = 0; alpha && x < p.width(); ++x)
      for (double* channel : row) channel[x] *= raster.value(*alpha, 0, f.window.x0 + x, f.window.y0 + y);
  }
  return p;
}

}  // namespace frustum
