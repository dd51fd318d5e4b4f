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
