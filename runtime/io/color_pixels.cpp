#include "runtime/io/color_pixels.h"

#include "runtime/io/color_spaces.h"

namespace frustum {

std::string linear_space_of(std::string_view space) {
  const ColorSpace& known = *find_embedded(ColorConfig::embedded().resolve(space));
  return std::string(known.primaries.empty() ? known.name : known.primaries);
}

std::array<double, 3> luminance_weights(std::string_view linear_space) {
  const Matrix3 m = xyz_from_linear(*find_embedded(linear_space));
  return {m[3], m[4], m[5]};
}

}  // namespace frustum
