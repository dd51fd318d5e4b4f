// Colour spaces by name, and the way from one to another. The only door to OpenColorIO.
#pragma once

#include "runtime/core/frame.h"
#include "runtime/core/param.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

class NodeType;

// A way between two spaces that is ready to be applied; copies share it. Safe to use from many threads.
class ColorConversion {
 public:
  // Whether it changes nothing; whether it is a matrix, which needs no dividing by alpha.
  bool identity() const;
  bool linear() const;
  // Whether OpenColorIO computes it: then its bits may change with the processor, and doubles pass through
  // floats.
  bool foreign() const;

  // Converts n pixels in place; the rows do not overlap. Colours may lie outside [0, 1]; NaN stays NaN.
  // Not foreign: exact curves (IEC 61966-2-1, BT.709, BT.2020, Adobe RGB 1998) and a matrix from the
  // primaries, the same bits on every processor; relative error of a curve below 4e-7 in float, 1e-15 in
  // double.
  void apply(float* r, float* g, float* b, std::size_t n) const;
  void apply(double* r, double* g, double* b, std::size_t n) const;

  struct Impl;
  explicit ColorConversion(Ref<Impl> impl) : impl_(std::move(impl)) {}

 private:
  Ref<Impl> impl_;
};

// Who computes a conversion between spaces of the embedded configuration.
enum class ColorEngine : std::uint8_t { exact, ocio };
constexpr auto choices(ColorEngine) {
  return std::array{std::pair{ColorEngine::exact, "exact"}, std::pair{ColorEngine::ocio, "ocio"}};
}

// A colour configuration: the embedded one, which is built in code, or an OpenColorIO file.
//
// The embedded one (scene reference CIE XYZ with D65 white; names and aliases are found in any case):
//   xyz_d65       CIE XYZ                                cie_xyz_d65, xyz, CIE-XYZ-D65
//   lin_rec709    linear, Rec.709 and sRGB primaries     linear, lin_srgb, linear_srgb, scene_linear
//   srgb          IEC 61966-2-1                          sRGB - Texture, srgb_texture, srgb_tx, srgb_rec709
//   rec709        BT.709 primaries, camera curve         Rec.709, bt709
//   lin_rec2020   linear, BT.2020 primaries              linear_rec2020, lin_bt2020
//   rec2020       BT.2020 primaries, camera curve        Rec.2020, bt2020
//   lin_p3d65     linear, P3 primaries with D65          linear_p3, lin_display_p3, linear_display_p3
//   display_p3    P3 primaries with D65, sRGB curve      Display P3, p3, srgb_p3d65
//   lin_adobergb  linear, Adobe RGB (1998) primaries     linear_adobe_rgb, lin_adobe_rgb
//   adobe_rgb     Adobe RGB (1998), exponent 563/256     AdobeRGB, Adobe RGB (1998), adobergb
//   lin_ap0       ACES2065-1 (AP0), Bradford to D65      ACES2065-1, aces2065_1, ap0, aces
//   lin_ap1       ACEScg (AP1), Bradford to D65          ACEScg, ap1
//   raw           data: no conversion changes it   data, Utility - Raw
class ColorConfig {
 public:
  static const ColorConfig& embedded();
  // The file; where none is named, the file that the environment variable OCIO names; else the embedded
  // configuration. Throws WorldError("cannot_read_file") or NodeError("malformed_file").
  static Ref<ColorConfig> open(const FilePath& file);

  // The name of a space from that name or an alias: as the configuration lists it, else as the embedded one
  // does, whose spaces are known beside every file. Nothing where neither knows it.
  std::optional<std::string> find(std::string_view name) const;
  // The same; throws NodeError("unknown_color_space"), which says what is near.
  std::string resolve(std::string_view name) const;
  std::vector<std::string> names() const;    // of spaces, in the order of the configuration
  std::vector<std::string> aliases() const;  // its other names for them, and its roles

  // Between a space of a file and an embedded one the way goes through the file's role aces_interchange.
  // Throws NodeError("unknown_color_space") or NodeError("no_conversion").
  ColorConversion conversion(std::string_view from, std::string_view to,
                             ColorEngine engine = ColorEngine::exact) const;

  // The configuration as an OpenColorIO file. OpenColorIO's sRGB curve is the smooth one of its
  // ExponentWithLinearTransform: at most 7.6e-7 from the standard's, relatively 2.5e-4 in the toe, plus
  // 1e-5 of its fast powers (measured, 2.1.2).
  std::string text() const;

  struct Impl;
  explicit ColorConfig(std::unique_ptr<Impl>);
  ~ColorConfig();

 private:
  std::unique_ptr<Impl> impl_;
};

// Makes the file that $OCIO names one of the files that a node's results depend on, as if a parameter named it.
void depend_on_color_environment(NodeType&);

// One colour of the graph's text to linear Rec.709, by the embedded configuration; false where it does not
// know the space.
bool to_linear_rec709(std::string_view space, glm::dvec3& rgb);

}  // namespace frustum
