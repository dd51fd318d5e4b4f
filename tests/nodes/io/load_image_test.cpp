#include "nodes/io/load_image.h"

#include "nodes/io.h"
#include "runtime/io/image_files.h"
#include "tests/support/run_node.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

using testing::HasSubstr;

const std::string data = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data";

Raster load(const Json& params) {
  return test::run_node(nodes::io_load_image(), params, {}, nullptr, data).at(0).as<Image>()->raster;
}

TEST(LoadImage, ReadsTheTestCard) {
  const Raster card = load({{"file", "card.png"}});
  EXPECT_EQ(card.frame().window, (Rect{0, 0, 96, 64}));
  EXPECT_EQ(card.frame().planes, (PlaneList{{"R"}, {"G"}, {"B"}, {"A"}}));
  EXPECT_EQ(card.frame().color_space, "srgb");
  EXPECT_EQ(card.frame().alpha, Alpha::premultiplied);
  EXPECT_EQ(card.at<float>(0, 0, 13, 0), 1.0f) << "the second bar is yellow";
  EXPECT_EQ(card.at<float>(2, 0, 13, 0), 0.0f);
  EXPECT_EQ(card.at<float>(1, 0, 47, 40), 126.0f / 255) << "the grey ramp";
  // The board is (40, 70, 110) at x = 80, with alpha 255 (1 - 80 / 95) rounded: stored straight, read
  // premultiplied.
  EXPECT_EQ(card.at<float>(3, 0, 80, 48), 40.0f / 255);
  EXPECT_EQ(card.at<float>(0, 0, 80, 48), (40.0f / 255) * (40.0f / 255));
}

TEST(LoadImage, TakesTheSpaceItsUserKnowsBetter) {
  const Raster as_file = load({{"file", "card.png"}}),
               as_p3 = load({{"file", "card.png"}, {"space", "Display P3"}});
  EXPECT_EQ(as_p3.frame().color_space, "display_p3");
  EXPECT_EQ(as_p3.at<float>(1, 0, 30, 30), as_file.at<float>(1, 0, 30, 30)) << "no number changes";
  const auto wrong =
      test::run_error(nodes::io_load_image(), {{"file", "card.png"}, {"space", "srbg"}}, {}, data);
  EXPECT_EQ(wrong.first, "unknown_color_space");
  EXPECT_THAT(wrong.second, HasSubstr("did you mean 'srgb'?"));
}

TEST(LoadImage, TakesALayerByItsName) {
  const test::TempFolder folder;
  const auto layer = [](const PlaneList& planes, float first, std::string space) {
    Frame f{.window = {3, 2, 8, 6}, .planes = planes, .color_space = std::move(space)};
    const Raster r(f);
    for (int p = 0; p < static_cast<int>(planes.size()); ++p)
      for (int y = 2; y < 6; ++y)
        for (int x = 0; x < 5; ++x) {
          const float v = first + static_cast<float>(p) + static_cast<float>(x) / 8;
          if (planes[static_cast<std::size_t>(p)].kind == PlaneKind::u32)
            r.view().row<std::uint32_t>(p, 0, y)[x] = static_cast<std::uint32_t>(v);
          else
            r.view().row<float>(p, 0, y)[x] = v;
        }
    return r;
  };
  const std::vector<std::pair<std::string, Raster>> layers{
      {"", layer({{"R"}, {"G"}, {"B"}}, 0, "lin_ap1")},
      {"albedo", layer({{"R"}, {"G"}, {"B"}, {"A"}}, 10, "lin_ap1")},
      {"N", layer({{"N.x"}, {"N.y"}, {"N.z"}}, 20, "")},
      {"id", layer({{"id", PlaneKind::u32}}, 30, "")}};
  SinkRequest request{.path = folder.file("a.exr"),
                      .region = {3, 2, 8, 6},
                      .display_window = {0, 0, 10, 10},
                      .layers = {},
                      .bits = 32,
                      .compression = {},
                      .metadata = {}};
  std::vector<Tile> tiles;
  for (const auto& [name, raster] : layers) {
    request.layers.push_back({name, raster.frame()});
    tiles.push_back(raster.view());
  }
  const auto sink = open_image_sink(request);
  sink->write(tiles);
  sink->finish();

  const auto load_layer = [&](const char* name) {
    return test::run_node(nodes::io_load_image(), {{"file", "a.exr"}, {"layer", name}}, {}, nullptr,
                          folder.path())
        .at(0)
        .as<Image>()
        ->raster;
  };
  const Raster albedo = load_layer("albedo");
  EXPECT_EQ(albedo.frame().planes, (PlaneList{{"R"}, {"G"}, {"B"}, {"A"}}));
  EXPECT_EQ(albedo.frame().window, (Rect{3, 2, 8, 6}));
  EXPECT_EQ(albedo.frame().color_space, "lin_ap1");
  EXPECT_EQ(albedo.frame().alpha, Alpha::premultiplied);
  EXPECT_EQ(albedo.at<float>(1, 0, 4, 3), 11.125f);
  const Raster normal = load_layer("N");
  EXPECT_EQ(normal.frame().planes, (PlaneList{{"N.x"}, {"N.y"}, {"N.z"}}));
  EXPECT_EQ(normal.frame().color_space, "");
  EXPECT_EQ(normal.at<float>(2, 0, 3, 2), 22.0f);
  EXPECT_EQ(load_layer("id").at<std::uint32_t>(0, 0, 7, 5), 30u);
  EXPECT_EQ(load_layer("").frame().planes.size(), 11u);
  const auto wrong =
      test::run_error(nodes::io_load_image(), {{"file", "a.exr"}, {"layer", "albdeo"}}, {}, folder.path());
  EXPECT_EQ(wrong.first, "unknown_layer");
  EXPECT_THAT(wrong.second, HasSubstr("; did you mean 'albedo'?"));
}

TEST(LoadImage, SaysWhatCannotBeRead) {
  EXPECT_EQ(test::run_error(nodes::io_load_image(), Json::object()).first, "no_file");
  EXPECT_EQ(test::run_error(nodes::io_load_image(), {{"file", "none.png"}}, {}, data).first,
            "cannot_read_file");
  EXPECT_EQ(test::run_error(nodes::io_load_image(), {{"file", "teapot.json"}}, {}, data).first,
            "malformed_file");
  EXPECT_EQ(test::run_error(nodes::io_load_image(), {{"file", "card.png"}, {"subimage", 1}}, {}, data).first,
            "malformed_file");
}

}  // namespace
}  // namespace frustum
