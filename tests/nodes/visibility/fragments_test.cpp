#include "nodes/visibility/fragments.h"

#include "nodes/visibility.h"
#include "runtime/buffers/fragments.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/pattern.h"
#include "tests/support/run_node.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

Ref<SamplePattern> pattern_of(int samples) {
  SamplePattern p{samples, 1, {}, {}};
  for (int s = 0; s < samples; ++s) {
    p.x.push_back(static_cast<std::uint16_t>(s)), p.y.push_back(static_cast<std::uint16_t>(4095 - s));
  }
  return std::make_shared<const SamplePattern>(std::move(p));
}

constexpr int width = 5, height = 3;
int length_of(int sample, int x, int y, int layers) { return (7 * x + 3 * y + sample) % (layers + 1); }
std::uint32_t id_of(int layer, int sample, int x, int y) {
  return static_cast<std::uint32_t>(((layer * 10 + sample) * 10 + y) * 10 + x);
}

// Layers whose number at a sample is length_of(), with a plane R that is a thousandth of the id.
std::pair<Ref<Visibility>, Ref<Image>> layers_of(int samples, int layers) {
  Frame f{.window = {2, 1, 2 + width, 1 + height}, .pattern = pattern_of(samples * layers)};
  f.planes = {{"id", PlaneKind::u32}, {"Z", PlaneKind::f32}};
  Raster hits(f);
  f.planes = {{"R", PlaneKind::f32}, {"A", PlaneKind::f64}};
  f.color_space = "lin_rec709";
  Raster color(f);
  for (int l = 0; l < layers; ++l)
    for (int s = 0; s < samples; ++s)
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const bool there = l < length_of(s, x, y, layers);
          const int k = l * samples + s;
          hits.view().row<std::uint32_t>(0, k, y + 1)[x] = there ? id_of(l, s, x, y) : no_face;
          hits.view().row<float>(1, k, y + 1)[x] = there ? static_cast<float>(l) / 8 : 1.0F;
          color.view().row<float>(0, k, y + 1)[x] = static_cast<float>(id_of(l, s, x, y)) / 1000;
          color.view().row<double>(1, k, y + 1)[x] = 0.25 * l;
        }
  return {std::make_shared<const Visibility>(Visibility{hits}), std::make_shared<const Image>(Image{color})};
}

Ref<Fragments> lists_of(int samples, int layers) {
  const auto [hits, color] = layers_of(samples, layers);
  test::NodeInputs in{{Buffer(hits)}, {Buffer(color)}, {}};
  if (samples > 1) in[2] = {Buffer(pattern_of(samples))};
  return test::run_node(nodes::visibility_fragments(), nlohmann::json::object(), in)[0].as<Fragments>();
}

TEST(VisibilityFragments, EveryListHasItsLayersInTheirOrder) {
  for (const int samples : {1, 3})
    for (const int layers : {1, 4}) {
      const Ref<Fragments> f = lists_of(samples, layers);
      EXPECT_EQ(fault_of(*f), "");
      EXPECT_EQ(f->samples(), samples);
      EXPECT_EQ(f->color_space, "lin_rec709");
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          for (int s = 0; s < samples; ++s) {
            const auto [begin, end] = f->of_list(f->list(s, x + 2, y + 1));
            ASSERT_EQ(static_cast<int>(end - begin), length_of(s, x, y, layers));
            for (std::size_t i = begin; i < end; ++i) {
              const int l = static_cast<int>(i - begin);
              EXPECT_EQ(f->find("id")->values<std::uint32_t>()[i], id_of(l, s, x, y));
              EXPECT_EQ(f->find("Z")->values<float>()[i], static_cast<float>(l) / 8);
              EXPECT_EQ(f->find("R")->values<float>()[i], static_cast<float>(id_of(l, s, x, y)) / 1000);
              EXPECT_EQ(f->find("A")->values<double>()[i], 0.25 * l);
            }
          }
    }
}

TEST(VisibilityFragments, TheTableOfAPixelIsItsListsFromTheFront) {
  const Ref<Fragments> f = lists_of(3, 4);
  const auto [begin, end] = f->of_pixel(4, 2);
  const Json table = buffer_type<Fragments>().table(f.get(), begin, end - begin);
  EXPECT_EQ(table["columns"], Json::parse(R"(["x", "y", "sample", "layer", "id", "Z", "R", "A"])"));
  std::size_t row = 0;
  for (int s = 0; s < 3; ++s)
    for (int l = 0; l < length_of(s, 2, 1, 4); ++l, ++row) {
      const Json& cells = table["rows"].at(row);
      EXPECT_EQ(cells[0], 4);
      EXPECT_EQ(cells[1], 2);
      EXPECT_EQ(cells[2], s);
      EXPECT_EQ(cells[3], l);
      EXPECT_EQ(cells[4], id_of(l, s, 2, 1));
    }
  EXPECT_EQ(table["rows"].size(), row);
  EXPECT_EQ(table["total"], f->count());
}

TEST(VisibilityFragments, TheSummaryCountsListsAndFragments) {
  const Ref<Fragments> f = lists_of(1, 4);
  const Json summary = buffer_type<Fragments>().summary(f.get());
  int empty = 0, all = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int n = length_of(0, x, y, 4);
      all += n, empty += n == 0 ? 1 : 0;
    }
  EXPECT_EQ(summary["fragments"], all);
  EXPECT_EQ(summary["lists"], width * height);
  EXPECT_EQ(summary["empty_lists"], empty);
  EXPECT_EQ(summary["longest_list"], 4);
}

TEST(VisibilityFragments, WhatIsOfOtherSamplesIsRefused) {
  const auto [hits, color] = layers_of(2, 3);
  const auto other = layers_of(2, 2).second;
  EXPECT_EQ(test::run_error(nodes::visibility_fragments(), nlohmann::json::object(),
                            {{Buffer(hits)}, {Buffer(other)}, {Buffer(pattern_of(2))}})
                .first,
            "different_frames");
  EXPECT_EQ(test::run_error(nodes::visibility_fragments(), nlohmann::json::object(),
                            {{Buffer(hits)}, {Buffer(color)}, {Buffer(pattern_of(5))}})
                .first,
            "wrong_pattern");
}

TEST(Fragments, FaultsOfTheirShapeAreNamed) {
  Fragments f = *lists_of(1, 4);
  EXPECT_EQ(fault_of(f), "");
  Fragments unsorted = f;
  std::swap(unsorted.first[3], unsorted.first[9]);
  EXPECT_EQ(fault_of(unsorted), "a list ends before it begins");
  Fragments longer = f;
  ++longer.first.back();
  EXPECT_NE(fault_of(longer), "");
  f.window.x1 += 1;
  EXPECT_NE(fault_of(f), "");
}

}  // namespace
}  // namespace frustum
