#include "runtime/app/metrics/metrics.h"

#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/error.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

using test::TempFolder;
using testing::HasSubstr;
constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();

// One row of one plane.
Raster row(std::initializer_list<float> values, const char* plane = "R") {
  Raster r(Frame{{0, 0, static_cast<int>(values.size()), 1}, nullptr, {{plane, PlaneKind::f32}}});
  if (values.size() > 0) std::copy(values.begin(), values.end(), r.view().row<float>(0, 0, 0));
  return r;
}

// 24 x 24 linear colours: f(x, y, channel).
template <class F>
Raster picture(F f) {
  Raster r(Frame{{0, 0, 24, 24}, nullptr, {{"R"}, {"G"}, {"B"}}, std::string(linear_rec709)});
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) r.view().row<float>(c, 0, y)[x] = static_cast<float>(f(x, y, c));
  return r;
}

Raster gradient() {
  return picture([](int x, int y, int c) { return 0.1 + 0.02 * x + 0.01 * y + 0.05 * c; });
}

double value(const Raster& a, const Raster& b, const std::string& metric) {
  const std::vector<std::string> names{metric};
  return measure(a, b, names).values.at(metric);
}

bool holds_for(const Raster& a, const Raster& b, const MetricBound& bound) {
  const std::vector<std::string> names{bound.metric};
  return holds(measure(a, b, names), bound);
}

TEST(Metrics, NumbersByHand) {
  const Difference d = compare(row({0, 1, 2, 3}), row({0, 1, 2.5f, 1}));
  EXPECT_EQ(d.values, 4u);
  EXPECT_EQ(d.differing, 2u);
  EXPECT_EQ(d.max, 2.0);
  EXPECT_EQ(d.rmse, std::sqrt((0.25 + 4) / 4));
  EXPECT_DOUBLE_EQ(d.mrse, (std::pow(0.5 / 2.51, 2) + std::pow(2 / 1.01, 2)) / 4);
  EXPECT_NEAR(d.psnr, 10 * std::log10(4 / 4.25), 1e-12);
  ASSERT_TRUE(d.worst);
  EXPECT_EQ(d.worst->x, 3);
  EXPECT_EQ(d.worst->a, 3);
  EXPECT_EQ(d.worst->place(), "R at 3,0");
  EXPECT_FALSE(d.identical());
}

TEST(Metrics, EqualPicturesAreIdenticalAndHaveInfinitePsnr) {
  const Difference d = compare(row({0, inf, -1}), row({0, inf, -1}));
  EXPECT_TRUE(d.identical());
  EXPECT_EQ(d.rmse, 0);
  EXPECT_EQ(d.psnr, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(holds_for(row({0, inf, -1}), row({0, inf, -1}), {"psnr", 100}));
}

TEST(Metrics, ZerosOfBothSignsAreEqualButNotIdentical) {
  const Difference d = compare(row({0.0f}), row({-0.0f}));
  EXPECT_EQ(d.max, 0);
  EXPECT_EQ(d.ulps.max, 0u);
  EXPECT_EQ(d.differing, 1u);
  EXPECT_FALSE(holds_for(row({0.0f}), row({-0.0f}), {"identical"}));
  EXPECT_TRUE(holds_for(row({0.0f}), row({-0.0f}), {"max", 0}));
}

TEST(Metrics, UlpsCountTheNumbersBetween) {
  const float next = std::nextafter(1.0f, 2.0f), far = 1 + 100 * std::numeric_limits<float>::epsilon();
  const Difference d = compare(row({1, next, far, inf}), row({1, 1, 1, 1}));
  EXPECT_EQ(d.ulps.bins[0], 1u);
  EXPECT_EQ(d.ulps.bins[1], 1u);
  EXPECT_EQ(d.ulps.bins[7], 1u) << "100 lies in [64, 128)";
  EXPECT_EQ(d.ulps.bins[65], 1u);
  EXPECT_EQ(d.ulps.max, UlpHistogram::infinite);
  constexpr float least = std::numeric_limits<float>::denorm_min();
  EXPECT_EQ(ulps_between(-least, least), 2u) << "through both zeros, which are one number";
  EXPECT_EQ(ulps_between(std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()),
            2 * 0x7fefffffffffffffULL);
  EXPECT_EQ(to_json(d)["ulps"]["histogram"]["64-127"], 1);
}

TEST(Metrics, ADoubleIsMeasuredAgainstAFloatInFloats) {
  Raster b(Frame{{0, 0, 1, 1}, nullptr, {{"R", PlaneKind::f64}}});
  b.view().row<double>(0, 0, 0)[0] = 0.1;
  EXPECT_EQ(compare(row({0.1f}), b).ulps.max, 0u);
  EXPECT_EQ(compare(row({std::nextafter(0.1f, 1.0f)}), b).ulps.max, 1u);
}

TEST(Metrics, NanPassesNoMetricEvenAgainstTheSameNan) {
  const auto broken_at = [](bool both) {
    Raster r = gradient();
    r.view().row<float>(1, 0, 7)[3] = nan;
    return std::pair{r, both ? r : gradient()};
  };
  for (const bool both : {false, true}) {
    const auto [a, b] = broken_at(both);
    for (const Metric& metric : metrics()) {
      const Measured m = measure(a, b, std::vector{std::string(metric.name)});
      EXPECT_EQ(m.difference.nan, 1u);
      EXPECT_FALSE(
          holds(m, {std::string(metric.name), metric.at_least ? 0 : std::numeric_limits<double>::infinity()}))
          << metric.name;
    }
    EXPECT_EQ(count_beyond(a, b, 1e30), 1u);
  }
  const auto [a, b] = broken_at(false);
  EXPECT_EQ(compare(a, b).worst->place(), "G at 3,7");
  EXPECT_TRUE(std::isinf(error_map(a, b)[7 * 24 + 3]));
}

// Every metric accepts equal pictures at its strictest bound, and refuses a changed one at a bound just below
// what it measures: no metric is a constant.
TEST(Metrics, EachHoldsForTheSameAndFailsForADifferentPicture) {
  const Raster same = gradient();
  const Raster other = picture([](int x, int y, int c) {
    return 0.1 + 0.02 * x + 0.01 * y + 0.05 * c + (x == 5 && y == 6 ? 0.3 : 0.004 * c);
  });
  for (const Metric& metric : metrics()) {
    const std::string name(metric.name);
    if (name == "wrong_ids") continue;
    EXPECT_TRUE(holds_for(same, same, {name, name == "psnr" ? 300.0 : metric.at_least ? 1.0 : 0.0})) << name;
    const double v = value(other, same, name);
    EXPECT_FALSE(holds_for(other, same, {name, metric.at_least ? v + 1e-6 : v * (1 - 1e-6)})) << name;
    EXPECT_EQ(holds_for(other, same, {name, v}), !metric.yes_or_no) << name;
  }
}

TEST(Metrics, IdsAreRightOrWrong) {
  const auto visible = [](std::uint32_t id, float z) {
    Raster r(Frame{{0, 0, 2, 1}, nullptr, {{"id", PlaneKind::u32}, {"Z"}}});
    r.view().row<std::uint32_t>(0, 0, 0)[0] = id;
    r.view().row<float>(1, 0, 0)[0] = z;
    return r;
  };
  const std::vector<std::string> names{"rmse", "wrong_ids"};
  const Measured m = measure(visible(7, 0.5f), visible(4'000'000'000u, 0.5f), names);
  EXPECT_EQ(m.difference.ids, 2u);
  EXPECT_EQ(m.difference.wrong_ids, 1u);
  EXPECT_EQ(m.difference.rmse, 0) << "the distance of two ids means nothing";
  EXPECT_EQ(m.difference.worst->plane, "id");
  EXPECT_FALSE(holds(m, {"wrong_ids", 0}));
  EXPECT_TRUE(holds(m, {"wrong_ids", 1}));
  EXPECT_FALSE(holds(m, {"rmse", 1})) << "wrong ids break a bound on numbers";
  const std::vector<MetricBound> both{{"rmse", 1}, {"wrong_ids", 1}};
  EXPECT_TRUE(broken(m, both).empty()) << "unless they have a bound of their own";
  EXPECT_EQ(count_beyond(visible(7, 0), visible(8, 0), 100), 1u);
}

TEST(Metrics, InfinityAgainstANumberIsInfinitelyFar) {
  EXPECT_EQ(compare(row({inf}), row({1})).max, std::numeric_limits<double>::infinity());
  for (const char* metric : {"rmse", "mrse", "max", "ulp"})
    EXPECT_FALSE(holds_for(row({inf}), row({1}), {metric, 1e300})) << metric;
}

TEST(Metrics, SizeSamplesAndPlanesComeFirst) {
  EXPECT_THAT(compare(row({1}), row({1, 2})).mismatch, HasSubstr("windows"));
  EXPECT_THAT(compare(row({1}, "R"), row({1}, "G")).mismatch, HasSubstr("only the first has the planes R"));
  Frame two{
      {0, 0, 1, 1}, std::make_shared<const SamplePattern>(SamplePattern{2, 1, {0, 1}, {0, 1}}), {{"R"}}};
  EXPECT_THAT(compare(row({1}), Raster(two)).mismatch, HasSubstr("samples"));
  EXPECT_FALSE(holds_for(row({1}), row({1, 2}), {"max", 1e9}));
}

TEST(Metrics, PlanesAreMatchedByNameAndMayHaveOtherKinds) {
  Raster a(Frame{{0, 0, 1, 1}, nullptr, {{"R", PlaneKind::f32}, {"id", PlaneKind::u32}}});
  Raster b(Frame{{0, 0, 1, 1}, nullptr, {{"id", PlaneKind::f64}, {"R", PlaneKind::f32}}});
  a.view().row<float>(0, 0, 0)[0] = 0.5f, a.view().row<std::uint32_t>(1, 0, 0)[0] = 4'000'000'000u;
  b.view().row<float>(1, 0, 0)[0] = 0.5f, b.view().row<double>(0, 0, 0)[0] = 4'000'000'000.0;
  EXPECT_TRUE(compare(a, b).identical());
}

TEST(Metrics, NoPixelsAreIdentical) { EXPECT_TRUE(compare(row({}), row({})).identical()); }

TEST(Metrics, CountsWhatIsBeyondATolerance) {
  EXPECT_EQ(count_beyond(row({0, 0, 0}), row({0.1f, 0.2f, 0.3f}), 0.2f), 1u);
}

TEST(Metrics, ColoursNeedAPicture) {
  for (const char* metric : {"ssim", "flip", "delta_e_2000"})
    EXPECT_THROW(value(row({1}, "Z"), row({1}, "Z"), metric), NodeError) << metric;
}

TEST(Metrics, ColoursAreMeasuredInLinearLightWhateverTheSpace) {
  Raster encoded(Frame{{0, 0, 1, 1}, nullptr, {{"R"}, {"G"}, {"B"}}, "srgb"});
  Raster linear(Frame{{0, 0, 1, 1}, nullptr, {{"R"}, {"G"}, {"B"}}, std::string(linear_rec709)});
  for (int c = 0; c < 3; ++c) {
    encoded.view().row<float>(c, 0, 0)[0] = 0.5f;
    linear.view().row<float>(c, 0, 0)[0] = 0.21404114f;
  }
  EXPECT_NEAR(value(encoded, linear, "delta_e_2000"), 0, 1e-3);
  EXPECT_GT(value(linear, linear, "psnr"), 100);
}

Ref<Mesh> triangle(float apex, std::uint32_t last) {
  const std::vector<glm::vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, apex, 0}};
  const std::vector<glm::uvec3> faces{{0, 1, last}};
  Mesh m;
  m.columns = {Column::make<glm::uvec3>("triangle", Domain::face, std::span(faces)),
               Column::make<glm::vec3>("position", Domain::vertex, std::span(positions), Space::world)};
  return std::make_shared<const Mesh>(std::move(m));
}

TEST(Metrics, MeshesAreComparedColumnByColumn) {
  const Difference d = compare(Buffer(triangle(1, 2)), Buffer(triangle(1.5f, 2)));
  EXPECT_EQ(d.max, 0.5);
  EXPECT_EQ(d.worst->place(), "position.y of row 2");
  EXPECT_EQ(compare(Buffer(triangle(1, 2)), Buffer(triangle(1, 1))).wrong_ids, 1u);
  EXPECT_TRUE(compare(Buffer(triangle(nan, 2)), Buffer(triangle(nan, 2))).nan == 1);
  Mesh with_uv = *triangle(1, 2);
  with_uv.columns.push_back(Column::make<glm::vec2>("uv", Domain::vertex, 3));
  EXPECT_THAT(
      compare(Buffer(triangle(1, 2)), Buffer(Ref<Mesh>(std::make_shared<const Mesh>(with_uv)))).mismatch,
      HasSubstr("only the second has the columns vertex uv"));
  EXPECT_THAT(compare(Buffer(triangle(1, 2)), Buffer(Ref<Image>(std::make_shared<const Image>()))).mismatch,
              HasSubstr("kinds"));
}

TEST(Metrics, TablesAreReadFromCsvAndCompared) {
  const TempFolder folder;
  write_text(folder.file("a.csv"), "name,value\r\n\"say \"\"x, y\"\"\",1.5\r\nb,nan\r\n");
  write_text(folder.file("b.csv"), "name,value\r\n\"say \"\"x, y\"\"\",1.0\r\nc,2\r\n");
  const Json a = csv_table(folder.file("a.csv")), b = csv_table(folder.file("b.csv"));
  EXPECT_EQ(a["rows"][0][0], "say \"x, y\"");
  const Difference d = compare_tables(a, b);
  EXPECT_EQ(d.nan, 1u);
  EXPECT_EQ(d.wrong_ids, 1u);
  EXPECT_EQ(compare_tables(b, b).differing, 0u);
  write_text(folder.file("c.csv"), "name,value\r\n1\r\n");
  EXPECT_THROW(csv_table(folder.file("c.csv")), NodeError);
}

TEST(Metrics, BoundsAreReadFromText) {
  EXPECT_EQ(parse_metric_bound("flip=0.25").tolerance, 0.25);
  EXPECT_EQ(parse_metric_bound("identical").metric, "identical");
  for (const char* text : {"rsme=1", "rmse", "rmse=", "rmse=x", "rmse=-1", "rmse=nan", "identical=1", ""})
    EXPECT_THROW(parse_metric_bound(text), NodeError) << text;
}

TEST(Metrics, TheErrorMapIsTheLargestDistanceOfAnyPlane) {
  Raster a = gradient(), b = gradient();
  b.view().row<float>(0, 0, 2)[1] += 0.25f, b.view().row<float>(2, 0, 2)[1] -= 0.5f;
  const auto map = error_map(a, b);
  EXPECT_NEAR(map[2 * 24 + 1], 0.5, 1e-6);
  EXPECT_EQ(map[0], 0);
}

}  // namespace
}  // namespace frustum
