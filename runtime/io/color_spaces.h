// The spaces of the embedded colour configuration.
#pragma once

#include "nodes/kernels/transfer.h"

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace frustum {

struct ColorSpace {
  std::string_view name, doc;
  std::string_view primaries;  // name of the linear space with the same primaries; empty for xyz_d65 and raw
  kernels::Curve curve = kernels::Curve::linear;
  std::vector<std::string_view> aliases;
  bool data = false;
};

std::span<const ColorSpace> embedded_spaces();
const ColorSpace* find_embedded(std::string_view name_or_alias);  // in any case; null where there is none

using Matrix3 = std::array<double, 9>;  // row by row

// Linear values of the space to CIE XYZ relative to D65; Bradford-adapted where the white is another.
// xyz_d65 gives the identity.
Matrix3 xyz_from_linear(const ColorSpace&);
Matrix3 product(const Matrix3& a, const Matrix3& b);
Matrix3 inverse(const Matrix3&);  // of one that has an inverse

// The conversion between two spaces that are not data.
kernels::ColorMap color_map(const ColorSpace& from, const ColorSpace& to);

}  // namespace frustum
