// Log-log plots as SVG.
//
// Drawn here and not by a plotting library: the pages are read without scripts too, print well, and need
// exact decade ticks, stepped fronts and guide lines of given slopes, which canvas libraries for time series
// leave to plug-ins (docs/decisions/0004-sweep-plots.md).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace frustum {

struct PlotPoint {
  double x = 0, y = 0;    // y 0: drawn on the floor as "exact"
  std::string title;      // shown while the pointer rests on it
  std::size_t index = 0;  // of the point in the page's table
  bool ring = false;      // singled out
};

struct PlotSeries {
  std::string name;
  std::size_t color = 0;  // one of ten
  std::vector<PlotPoint> points;
  bool joined = true;  // by a line, in this order
};

// y = 10^intercept x^slope, over the whole width.
struct PlotLine {
  double slope = 0, intercept = 0;
  bool dashed = false;
};

struct Plot {
  int width = 920, height = 470;
  std::string x_label, y_label, title;
  std::vector<std::string> categories;  // where x is 0, 1, 2 ... and no number
  std::vector<PlotSeries> series;
  std::vector<PlotPoint> front;  // a staircase, by rising x
  std::vector<PlotLine> lines;
};

std::string svg(const Plot&);
std::string escaped(std::string_view text);  // for HTML

}  // namespace frustum
