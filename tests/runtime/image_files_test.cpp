// Pictures go to files and come back; what cannot is said.
#include "runtime/io/image_files.h"
#include "runtime/core/error.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>

namespace frustum {
namespace {

using testing::HasSubstr;

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// A picture whose values are all different: plane p at x, y is (p + 1) (x + 16 y) / 1024.
Raster ramp(Rect window, PlaneList planes, Alpha alpha = Alpha::none, std::string space = "srgb") {
  Frame f{.window = window, .planes = std::move(planes), .color_space = std::move(space), .alpha = alpha};
  const Raster r(f);
  const Tile t = r.view();
  for (int p = 0; p < static_cast<int>(f.planes.size()); ++p)
    for (int y = window.y0; y < window.y1; ++y)
      for (int x = 0; x < window.width(); ++x) {
        const int n = (p + 1) * (x + 16 * (y - window.y0));
        switch (f.planes[static_cast<std::size_t>(p)].kind) {
          case PlaneKind::f32: t.row<float>(p, 0, y)[x] = static_cast<float>(n) / 1024.0f; break;
          case PlaneKind::f64: t.row<double>(p, 0, y)[x] = n / 1024.0; break;
          case PlaneKind::u32: t.row<std::uint32_t>(p, 0, y)[x] = static_cast<std::uint32_t>(n); break;
        }
      }
  return r;
}

const PlaneList rgb{{"R"}, {"G"}, {"B"}}, rgba{{"R"}, {"G"}, {"B"}, {"A"}};

SinkRequest request(const std::string& path, const std::vector<std::pair<std::string, Raster>>& layers) {
  SinkRequest r{.path = path,
                .region = layers[0].second.frame().window,
                .display_window = layers[0].second.frame().window,
                .layers = {},
                .compression = {},
                .metadata = {}};
  for (const auto& [name, raster] : layers) r.layers.push_back({name, raster.frame()});
  return r;
}

void write(const SinkRequest& r, const std::vector<std::pair<std::string, Raster>>& layers, int band = 5) {
  const auto sink = open_image_sink(r);
  for (int y = r.region.y0; y < r.region.y1; y += band) {
    std::vector<Tile> tiles;
    for (const auto& [name, raster] : layers)
      tiles.push_back(raster.view({r.region.x0, y, r.region.x1, std::min(y + band, r.region.y1)}));
    sink->write(tiles);
  }
  sink->finish();
}

ImageFile round_trip(const std::string& name, const Raster& picture, int bits = 0) {
  const test::TempFolder folder;
  SinkRequest r = request(folder.file(name), {{"", picture}});
  r.bits = bits;
  write(r, {{"", picture}});
  return read_image(folder.file(name), name);
}

double largest_difference(const Raster& a, const Raster& b) {
  double worst = 0;
  const Rect wa = a.frame().window, wb = b.frame().window;
  for (int p = 0; p < static_cast<int>(a.frame().planes.size()); ++p)
    for (int y = 0; y < wa.height(); ++y)
      for (int x = 0; x < wa.width(); ++x)
        worst = std::max(worst,
                         std::abs(a.value(p, 0, wa.x0 + x, wa.y0 + y) - b.value(p, 0, wb.x0 + x, wb.y0 + y)));
  return worst;
}

TEST(ImageFiles, EachFormatKeepsAsMuchAsItsDepth) {
  const Raster picture = ramp({0, 0, 16, 12}, rgb);
  const std::tuple<const char*, int, double> cases[] = {
      {"a.png", 0, 0.5 / 255},    {"a.png", 16, 0.5 / 65535}, {"a.tif", 8, 0.5 / 255},
      {"a.tiff", 0, 0.5 / 65535}, {"a.TIF", 32, 0},           {"a.exr", 0, 0x1p-12},
      {"a.exr", 32, 0},           {"a.hdr", 0, 1.0 / 256},    {"a.jpg", 0, 0.03}};
  for (const auto& [name, bits, tolerance] : cases) {
    const ImageFile back = round_trip(name, picture, bits);
    EXPECT_EQ(back.raster.frame().planes, rgb) << name;
    EXPECT_LE(largest_difference(picture, back.raster), tolerance * 1.0001) << name << " " << bits;
  }
}

TEST(ImageFiles, IntegersAreRoundedAndCut) {
  const Raster r(Frame{.window = {0, 0, 6, 1}, .planes = {{"Y"}}});
  const float v[] = {-1, std::nanf(""), 0.5f / 255 - 1e-5f, 0.5f / 255 + 1e-5f, 1, 7};
  std::copy(std::begin(v), std::end(v), r.view().row<float>(0, 0, 0));
  const Raster back = round_trip("a.png", r).raster;
  const float want[] = {0, 0, 0, 1.0f / 255, 1, 1};
  for (int x = 0; x < 6; ++x) EXPECT_EQ(back.at<float>(0, 0, x, 0), want[x]) << x;
  EXPECT_EQ(back.frame().planes, rgb) << "a grey picture has R = G = B";
}

TEST(ImageFiles, ExrHoldsLayersKindsAndWindows) {
  const test::TempFolder folder;
  const Rect region{-3, 2, 13, 14};
  const Raster main = ramp(region, rgba, Alpha::premultiplied, "lin_rec709"), depth = ramp(region, {{"Z"}}),
               ids = ramp(region, {{"id", PlaneKind::u32}}),
               points = ramp(region, {{"N.x", PlaneKind::f64}, {"N.y", PlaneKind::f64}});
  const std::vector<std::pair<std::string, Raster>> layers{
      {"", main}, {"Z", depth}, {"object", ids}, {"N", points}, {"diffuse", main}};
  SinkRequest r = request(folder.file("a.exr"), layers);
  r.display_window = {-10, -10, 100, 50};
  r.metadata = {{"Software", "frustum test"}};
  write(r, layers);
  const ImageFile back = read_image(folder.file("a.exr"), "a.exr");
  EXPECT_EQ(back.raster.frame().window, region);
  EXPECT_EQ(back.display_window, r.display_window);
  EXPECT_EQ(back.raster.frame().alpha, Alpha::premultiplied);
  EXPECT_THAT(back.metadata,
              testing::Contains(std::pair<std::string, std::string>("Software", "frustum test")));
  const auto plane = [&](const char* name) { return back.raster.frame().find(name).value(); };
  EXPECT_EQ(back.raster.frame().planes.size(), 12u);
  EXPECT_EQ(back.raster.at<std::uint32_t>(plane("object.id"), 0, 5, 7), ids.at<std::uint32_t>(0, 0, 5, 7));
  EXPECT_EQ(back.raster.at<float>(plane("Z"), 0, 5, 7), depth.at<float>(0, 0, 5, 7));
  EXPECT_EQ(back.raster.at<float>(plane("N.y"), 0, 5, 7), static_cast<float>(points.at<double>(1, 0, 5, 7)));
  EXPECT_NEAR(back.raster.at<float>(plane("diffuse.G"), 0, 5, 7), main.at<float>(1, 0, 5, 7), 0x1p-12);
}

TEST(ImageFiles, HalfKeepsWhatIsFiniteFinite) {
  const Raster r(Frame{.window = {0, 0, 4, 1}, .planes = rgb});
  const float v[] = {1e9f, -1e9f, std::numeric_limits<float>::infinity(), std::nanf("")};
  std::copy(std::begin(v), std::end(v), r.view().row<float>(0, 0, 0));
  const Raster back = round_trip("a.exr", r).raster;
  EXPECT_EQ(back.at<float>(0, 0, 0, 0), 65504);
  EXPECT_EQ(back.at<float>(0, 0, 1, 0), -65504);
  EXPECT_EQ(back.at<float>(0, 0, 2, 0), v[2]);
  EXPECT_TRUE(std::isnan(back.at<float>(0, 0, 3, 0)));
}

TEST(ImageFiles, PngStoresStraightAlphaAndGivesItBackPremultiplied) {
  const Raster r(Frame{.window = {0, 0, 2, 1}, .planes = rgba, .alpha = Alpha::premultiplied});
  for (int p = 0; p < 3; ++p) r.view().row<float>(p, 0, 0)[0] = 0.25f;
  r.view().row<float>(3, 0, 0)[0] = 0.5f;
  for (const int bits : {8, 16}) {
    const Raster back = round_trip("a.png", r, bits).raster;
    // Straight, the colour is 1/2: 128/255 in bytes; so is the alpha.
    EXPECT_NEAR(back.at<float>(0, 0, 0, 0), 0.25, bits == 8 ? 1.0 / 255 : 1.0 / 65535);
    EXPECT_EQ(back.at<float>(3, 0, 1, 0), 0);
    EXPECT_EQ(back.frame().alpha, Alpha::premultiplied);
  }
  EXPECT_EQ(round_trip("a.jpg", r).raster.frame().planes, rgb) << "no alpha there";
}

TEST(ImageFiles, PixelsThatAreSeeThroughAreToldWhereAFormatHasNoAlpha) {
  const Raster r(Frame{.window = {0, 0, 2, 12}, .planes = rgba, .alpha = Alpha::premultiplied});
  const auto said = [&](const std::string& name) {
    const test::TempFolder folder;
    std::string all;
    SinkRequest to = request(folder.file(name), {{"", r}});
    to.warn = [&](std::string_view code, const std::string& message) {
      all += std::string(code) + ": " + message;
    };
    write(to, {{"", r}});
    return all;
  };
  for (int y = 0; y < 12; ++y) r.view().row<float>(3, 0, y)[0] = 1;
  EXPECT_EQ(
      said("a.jpg"),
      "left_out: jpeg has no place for alpha: 12 of 24 pixels are see-through, and lie over black there");
  EXPECT_EQ(
      said("a.hdr"),
      "left_out: hdr has no place for alpha: 12 of 24 pixels are see-through, and lie over black there");
  EXPECT_EQ(said("a.png"), "");
  for (int y = 0; y < 12; ++y) r.view().row<float>(3, 0, y)[1] = 1;
  EXPECT_EQ(said("a.jpg"), "") << "it is opaque";
}

TEST(ImageFiles, ColourSpacesComeBack) {
  EXPECT_EQ(round_trip("a.png", ramp({0, 0, 4, 4}, rgb, Alpha::none, "srgb")).raster.frame().color_space,
            "srgb");
  EXPECT_EQ(round_trip("a.jpg", ramp({0, 0, 4, 4}, rgb, Alpha::none, "srgb")).raster.frame().color_space,
            "srgb");
  EXPECT_EQ(round_trip("a.exr", ramp({0, 0, 4, 4}, rgb, Alpha::none, "lin_ap1")).raster.frame().color_space,
            "lin_ap1");
  EXPECT_EQ(round_trip("a.exr", ramp({0, 0, 4, 4}, rgb, Alpha::none, "")).raster.frame().color_space,
            "lin_rec709");
  EXPECT_EQ(round_trip("a.hdr", ramp({0, 0, 4, 4}, rgb, Alpha::none, "")).raster.frame().color_space,
            "lin_rec709");
  EXPECT_EQ(round_trip("a.exr", ramp({0, 0, 4, 4}, {{"Z"}})).raster.frame().color_space, "")
      << "depth is no colour";
}

TEST(ImageFiles, BytesDependOnPixelsAlone) {
  const Raster picture = ramp({0, 0, 64, 48}, rgba, Alpha::premultiplied);
  for (const std::string name : {"a.png", "a.exr", "a.tif", "a.hdr", "a.jpg"}) {
    const test::TempFolder folder;
    std::string first;
    for (const int band : {48, 1, 7, 16, 20}) {
      write(request(folder.file(name), {{"", picture}}), {{"", picture}}, band);
      const std::string bytes = content(folder.file(name));
      if (first.empty()) first = bytes;
      EXPECT_TRUE(bytes == first) << name << " in bands of " << band;
    }
    for (const auto& [key, value] : read_image(folder.file(name), name).metadata)
      EXPECT_TRUE(key != "DateTime" || value.empty()) << name;
  }
}

TEST(ImageFiles, AnUnfinishedFileLeavesNothingAndKeepsTheOldOne) {
  const test::TempFolder folder;
  const Raster picture = ramp({0, 0, 16, 16}, rgb);
  folder.write("a.png", "old");
  {
    const auto sink = open_image_sink(request(folder.file("a.png"), {{"", picture}}));
    const Tile band = picture.view({0, 0, 16, 4});
    sink->write({&band, 1});
  }
  EXPECT_EQ(content(folder.file("a.png")), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

// libpng and its kind have things to say of files that end too early, on stderr.
TEST(ImageFiles, AnUnfinishedFileEndsWithoutAWord) {
  const Raster small = ramp({0, 0, 16, 16}, rgb), large = ramp({0, 0, 1500, 400}, rgb);
  for (const std::string name : {"a.png", "a.exr", "a.tif", "a.hdr", "a.jpg"})
    for (const Raster& picture : {small, large})
      for (const int rows : {0, 4, picture.frame().window.height()}) {
        const test::TempFolder folder;
        testing::internal::CaptureStderr();
        {
          const auto sink = open_image_sink(request(folder.file(name), {{"", picture}}));
          const Tile band = picture.view({0, 0, picture.frame().window.width(), rows});
          if (rows != 0) sink->write({&band, 1});
        }
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << name << " " << rows;
        EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
      }
}

TEST(ImageFiles, SayWhereTheyComeFrom) {
  const Raster picture = ramp({0, 0, 8, 8}, rgb);
  for (const std::string name : {"a.png", "a.exr", "a.tif"}) {
    const test::TempFolder folder;
    SinkRequest r = request(folder.file(name), {{"", picture}});
    r.metadata = {{"Software", "frustum 1.2.3"},
                  {"ImageDescription", "a title"},
                  {"frustum:graph", "0123456789abcdef"}};
    write(r, {{"", picture}});
    std::string all;
    for (const auto& [key, value] : read_image(folder.file(name), name).metadata)
      all += key + "=" + value + "\n";
    EXPECT_THAT(all, HasSubstr("Software=frustum 1.2.3\n")) << name;
    EXPECT_THAT(all, HasSubstr("ImageDescription=a title\n")) << name;
    EXPECT_THAT(all, HasSubstr("0123456789abcdef\n")) << name;
  }
}

TEST(ImageFiles, LinearColoursInADisplayFormatAreSaid) {
  const auto warned = [](const std::string& name, const std::string& space) {
    const test::TempFolder folder;
    const Raster picture = ramp({0, 0, 4, 4}, rgb, Alpha::none, space);
    SinkRequest r = request(folder.file(name), {{"", picture}});
    std::string code;
    r.warn = [&](std::string_view c, const std::string&) { code = c; };
    write(r, {{"", picture}});
    return code;
  };
  for (const char* linear : {"lin_rec709", "lin_ap1", "lin_unheard_of"}) {
    EXPECT_EQ(warned("a.png", linear), "display_format_linear") << linear;
    EXPECT_EQ(warned("a.jpg", linear), "display_format_linear") << linear;
    EXPECT_EQ(warned("a.exr", linear), "");
    EXPECT_EQ(warned("a.tif", linear), "");
  }
  for (const char* other : {"srgb", "rec709", "raw", ""}) EXPECT_EQ(warned("a.png", other), "") << other;
}

template <class Error>
std::pair<std::string, std::string> error_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& e) {
    return {e.code, e.what()};
  }
  return {};
}

TEST(ImageFiles, AFullDiskIsSaidAndLeavesNothing) {
  const Raster picture = ramp({0, 0, 256, 256}, rgb);
  for (const std::string name : {"a.png", "a.exr", "a.tif", "a.hdr", "a.jpg"}) {
    const test::TempFolder folder;
    rlimit old{};
    getrlimit(RLIMIT_FSIZE, &old);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{1000, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    testing::internal::CaptureStderr();
    const auto [code, message] = error_of<WorldError>([&] {
      SinkRequest r = request(folder.file(name), {{"", picture}});
      if (name == "a.exr") r.compression = "none";
      write(r, {{"", picture}});
    });
    setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, old_handler);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << name;
    EXPECT_EQ(code, "cannot_write_file") << name;
    EXPECT_THAT(message, HasSubstr("File too large")) << name;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << name;
  }
}

TEST(ImageFiles, FoldersAreMadeAndOneThatCannotBeIsSaid) {
  const test::TempFolder folder;
  const Raster picture = ramp({0, 0, 4, 4}, rgb);
  write(request(folder.file("new/deep/a.png"), {{"", picture}}), {{"", picture}});
  EXPECT_TRUE(std::filesystem::exists(folder.file("new/deep/a.png")));
  folder.write("file", "");
  const auto [code, message] = error_of<WorldError>([&] {
    write(request(folder.file("file/a.png"), {{"", picture}}), {{"", picture}});
  });
  EXPECT_EQ(code, "cannot_write_file");
  EXPECT_THAT(message, HasSubstr("Not a directory"));
}

TEST(ImageFiles, RefusesWhatAFormatCannotHold) {
  const Raster color = ramp({0, 0, 4, 4}, rgb), depth = ramp({0, 0, 4, 4}, {{"Z"}}),
               both = ramp({0, 0, 4, 4}, {{"R"}, {"Z"}}), ids = ramp({0, 0, 4, 4}, {{"id", PlaneKind::u32}});
  const auto refused = [](SinkRequest r) { return error_of<NodeError>([&] { open_image_sink(r); }); };
  EXPECT_EQ(refused(request("a.pgn", {{"", color}})).first, "unknown_format");
  EXPECT_THAT(refused(request("a.pgn", {{"", color}})).second, HasSubstr("did you mean .png?"));
  EXPECT_EQ(refused(request("picture", {{"", color}})).first, "unknown_format");
  EXPECT_EQ(refused(request("a.png", {{"", color}, {"Z", depth}})).first, "format_cannot_hold");
  EXPECT_THAT(refused(request("a.png", {{"", both}})).second, HasSubstr("holds R, G, B and A, not 'Z'"));
  EXPECT_EQ(refused(request("a.png", {{"", ids}})).first, "format_cannot_hold");
  EXPECT_EQ(refused(request("a.exr", {{"", color}, {"", color}})).first, "format_cannot_hold");
  SinkRequest r = request("a.png", {{"", color}});
  r.bits = 12;
  EXPECT_EQ(refused(r),
            (std::pair<std::string, std::string>{"bad_bits", "a.png: png has 8 or 16 bits, not 12"}));
  r.bits = 0, r.compression = "zip";
  EXPECT_EQ(refused(r).first, "unknown_compression");
  r.path = "a.jpg", r.compression = "quality:101";
  EXPECT_EQ(refused(r).first, "unknown_compression");
}

TEST(ImageFiles, ACompressionThatIsAskedForIsUsed) {
  const test::TempFolder folder;
  const Raster picture = ramp({0, 0, 64, 64}, rgb);
  std::map<std::string, std::size_t> sizes;
  for (const std::string c : {"none", "zip", "piz"}) {
    SinkRequest r = request(folder.file("a.exr"), {{"", picture}});
    r.compression = c;
    write(r, {{"", picture}});
    sizes[c] = content(folder.file("a.exr")).size();
  }
  EXPECT_LT(sizes["zip"], sizes["none"]);
  EXPECT_NE(sizes["zip"], sizes["piz"]);
}

// A lower quality is a smaller file that is further from the picture; the usual one is high.
TEST(ImageFiles, TheQualityOfAJpegIsTheOneAskedFor) {
  const test::TempFolder folder;
  const Raster picture = ramp({0, 0, 64, 64}, rgb);
  std::map<std::string, std::size_t> size;
  std::map<std::string, double> error;
  for (const std::string quality : {"", "quality:95", "quality:50", "quality:5"}) {
    SinkRequest r = request(folder.file("a.jpg"), {{"", picture}});
    r.compression = quality;
    write(r, {{"", picture}});
    size[quality] = content(r.path).size();
    const Raster read = read_image(r.path, "a.jpg").raster;
    double sum = 0;
    for (int p = 0; p < 3; ++p)
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
          sum += std::abs(read.value(p, 0, x, y) - std::min(1.0, picture.value(p, 0, x, y)));
    error[quality] = sum;
  }
  EXPECT_GT(size[""], size["quality:95"]);
  EXPECT_GT(size["quality:95"], size["quality:50"]);
  EXPECT_GT(size["quality:50"], size["quality:5"]);
  EXPECT_LT(error[""], error["quality:50"]);
  EXPECT_LT(error["quality:50"], error["quality:5"]);
}

// Files that are cut, empty, of noise, or that promise more than there is: always an error, never a picture
// or a crash.
TEST(ImageFiles, BrokenFilesAreErrors) {
  const test::TempFolder folder;
  const Raster picture = ramp({0, 0, 64, 64}, rgb);
  for (const std::string name : {"a.png", "a.exr", "a.tif", "a.hdr", "a.jpg"}) {
    write(request(folder.file(name), {{"", picture}}), {{"", picture}});
    const std::string whole = content(folder.file(name));
    for (const double part : {0.0, 0.02, 0.3, 0.7, 0.9}) {
      folder.write(name, whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
      EXPECT_EQ(error_of<NodeError>([&] { read_image(folder.file(name), name); }).first, "malformed_file")
          << name << " " << part;
    }
    folder.write(name, "not a picture at all");
    EXPECT_EQ(error_of<NodeError>([&] { read_image(folder.file(name), name); }).first, "malformed_file")
        << name;
  }
  EXPECT_EQ(error_of<WorldError>([&] { read_image(folder.file("none.png"), "none.png"); }),
            (std::pair<std::string, std::string>{"cannot_read_file",
                                                 "cannot read none.png: No such file or directory"}));
  EXPECT_EQ(error_of<WorldError>([&] { read_image(folder.path(), "folder"); }).first, "cannot_read_file");
}

// A PNG of 33 bytes that claims a million pixels squared (with a wrong checksum and with a right one it is
// no picture).
TEST(ImageFiles, AHeaderThatLiesAboutItsSizeIsAnError) {
  const test::TempFolder folder;
  const std::string huge(
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\x0f\x42\x40\0\x0f\x42\x40\x08\x02\0\0\0\x5d\xf7\x6e\x3e", 33);
  folder.write("huge.png", huge);
  bool refused = false;
  try {
    read_image(folder.file("huge.png"), "huge.png");
  } catch (const NodeError&) {
    refused = true;
  } catch (const WorldError&) {
    refused = true;
  }
  EXPECT_TRUE(refused);
}

TEST(ImageFiles, ASubimageThatIsNotThereIsSaid) {
  const test::TempFolder folder;
  const Raster picture = ramp({0, 0, 4, 4}, rgb);
  write(request(folder.file("a.exr"), {{"", picture}}), {{"", picture}});
  EXPECT_THAT(error_of<NodeError>([&] { read_image(folder.file("a.exr"), "a.exr", 1); }).second,
              HasSubstr("no subimage 1"));
}

// TIFF 6.0, tag 274: a picture of two rows, stored turned; upright it always shows the same.
TEST(ImageFiles, ATurnedPictureIsReadUpright) {
  const test::TempFolder folder;
  const char* rows[9][3] = {{},
                            {"ab", "cd", "ef"},
                            {"ba", "dc", "fe"},
                            {"fe", "dc", "ba"},
                            {"ef", "cd", "ab"},
                            {"ace", "bdf"},
                            {"bdf", "ace"},
                            {"fdb", "eca"},
                            {"eca", "fdb"}};
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const int w = orientation < 5 ? 2 : 3, h = 5 - w;
    const Raster stored(Frame{.window = {0, 0, w, h}, .planes = rgb});
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        stored.view().row<float>(0, 0, y)[x] = static_cast<float>(rows[orientation][y][x]) / 255.0f;
    SinkRequest r = request(folder.file("t.tif"), {{"", stored}});
    r.bits = 8, r.compression = "none";
    write(r, {{"", stored}});
    std::string bytes = content(folder.file("t.tif"));
    // The entry of tag 274 (0x0112), type SHORT (3), count 1, and its value.
    const std::string entry("\x12\x01\x03\x00\x01\x00\x00\x00\x01\x00", 10);
    const std::size_t at = bytes.find(entry);
    ASSERT_NE(at, std::string::npos);
    bytes[at + 8] = static_cast<char>(orientation);
    folder.write("t.tif", bytes);
    const Raster back = read_image(folder.file("t.tif"), "t.tif").raster;
    ASSERT_EQ(back.frame().window, (Rect{0, 0, 2, 3})) << orientation;
    std::string seen;
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 2; ++x) seen += static_cast<char>(std::lround(back.at<float>(0, 0, x, y) * 255));
    EXPECT_EQ(seen, "abcdef") << orientation;
  }
}

}  // namespace
}  // namespace frustum
