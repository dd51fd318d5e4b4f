#include "nodes/image/over.h"

#include "nodes/image.h"
#include "runtime/buffers/image.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

Ref<Image> constant(const std::vector<float>& rgba, int width = 3, int height = 4) {
  Frame f{.window = {0, 0, width, height}};
  for (std::size_t k = 0; k < rgba.size(); ++k)
    f.planes.push_back({std::string(1, "RGBA"[k]), PlaneKind::f32});
  Raster r(f);
  for (std::size_t k = 0; k < rgba.size(); ++k)
    for (int y = 0; y < height; ++y)
      std::fill_n(r.view().row<float>(static_cast<int>(k), 0, y), width, rgba[k]);
  return std::make_shared<const Image>(Image{std::move(r)});
}

Ref<Image> over(const Ref<Image>& image, const Ref<Image>& under, const Json& params = Json::object()) {
  return test::run_node(nodes::image_over(), params,
                        {{image}, under ? std::vector<Buffer>{under} : std::vector<Buffer>{}})
      .at(0)
      .as<Image>();
}

std::vector<double> pixel(const Image& i, int x, int y) {
  return {i.raster.value(0, 0, x, y), i.raster.value(1, 0, x, y), i.raster.value(2, 0, x, y),
          i.raster.value(3, 0, x, y)};
}

TEST(ImageOver, AddsWhatShowsThrough) {
  const auto out = over(constant({0.25F, 0, 0, 0.5F}), constant({0, 0.5F, 1, 0.5F}));
  EXPECT_EQ(pixel(*out, 1, 1), (std::vector<double>{0.25, 0.25, 0.5, 0.75}));
}

TEST(ImageOver, KeepsTheBitsOfWhatIsOpaqueAndOfWhatIsUnderNothing) {
  const auto a = constant({0.1F, 0.2F, 0.3F, 1}), b = constant({0.4F, 0.5F, 0.6F, 0.7F}),
             none = constant({0, 0, 0, 0});
  EXPECT_EQ(pixel(*over(a, b), 0, 0), pixel(*a, 0, 0));
  EXPECT_EQ(pixel(*over(none, b), 0, 0), pixel(*b, 0, 0));
  EXPECT_EQ(pixel(*over(constant({0.1F, 0.2F, 0.3F}), b), 0, 0), pixel(*a, 0, 0));
}

TEST(ImageOver, RunsThePaperFromTopToBottom) {
  const auto out = over(constant({0, 0, 0, 0}), nullptr, {{"top", 1}, {"bottom", {0, 1, 3}}});
  EXPECT_EQ(pixel(*out, 2, 0), (std::vector<double>{0.875, 1, 1.25, 1}));
  EXPECT_EQ(pixel(*out, 0, 3), (std::vector<double>{0.125, 1, 2.75, 1}));
}

TEST(ImageOver, RefusesAnotherSize) {
  EXPECT_EQ(test::run_error(nodes::image_over(), Json::object(),
                            {{constant({0, 0, 0, 0})}, {constant({0, 0, 0, 0}, 4, 4)}})
                .first,
            "frames_differ");
}

}  // namespace
}  // namespace frustum
