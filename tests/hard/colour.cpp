// Colour.
#include "nodes/color/cmy.h"
#include "nodes/color/rgb_hsv.h"
#include "nodes/color/xy.h"
#include "nodes/kernels/simd/transfer.h"
#include "nodes/kernels/transfer.h"
#include "runtime/app/export.h"
#include "runtime/io/color.h"
#include "runtime/io/image_files.h"
#include "tests/hard/exact.h"
#include "tests/hard/stages.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace frustum::hard {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity(),
                nan = std::numeric_limits<float>::quiet_NaN();
using kernels::Curve;

using Matrix = std::array<double, 9>;
std::array<double, 3> times(const Matrix& m, const std::array<double, 3>& c) {
  return {m[0] * c[0] + m[1] * c[1] + m[2] * c[2], m[3] * c[0] + m[4] * c[1] + m[5] * c[2],
          m[6] * c[0] + m[7] * c[1] + m[8] * c[2]};
}

// From Rec.709 to XYZ, to Rec.2020, to ACES and home again.
void around_the_spaces(Trial& t) {
  // IEC 61966-2-1 prints its matrices with four digits, there and back.
  constexpr Matrix xyz_from_rgb{0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505};
  constexpr Matrix rgb_from_xyz{3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570};
  const auto& config = ColorConfig::embedded();
  const std::array<std::string, 5> way{"lin_rec709", "xyz_d65", "lin_rec2020", "lin_ap0", "lin_rec709"};
  std::vector<ColorConversion> steps;
  for (std::size_t i = 0; i + 1 < way.size(); ++i) steps.push_back(config.conversion(way[i], way[i + 1]));
  const int trips = static_cast<int>(t.samples(1000, 10000));
  for (int n = 0; n < 20; ++n) {
    std::array<double, 3> start{};
    for (double& c : start) c = t.random.uniform(0, 1);
    auto ours = start, textbook = start;
    for (int i = 0; i < trips; ++i) {
      for (const auto& step : steps) step.apply(&ours[0], &ours[1], &ours[2], 1);
      textbook = times(rgb_from_xyz, times(xyz_from_rgb, textbook));
    }
    const auto drift = [&](const std::array<double, 3>& c) {
      double worst = 0;
      for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, std::fabs(c[k] - start[k]));
      return worst / (u64 * trips);
    };
    t.measure(drift(textbook), drift(ours), {start[0], start[1], start[2]});
  }
  // In float, there and back once: every 8-bit colour comes home.
  const auto there = config.conversion("srgb", "lin_rec2020"),
             back = config.conversion("lin_rec2020", "srgb");
  for (std::size_t i = t.samples(50000, 1u << 24); i-- > 0;) {
    const std::size_t code = t.full() ? i : t.random.below(1 << 24);
    std::array<float, 3> c{};
    for (std::size_t k = 0; k < 3; ++k) c[k] = static_cast<float>(code >> (8 * k) & 255) / 255;
    const auto start = c;
    there.apply(&c[0], &c[1], &c[2], 1), back.apply(&c[0], &c[1], &c[2], 1);
    for (std::size_t k = 0; k < 3; ++k)
      t.require(std::nearbyint(c[k] * 255) == std::nearbyint(start[k] * 255), "8-bit colours come home",
                {start[0], start[1], start[2]});
  }
}

void transfer_joints(Trial& t) {
  const auto textbook = [](float v) {
    return v <= 0.0031308F && v >= 0 ? 12.92F * v : 1.055F * std::pow(v, 1 / 2.4F) - 0.055F;
  };
  std::vector<float> inputs;
  const auto around = [&](float v) {
    for (std::uint32_t bits = std::bit_cast<std::uint32_t>(v) - 300, end = bits + 600; bits < end; ++bits)
      inputs.push_back(std::bit_cast<float>(bits));
  };
  around(0.0031308F), around(0.04045F), around(0.018053969F), around(0.5F), around(0x1.fffffep-1F);
  for (std::size_t n = t.samples(20000, 1000000); n-- > 0;)
    inputs.push_back(static_cast<float>(t.random.magnitude(-40, 4)));
  for (const Curve curve : {Curve::srgb, Curve::rec709, Curve::adobe_rgb}) {
    for (const float v : inputs) {
      const float up = std::nextafter(std::fabs(v), infinity);
      const float encoded = kernels::encode(curve, v), decoded = kernels::decode(curve, v);
      t.require(kernels::encode(curve, std::fabs(v)) <= kernels::encode(curve, up) &&
                    kernels::decode(curve, std::fabs(v)) <= kernels::decode(curve, up),
                "monotonic", {v, static_cast<double>(curve)});
      t.require(encoded == -kernels::encode(curve, -v) && decoded == -kernels::decode(curve, -v), "odd", {v});
      if (curve == Curve::srgb)
        t.tally(std::isnan(textbook(v)), std::isnan(encoded) || std::isnan(decoded), {v});
    }
    for (int i = 0; i < 256; ++i) {
      const float code = static_cast<float>(i) / 255;
      t.require(
          std::nearbyint(kernels::encode(curve, kernels::decode(curve, code)) * 255) == static_cast<float>(i),
          "every code comes home", {code});
    }
  }
  std::vector<float> r(4096), g(4096), b(4096);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = g[i] = b[i] = static_cast<float>(t.random.uniform(0, 1));
  const kernels::ColorMap map{.to = Curve::srgb};
  t.price(
      [&] {
        std::vector<float> out(3 * r.size());
        for (std::size_t i = 0; i < r.size(); ++i)
          out[i] = textbook(r[i]), out[r.size() + i] = textbook(g[i]), out[2 * r.size() + i] = textbook(b[i]);
        keep(out[0]);
      },
      [&] {
        auto x = r, y = g, z = b;
        kernels::simd::convert_colors(map, x.data(), y.data(), z.data(), x.size());
        keep(x[0]);
      });
}

// The values as a grey picture in a file of its own, written with so many bits and read again.
std::vector<float> through_a_file(const std::vector<float>& values, const std::string& extension, int bits) {
  constexpr int width = 256;
  const int height = static_cast<int>((values.size() + width - 1) / width);
  Raster raster(Frame{.window = {0, 0, width, height},
                      .planes = {{"R", PlaneKind::f32}, {"G", PlaneKind::f32}, {"B", PlaneKind::f32}},
                      .color_space = "lin_rec709"});
  for (std::size_t i = 0; i < values.size(); ++i)
    for (int plane = 0; plane < 3; ++plane)
      raster.view().row<float>(plane, 0, static_cast<int>(i) / width)[i % width] = values[i];
  const auto path =
      std::filesystem::temp_directory_path() / ("frustum_hard_" + std::to_string(getpid()) + extension);
  const Rect window = raster.frame().window;
  const auto sink = open_image_sink({.path = path.string(),
                                     .region = window,
                                     .display_window = window,
                                     .layers = {{"", raster.frame()}},
                                     .bits = bits,
                                     .compression = {},
                                     .metadata = {}});
  const Tile all = raster.view();
  sink->write({&all, 1});
  sink->finish();
  const Raster back = load_raster(path.string());
  std::filesystem::remove(path);
  std::vector<float> out;
  for (std::size_t i = 0; i < values.size(); ++i)
    out.push_back(
        static_cast<float>(back.value(0, 0, static_cast<int>(i) % width, static_cast<int>(i) / width)));
  return out;
}

// The nearest half, ties to even, beyond 65504 held there: from its definition.
Rational nearest_half(float v) {
  const Rational x(v);
  if (::abs(x) >= 65504) return x > 0 ? Rational(65504) : Rational(-65504);
  const int exponent = v == 0 ? -24 : std::max(std::ilogb(v) - 10, -24);
  const Rational step = exponent >= 0 ? Rational(1 << exponent) : Rational(1, 1 << -exponent);
  Rational steps = x / step;
  mpz_class low;
  mpz_fdiv_q(low.get_mpz_t(), steps.get_num_mpz_t(), steps.get_den_mpz_t());
  const Rational rest = steps - low;
  const bool up = rest > Rational(1, 2) || (rest == Rational(1, 2) && low % 2 != 0);
  return step * Rational(up ? mpz_class(low + 1) : low);
}

void half_floats(Trial& t) {
  std::vector<float> values{65504,    65519.99F, 65520,      1e6F, -65520, 1e-8F,   6e-8F,
                            2.98e-8F, 0x1p-25F,  0x1.8p-24F, 0,    -0.0F,  0x1p-14F};
  for (std::size_t n = t.samples(20000, 1000000); n-- > 0;) {
    auto v = static_cast<float>(t.random.magnitude(-26, 17));
    if (n % 4 == 0)
      v = std::bit_cast<float>((std::bit_cast<std::uint32_t>(v) & 0xffffe000u) | 0x1000u);  // a tie
    values.push_back(v);
  }
  const auto got = through_a_file(values, ".exr", 16);
  for (std::size_t i = 0; i < values.size(); ++i) {
    // The textbook cuts digits off, gives infinity beyond the range and flushes what is below it.
    const float v = values[i], cut = std::bit_cast<float>(std::bit_cast<std::uint32_t>(v) & 0xffffe000u);
    const float textbook = std::fabs(v) >= 65520 ? infinity : (std::fabs(v) < 0x1p-14F ? 0 : cut);
    const Rational want = nearest_half(v);
    t.tally(!std::isfinite(textbook) || Rational(textbook) != want,
            !std::isfinite(got[i]) || Rational(got[i]) != want, {v});
  }
  const auto broken = through_a_file({nan, infinity, -infinity}, ".exr", 16);
  t.require(std::isnan(broken[0]) && broken[1] == infinity && broken[2] == -infinity,
            "NaN and infinities stay what they are");
}

void quantising(Trial& t) {
  std::vector<float> values{nan, -0.0F, -1, infinity, -infinity, std::nextafter(1.0F, 2.0F), 1, 0.5F};
  for (int k = 0; k < 255; ++k) {
    const auto tie = static_cast<float>((k + 0.5) / 255);
    for (const float v :
         {tie, std::nextafter(tie, 0.0F), std::nextafter(tie, 1.0F), static_cast<float>(k) / 255})
      values.push_back(v);
  }
  for (int k = 0; k < 1 << 16; k += 37) {
    const auto tie = static_cast<float>((k + 0.5) / 65535);
    for (const float v : {tie, std::nextafter(tie, 0.0F), std::nextafter(tie, 1.0F)}) values.push_back(v);
  }
  for (const int most : {255, 65535}) {
    const auto got = through_a_file(values, most == 255 ? ".png" : ".tif", most == 255 ? 8 : 16);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const float v = values[i];
      mpz_class want = 0;
      if (v >= 1) want = most;
      if (v > 0 && v < 1) {
        const Rational x = Rational(v) * most;
        mpz_fdiv_q(want.get_mpz_t(), x.get_num_mpz_t(), x.get_den_mpz_t());
        const Rational rest = x - want;
        if (rest > Rational(1, 2) || (rest == Rational(1, 2) && want % 2 != 0)) want += 1;
      }
      const float held = v > 0 ? std::min(v, 1.0F) : 0;
      const auto textbook = static_cast<int>(held * static_cast<float>(most) + 0.5F);
      t.tally(textbook != want, mpz_class(std::nearbyint(got[i] * static_cast<float>(most))) != want,
              {v, static_cast<double>(most)});
    }
    std::vector<float> codes;
    for (int k = 0; k <= most; k += most == 255 ? 1 : 17)
      codes.push_back(static_cast<float>(k) / static_cast<float>(most));
    const auto once = through_a_file(codes, most == 255 ? ".png" : ".tif", most == 255 ? 8 : 16);
    const auto twice = through_a_file(once, most == 255 ? ".png" : ".tif", most == 255 ? 8 : 16);
    for (std::size_t i = 0; i < codes.size(); ++i)
      t.require(once[i] == twice[i] && once[i] == codes[i], "codes come home", {codes[i]});
  }
}

using Color = std::array<float, 3>;
double farthest(const Color& a, const Color& b) {
  double worst = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::fabs(static_cast<double>(a[k]) - b[k]);
    if (!(d <= worst)) worst = std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
  }
  return worst;
}

// As textbooks print it: no saturation where the greatest is not above 0, and a sextant for each 60 degrees.
Color textbook_hsv(const Color& c) {
  const float most = std::max({c[0], c[1], c[2]}), chroma = most - std::min({c[0], c[1], c[2]});
  float h = 0;
  if (chroma != 0)
    h = most == c[0]   ? 60 * ((c[1] - c[2]) / chroma)
        : most == c[1] ? 60 * (2 + (c[2] - c[0]) / chroma)
                       : 60 * (4 + (c[0] - c[1]) / chroma);
  return {h < 0 ? h + 360 : h, most <= 0 ? 0 : chroma / most, most};
}
Color textbook_rgb(const Color& hsv) {
  const float h = hsv[0] / 60, s = hsv[1], v = hsv[2];
  const int sextant = static_cast<int>(h);
  const float f = h - static_cast<float>(sextant), p = v * (1 - s), q = v * (1 - s * f),
              t = v * (1 - s * (1 - f));
  switch (sextant) {
    case 0: return {v, t, p};
    case 1: return {q, v, p};
    case 2: return {p, v, t};
    case 3: return {p, q, v};
    case 4: return {t, p, v};
    case 5: return {v, p, q};
    default: return {};  // the seventh: nobody writes it
  }
}

void colours_outside_the_cube(Trial& t) {
  std::vector<Color> colors{
      {-0.5F, 0, 1}, {2, -1, 0.5F}, {-1, -2, -3}, {-0.25F, -0.25F, -0.25F}, {1e4F, -3, 17}};
  for (std::size_t n = t.samples(20000, 1000000); n-- > 0;) {
    Color c{};
    for (float& v : c) v = static_cast<float>(t.random.uniform(-2, 3));
    // Where the greatest is next to 0 beside the others there is no saturation to speak of.
    if (std::fabs(std::max({c[0], c[1], c[2]})) >= 0x1p-10F) colors.push_back(c);
  }
  for (const Color& c : colors) {
    const auto [least, most] = std::minmax({c[0], c[1], c[2]});
    const double scale = std::max({std::fabs(least), std::fabs(most), most - least}) * 0x1p-24;
    t.measure(farthest(textbook_rgb(textbook_hsv(c)), c) / scale,
              farthest(color::rgb_of_hsv(color::hsv_of_rgb(c)), c) / scale, {c[0], c[1], c[2]});
  }
  t.require(std::isinf(color::hsv_of_rgb<float>({0, -1, 0})[1]), "what h, s and v do not hold is infinite");
}

void hues_around(Trial& t) {
  const float below = std::nextafter(360.0F, 0.0F);
  for (const float h : {360.0F, below, below + 0x1p-15F, -0.0F, -1e-8F, -1e-30F, 720.0F, -360.0F, 3.6e6F}) {
    const Color hsv{h, 1, 1}, red{1, 0, 0};
    t.tally(!(farthest(textbook_rgb(hsv), red) <= 1e-5), !(farthest(color::rgb_of_hsv(hsv), red) <= 1e-5),
            {h});
  }
  for (std::size_t n = t.samples(2000, 100000); n-- > 0;) {
    const auto whole = static_cast<float>(static_cast<int>(t.random.uniform(-10, 10)));
    const auto h =
        static_cast<float>(static_cast<int>(t.random.uniform(0, 5760))) / 16;  // exact with its turns
    const Color once = color::rgb_of_hsv<float>({h, 1, 1}), again{h + 360 * whole, 1, 1};
    t.tally(!(farthest(textbook_rgb(again), once) <= 1e-5), color::rgb_of_hsv(again) != once, {again[0]});
  }
}

void chromaticity_of_black(Trial& t) {
  const float tiny = std::numeric_limits<float>::denorm_min();
  std::vector<Color> lights{{0, 0, 0},          {-0.0F, 0, 0}, {1, -0.5F, -0.5F}, {3e38F, 3e38F, 3e38F},
                            {tiny, tiny, tiny}, {tiny, 0, 0}};
  for (std::size_t n = t.samples(1000, 100000); n-- > 0;) {
    const auto v = static_cast<float>(t.random.magnitude(-140, 120));
    lights.push_back({v, -v, 0});
  }
  for (const Color& c : lights) {
    const float sum = c[0] + c[1] + c[2], x = c[0] / sum, y = c[1] / sum;
    const Color ours = color::xyy_of_xyz<float>(c, {0.3127F, 0.3290F});
    const bool naive_lost = !std::isfinite(x) || !std::isfinite(y) || (x == 0 && y == 0 && c[0] != 0);
    t.tally(naive_lost, !std::isfinite(ours[0]) || !std::isfinite(ours[1]) || (ours[0] == 0 && c[0] != 0),
            {c[0], c[1], c[2]});
    t.require(color::has_xy(c) == (Rational(c[0]) + Rational(c[1]) + Rational(c[2]) != 0),
              "what is not defined is told", {c[0], c[1], c[2]});
  }
  t.require(color::xyz_of_xyy(color::xyy_of_xyz<float>({0, 0, 0}, {0.3127F, 0.3290F})) == Color{0, 0, 0},
            "black comes home");
}

void black_ink(Trial& t) {
  const float tiny = std::numeric_limits<float>::denorm_min();
  std::vector<Color> colors{{0, 0, 0}, {tiny, 0, 0}, {0x1p-24F, 0x1p-25F, 0}, {0x1p-30F, 0x1p-31F, 0x1p-30F}};
  for (std::size_t n = t.samples(20000, 1000000); n-- > 0;) {
    Color c{};
    const double size = std::exp2(-t.random.uniform(0, 30));
    for (float& v : c) v = static_cast<float>(t.random.uniform(0, size));
    colors.push_back(c);
  }
  for (const Color& c : colors) {
    const float k = std::min({1 - c[0], 1 - c[1], 1 - c[2]});
    Color naive{};
    for (std::size_t i = 0; i < 3; ++i) naive[i] = (1 - (1 - c[i] - k) / (1 - k)) * (1 - k);
    t.measure(farthest(naive, c) / 0x1p-24, farthest(color::rgb_of_cmyk(color::cmyk_of_rgb(c)), c) / 0x1p-24,
              {c[0], c[1], c[2]});
  }
}

}  // namespace

std::vector<HardCase> colour() {
  return {
      {"COL-02",
       "1000 trips from Rec.709 to XYZ, Rec.2020, ACES and back; 8-bit colours to Rec.2020 and back",
       "the standard's matrices of four digits", "ColorConfig::conversion", "the colour itself",
       "|x - x0| <= 8 u a trip; 8-bit colours come home", "u a trip", 8, around_the_spaces},
      {"COL-05", "colours below 0 and above 1 to hue, saturation, value and back",
       "saturation 0 where the greatest is not above 0", "color.rgb_hsv", "the colour itself",
       "comes home within 8 u of its greatest magnitude, or of its greatest difference", "u", 8,
       colours_outside_the_cube},
      {"COL-06", "hues next to 360, below 0, and many turns on", "a switch over the six sextants",
       "color.rgb_hsv", "red, and the hue without its turns", "hues go around", "wrong colours", 0,
       hues_around},
      {"COL-07", "300 floats to either side of each joint, random values of either sign",
       "12.92 v or 1.055 v^(1/2.4) - 0.055", "kernels::encode, decode", "comparison",
       "monotonic, odd, never NaN; all 256 codes come home", "NaN results", 0, transfer_joints},
      {"COL-08", "65504, 65519.99, 65520, subnormals, ties, NaN, infinities, through an EXR file",
       "cut the digits off", "the writer of half images", "rationals",
       "the nearest half, ties to even, finite stays finite", "wrong halves", 0, half_floats},
      {"COL-10", "every tie of 8 bits and its neighbours, ties of 16 bits, NaN, infinities",
       "v 65535 + 0.5 in float, truncated", "the writers of 8 and 16-bit images", "rationals",
       "the nearest code, ties to even; codes come home", "wrong codes", 0, quantising},
      {"COL-11", "black, light that cancels, the least and the greatest floats", "X / (X + Y + Z)",
       "color.xy", "rationals for the sum", "finite, and told where it is not defined; black comes home",
       "lost chromaticities", 0, chromaticity_of_black},
      {"COL-12", "black and colours next to it to four inks and back", "(C - K) / (1 - K)", "color.cmy",
       "the colour itself", "comes home within 4 u", "u", 4, black_ink},
  };
}

}  // namespace frustum::hard
