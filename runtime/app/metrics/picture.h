// A raster as a picture to be looked at: linear light, one value a pixel.
#pragma once

#include "runtime/core/raster.h"
#include "runtime/io/color.h"

#include <array>
#include <string>
#include <vector>

namespace frustum {

// One plane of numbers, row by row.
struct Grid {
  int width = 0, height = 0;
  std::vector<double> values;

  Grid() = default;
  Grid(int w, int h)
      : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  double& at(int x, int y) { return values[index(x, y)]; }
  double at(int x, int y) const { return values[index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

// The mean, summed in order; 0 of none. NaN where a value is.
double mean(const Grid&);

// Linear Rec.709, premultiplied by alpha (that is: over black).
struct Picture {
  std::array<Grid, 3> rgb;
  int width() const { return rgb[0].width; }
  int height() const { return rgb[0].height; }
  bool has_nan() const;
};

// The planes R, G, B, or Y three times; empty where there are neither.
std::vector<int> color_planes(const Frame&);

// Why a raster is no picture, or an empty text: it needs the planes R, G, B (or Y) and one value a pixel.
std::string no_picture(const Frame&);

// From the raster's colour space, where it names none from linear Rec.709, to that. Throws
// NodeError("unknown_color_space").
ColorConversion to_linear_light(const Raster&);

// Converts from the raster's colour space; without one, it is linear Rec.709. Throws
// NodeError("unknown_color_space").
Picture picture_of(const Raster&);

}  // namespace frustum
