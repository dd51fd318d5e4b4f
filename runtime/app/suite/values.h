// The numbers of a buffer of any kind, as named series of rows: what is compared, probed and counted.
#pragma once

#include "runtime/app/suite/check.h"
#include "runtime/buffers/column.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

struct Series {
  std::string name;                   // of a plane or a column
  NumberKind kind = NumberKind::f64;  // as stored, which says what an ulp is
  int width = 1;                      // numbers a row
  std::vector<double> values;         // row by row; every kind fits a double exactly
  std::size_t rows() const { return values.size() / static_cast<std::size_t>(width); }
};

struct Values {
  std::vector<Series> series;
  std::optional<Rect> window;  // of pixels: rows are samples x rows x columns
  int samples = 1;

  const Series* find(std::string_view name) const;
  std::vector<std::string> names() const;
  // "R at 3,4 sample 1", "position, row 17".
  std::string place(const Series&, std::size_t value) const;
};

// Planes of pixels, columns of a mesh, otherwise the columns of numbers of the table form. Throws
// NodeError("no_numbers") for a kind that has none of these. Cost: 8 bytes a number.
Values values_of(const Buffer&);
Values values_of(const Raster&);

// Numbers between neighbours: how many steps of `kind` lie from a to b; infinite where either is NaN. Real
// kinds count by their ordered bits, so that -0 and +0 are 0 apart; integers by their difference.
double steps_between(double a, double b, NumberKind kind);

// Whether a is as close to b, which is what was expected, as is asked. NaN is close to nothing.
bool close(double a, double b, const Closeness&, NumberKind);

}  // namespace frustum
