// Colour spaces: matrices against published ones, curves against OpenColorIO, names, and files of
// configuration.
#include "runtime/io/color.h"

#include "nodes/color.h"
#include "runtime/core/error.h"
#include "runtime/core/node_type.h"
#include "runtime/io/color_spaces.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

namespace frustum {
namespace {

using testing::HasSubstr;

Matrix3 matrix(const char* from, const char* to) {
  return color_map(*find_embedded(from), *find_embedded(to)).matrix;
}

void expect_near(const Matrix3& got, const Matrix3& want, double tolerance) {
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(got[i], want[i], tolerance) << i;
}

// Computed from the primaries by others; ACES against OpenColorIO's own matrices, which have 8 digits.
TEST(Color, MatricesAreThePublishedOnes) {
  expect_near(matrix("xyz_d65", "lin_rec709"),
              {3.240969941905, -1.537383177570, -0.498610760293, -0.969243636281, 1.875967501508,
               0.041555057407, 0.055630079697, -0.203976958889, 1.056971514243},
              1e-12);
  expect_near(matrix("lin_ap0", "lin_rec2020"),
              {1.490409520542, -0.266170919266, -0.224238601276, -0.080167499872, 1.182167121098,
               -0.101999621225, 0.003227631192, -0.034776475745, 1.031548844553},
              1e-12);
  expect_near(matrix("lin_rec709", "lin_p3d65"),
              {0.82246197, 0.17753803, 0, 0.03319420, 0.96680580, 0, 0.01708263, 0.07239744, 0.91051993},
              5e-9);
}

TEST(Color, WhiteIsWhiteInEverySpace) {
  for (const ColorSpace& a : embedded_spaces())
    for (const ColorSpace& b : embedded_spaces()) {
      if (a.primaries.empty() || b.primaries.empty()) continue;
      double rgb[3] = {1, 1, 1};
      ColorConfig::embedded().conversion(a.name, b.name).apply(&rgb[0], &rgb[1], &rgb[2], 1);
      for (const double v : rgb) EXPECT_NEAR(v, 1, 4e-15) << a.name << " to " << b.name;
    }
}

TEST(Color, GreysStayNeutralAndWhiteKeepsItsBits) {
  for (const ColorSpace& a : embedded_spaces())
    for (const ColorSpace& b : embedded_spaces()) {
      if (a.primaries.empty() || b.primaries.empty()) continue;
      for (const float grey : {1.0f, 0.5f, 0.18f, 0.001f, 7.25f}) {
        float r = grey, g = grey, blue = grey;
        ColorConfig::embedded().conversion(a.name, b.name).apply(&r, &g, &blue, 1);
        EXPECT_EQ(r, g) << a.name << " to " << b.name;
        EXPECT_EQ(r, blue) << a.name << " to " << b.name;
        if (grey == 1) {
          EXPECT_EQ(r, 1) << a.name << " to " << b.name;
        }
      }
    }
}

// Every pair, ours against OpenColorIO. Where a curve takes part, its sRGB is smooth (relatively 2.5e-4 off
// in the toe) and its powers are fast ones (1e-5); matrices alone agree to the rounding of floats.
TEST(Color, AgreesWithOpenColorIO) {
  for (const ColorSpace& a : embedded_spaces())
    for (const ColorSpace& b : embedded_spaces()) {
      const auto ours = ColorConfig::embedded().conversion(a.name, b.name);
      const auto theirs = ColorConfig::embedded().conversion(a.name, b.name, ColorEngine::ocio);
      EXPECT_EQ(ours.identity(), theirs.identity()) << a.name << " to " << b.name;
      EXPECT_EQ(theirs.foreign(), !theirs.identity());
      for (const double level : {0.001, 0.02, 0.18, 0.9, 4.0}) {
        float x[3] = {static_cast<float>(level), static_cast<float>(level * 0.8),
                      static_cast<float>(level * 1.1)},
              y[3] = {x[0], x[1], x[2]};
        ours.apply(&x[0], &x[1], &x[2], 1);
        theirs.apply(&y[0], &y[1], &y[2], 1);
        const double scale = std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])});
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(x[k], y[k], scale * (ours.linear() ? 1e-6 : 6e-4))
              << a.name << " to " << b.name << " of " << level;
      }
    }
}

TEST(Color, ThereAndBackIsTheSameColour) {
  for (const ColorSpace& a : embedded_spaces())
    for (const ColorSpace& b : embedded_spaces()) {
      double rgb[3] = {0.7, -0.02, 3.5};
      ColorConfig::embedded().conversion(a.name, b.name).apply(&rgb[0], &rgb[1], &rgb[2], 1);
      ColorConfig::embedded().conversion(b.name, a.name).apply(&rgb[0], &rgb[1], &rgb[2], 1);
      EXPECT_NEAR(rgb[0], 0.7, 1e-13) << a.name << " " << b.name;
      EXPECT_NEAR(rgb[1], -0.02, 1e-8) << "the two knees of sRGB are rounded";
      EXPECT_NEAR(rgb[2], 3.5, 1e-12);
    }
}

TEST(Color, NamesAreFoundInAnyCaseAndUnderTheirAliases) {
  const ColorConfig& c = ColorConfig::embedded();
  EXPECT_EQ(c.find("sRGB"), "srgb");
  EXPECT_EQ(c.find("ACESCG"), "lin_ap1");
  EXPECT_EQ(c.find("Adobe RGB (1998)"), "adobe_rgb");
  EXPECT_EQ(c.find("ACES2065-1"), "lin_ap0");
  EXPECT_FALSE(c.find("srbg"));
  try {
    c.conversion("lin_rec709", "srbg");
    FAIL();
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "unknown_color_space");
    EXPECT_THAT(e.what(), HasSubstr("did you mean 'srgb'?"));
  }
}

TEST(Color, NoNameMeansTwoSpaces) {
  const ColorConfig& c = ColorConfig::embedded();
  std::vector<std::string> all = c.names();
  for (const std::string& a : c.aliases()) all.push_back(a);
  for (std::string& n : all)
    for (char& ch : n) ch = static_cast<char>(std::tolower(static_cast<unsigned char>(ch)));
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
}

TEST(Color, IdentitiesAndDataChangeNothing) {
  const ColorConfig& c = ColorConfig::embedded();
  EXPECT_TRUE(c.conversion("srgb", "sRGB").identity());
  EXPECT_TRUE(c.conversion("raw", "srgb").identity());
  EXPECT_TRUE(c.conversion("lin_ap0", "raw").identity());
  EXPECT_FALSE(c.conversion("lin_ap0", "lin_ap1").identity());
  EXPECT_TRUE(c.conversion("lin_ap0", "lin_ap1").linear());
  EXPECT_FALSE(c.conversion("lin_rec709", "srgb").linear());
}

TEST(Color, AConfigurationFileIsUsed) {
  const test::TempFolder folder;
  const FilePath file{"c.ocio", folder.write("c.ocio", ColorConfig::embedded().text())};
  const Ref<ColorConfig> c = ColorConfig::open(file);
  EXPECT_EQ(c->names(), ColorConfig::embedded().names());
  EXPECT_EQ(c->find("SRGB"), "srgb");
  const ColorConversion conversion = c->conversion("linear", "srgb");
  EXPECT_TRUE(conversion.foreign());
  float rgb[3] = {0.5f, 0.5f, std::nanf("")};
  conversion.apply(&rgb[0], &rgb[1], &rgb[2], 1);
  EXPECT_TRUE(std::isnan(rgb[0]) || std::abs(rgb[0] - 0.735357f) < 2e-5f);
  EXPECT_TRUE(std::isnan(rgb[2]));
}

constexpr const char* other_config = R"(ocio_profile_version: 2
roles: {aces_interchange: aces, default: aces, scene_linear: aces}
displays: {d: [!<View> {name: v, colorspace: aces}]}
colorspaces:
  - !<ColorSpace> {name: aces, aliases: [house_aces]}
  - !<ColorSpace>
    name: house
    to_scene_reference: !<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]}
)";

TEST(Color, EmbeddedSpacesAreKnownBesideThoseOfAFile) {
  const test::TempFolder folder;
  const Ref<ColorConfig> c = ColorConfig::open({"c.ocio", folder.write("c.ocio", other_config)});
  EXPECT_EQ(c->find("house_aces"), "aces");
  EXPECT_EQ(c->find("sRGB"), "srgb");
  float x[3] = {0.1f, 0.2f, 0.3f}, y[3] = {0.2f, 0.4f, 0.6f};
  c->conversion("house", "lin_rec709").apply(&x[0], &x[1], &x[2], 1);
  ColorConfig::embedded().conversion("lin_ap0", "lin_rec709").apply(&y[0], &y[1], &y[2], 1);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(x[k], y[k], 1e-6);
  EXPECT_FALSE(c->conversion("lin_rec709", "srgb").foreign()) << "both are embedded";
}

TEST(Color, TheEnvironmentNamesAConfiguration) {
  const test::TempFolder folder;
  folder.write("c.ocio", other_config);
  const char* old = std::getenv("OCIO");
  const std::string kept = old != nullptr ? old : "";
  setenv("OCIO", folder.file("c.ocio").c_str(), 1);
  EXPECT_EQ(ColorConfig::open({})->find("house"), "house");
  setenv("OCIO", folder.file("none.ocio").c_str(), 1);
  try {
    ColorConfig::open({});
    ADD_FAILURE();
  } catch (const WorldError& e) {
    EXPECT_THAT(e.what(), HasSubstr("named by $OCIO"));
  }
  if (old != nullptr)
    setenv("OCIO", kept.c_str(), 1);
  else
    unsetenv("OCIO");
  EXPECT_FALSE(ColorConfig::open({})->find("house"));
}

TEST(Color, ResultsDependOnTheFileThatTheEnvironmentNames) {
  const NodeType type = nodes::color_convert();
  const auto params = type.default_params();
  const auto files = [&] {
    std::vector<std::string> paths;
    type.params.files(params.get(), [&](const FilePath& f) { paths.push_back(f.resolved); });
    return paths;
  };
  const char* old = std::getenv("OCIO");
  const std::string kept = old != nullptr ? old : "";
  unsetenv("OCIO");
  const auto without = files();
  setenv("OCIO", "/some/config.ocio", 1);
  auto with = files();
  if (old != nullptr)
    setenv("OCIO", kept.c_str(), 1);
  else
    unsetenv("OCIO");
  ASSERT_EQ(with.size(), without.size() + 1);
  EXPECT_EQ(with.back(), "/some/config.ocio");
}

TEST(Color, AFileThatIsNoConfigurationIsAnError) {
  const test::TempFolder folder;
  for (const char* text : {"", "hello", "ocio_profile_version: 2\n", "\x89PNG"}) {
    try {
      ColorConfig::open({"c.ocio", folder.write("c.ocio", text)});
      ADD_FAILURE() << text;
    } catch (const NodeError& e) {
      EXPECT_EQ(e.code, "malformed_file");
    }
  }
}

TEST(Color, ATextColourBecomesLinear) {
  glm::dvec3 rgb{0.5, 0.5, 0.5};
  EXPECT_TRUE(to_linear_rec709("srgb", rgb));
  EXPECT_NEAR(rgb.y, 0.214041140482, 1e-12);
  EXPECT_FALSE(to_linear_rec709("srbg", rgb));
}

}  // namespace
}  // namespace frustum
