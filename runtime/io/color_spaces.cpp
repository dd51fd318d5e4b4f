#include "runtime/io/color_spaces.h"

#include "nodes/kernels/matrix.h"
#include "runtime/io/primaries.h"

#include <algorithm>
#include <cmath>

namespace frustum {
namespace {

using kernels::Curve;
using Vector3 = std::array<double, 3>;

bool same_text(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

Vector3 times(const Matrix3& m, const Vector3& v) {
  Vector3 out{};
  for (std::size_t r = 0; r < 3; ++r) out[r] = m[3 * r] * v[0] + m[3 * r + 1] * v[1] + m[3 * r + 2] * v[2];
  return out;
}

Vector3 xyz_of(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

// Columns are the XYZ of the primaries, scaled so that (1, 1, 1) is the white (SMPTE RP 177-1993).
Matrix3 native_xyz_from_rgb(const Primaries& p) {
  Matrix3 columns{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double x = p.xy[2 * c], y = p.xy[2 * c + 1];
    columns[c] = x, columns[3 + c] = y, columns[6 + c] = 1 - x - y;
  }
  const Vector3 scale = times(inverse(columns), xyz_of(p.xy[6], p.xy[7]));
  for (std::size_t i = 0; i < 9; ++i) columns[i] *= scale[i % 3];
  return columns;
}

// Bradford: XYZ relative to `white` to XYZ relative to D65 (Lam 1985; ICC.1:2010 annex E).
Matrix3 adaptation(const Vector3& white) {
  constexpr Matrix3 bradford{0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296};
  const Vector3 from = times(bradford, white), to = times(bradford, xyz_of(d65_x, d65_y));
  const Matrix3 scale{to[0] / from[0], 0, 0, 0, to[1] / from[1], 0, 0, 0, to[2] / from[2]};
  return product(inverse(bradford), product(scale, bradford));
}

}  // namespace

// Each entry is the exact sum of the three products, rounded: a picture that goes around the spaces and home
// drifts by the rounding of the matrices (hard case COL-02).
Matrix3 product(const Matrix3& a, const Matrix3& b) {
  using kernels::plus, kernels::two_product;
  Matrix3 out{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      out[3 * r + c] = plus(plus(two_product(a[3 * r], b[c]), two_product(a[3 * r + 1], b[3 + c])),
                            two_product(a[3 * r + 2], b[6 + c]))
                           .hi;
  return out;
}

Matrix3 inverse(const Matrix3& m) {
  kernels::Square<3> columns;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) columns[c][r] = m[static_cast<std::size_t>(3 * r + c)];
  const auto inverted = kernels::inverse<3>(columns).value().matrix;
  Matrix3 out{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out[static_cast<std::size_t>(3 * r + c)] = inverted[c][r];
  return out;
}

std::span<const ColorSpace> embedded_spaces() {
  static const std::vector<ColorSpace> spaces{
      {"xyz_d65", "CIE XYZ 1931, white D65.", "", Curve::linear, {"cie_xyz_d65", "xyz", "CIE-XYZ-D65"}},
      {"lin_rec709",
       "Linear light, Rec.709 primaries.",
       "lin_rec709",
       Curve::linear,
       {"linear", "lin_srgb", "linear_rec709", "linear_srgb", "scene_linear", "lin_rec709_srgb",
        "Linear Rec.709 (sRGB)"}},
      {"srgb",
       "sRGB, IEC 61966-2-1.",
       "lin_rec709",
       Curve::srgb,
       {"sRGB - Texture", "srgb_texture", "srgb_tx", "srgb_rec709", "sRGB Encoded Rec.709 (sRGB)"}},
      {"rec709",
       "Rec.709 primaries, BT.709 camera curve.",
       "lin_rec709",
       Curve::rec709,
       {"Rec.709", "bt709", "bt.709"}},
      {"lin_rec2020",
       "Linear light, Rec.2020 primaries.",
       "lin_rec2020",
       Curve::linear,
       {"linear_rec2020", "lin_bt2020", "Linear Rec.2020"}},
      {"rec2020",
       "Rec.2020 primaries, BT.2020 camera curve.",
       "lin_rec2020",
       Curve::rec709,
       {"Rec.2020", "bt2020", "bt.2020"}},
      {"lin_p3d65",
       "Linear light, P3 primaries, white D65.",
       "lin_p3d65",
       Curve::linear,
       {"linear_p3", "lin_display_p3", "linear_display_p3", "linear_p3d65", "Linear P3-D65"}},
      {"display_p3",
       "Display P3: P3 primaries, white D65, sRGB curve.",
       "lin_p3d65",
       Curve::srgb,
       {"Display P3", "p3", "srgb_p3d65", "srgb_display_p3"}},
      {"lin_adobergb",
       "Linear light, Adobe RGB (1998) primaries.",
       "lin_adobergb",
       Curve::linear,
       {"linear_adobe_rgb", "lin_adobe_rgb", "linear_adobergb", "Linear AdobeRGB"}},
      {"adobe_rgb",
       "Adobe RGB (1998).",
       "lin_adobergb",
       Curve::adobe_rgb,
       {"AdobeRGB", "Adobe RGB", "Adobe RGB (1998)"}},
      {"lin_ap0",
       "ACES2065-1: linear light, AP0 primaries.",
       "lin_ap0",
       Curve::linear,
       {"ACES2065-1", "aces2065_1", "ap0", "aces", "lin_ap0_scene"}},
      {"lin_ap1",
       "ACEScg: linear light, AP1 primaries.",
       "lin_ap1",
       Curve::linear,
       {"ACEScg", "ap1", "lin_ap1_scene"}},
      {"raw", "Data that is no colour.", "", Curve::linear, {"data", "Utility - Raw"}, true},
  };
  return spaces;
}

const ColorSpace* find_embedded(std::string_view name) {
  for (const ColorSpace& s : embedded_spaces())
    if (same_text(name, s.name) ||
        std::any_of(s.aliases.begin(), s.aliases.end(), [&](auto alias) { return same_text(name, alias); }))
      return &s;
  return nullptr;
}

Matrix3 xyz_from_linear(const ColorSpace& space) {
  const auto p = std::find_if(known_primaries.begin(), known_primaries.end(),
                              [&](const Primaries& known) { return known.linear_space == space.primaries; });
  if (p == known_primaries.end()) return {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const Matrix3 native = native_xyz_from_rgb(*p);
  if (p->xy[6] == d65_x && p->xy[7] == d65_y) return native;
  return product(adaptation(xyz_of(p->xy[6], p->xy[7])), native);
}

bool rows_sum_to_one(const Matrix3& m) {
  for (std::size_t i = 0; i < 9; i += 3)
    if (std::fabs(m[i] + m[i + 1] + m[i + 2] - 1) > 1e-12) return false;
  return true;
}

kernels::ColorMap color_map(const ColorSpace& from, const ColorSpace& to) {
  kernels::ColorMap map{.from = from.curve, .to = to.curve};
  if (from.primaries == to.primaries) {
    if (from.curve == to.curve) map.from = map.to = Curve::linear;
    return map;
  }
  map.same_primaries = false;
  map.matrix = product(inverse(xyz_from_linear(to)), xyz_from_linear(from));
  // Between spaces whose whites are one after adaptation the rows sum to 1, up to the rounding of the products.
  map.keeps_grey = !from.primaries.empty() && !to.primaries.empty() && rows_sum_to_one(map.matrix);
  return map;
}

}  // namespace frustum
