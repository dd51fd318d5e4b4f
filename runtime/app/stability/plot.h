// A log-log line plot as SVG, for the pages of the hard cases.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace frustum::stability {

struct Series {
  std::string name;
  std::string color;                              // of SVG
  std::vector<std::pair<double, double>> points;  // (log2 x, error); an infinite error lies on the upper rim
};

struct Plot {
  std::string title, x_label, y_label;
  std::vector<Series> series;
  double bound = 0;  // drawn as a dashed line; 0: none
};

// The y axis is logarithmic to base 10, from 1e-2 to 1e9; x is linear in the given numbers. The same text on
// every machine for the same points.
std::string svg_text(const Plot&);

}  // namespace frustum::stability
