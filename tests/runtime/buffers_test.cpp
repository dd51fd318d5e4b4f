// Buffers as evidence: health, statistics, digests and tables of every kind.
#include "runtime/buffers/fragments.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/numbers.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/surface.h"
#include "runtime/buffers/texture.h"
#include "runtime/buffers/value.h"
#include "runtime/core/param.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <map>

namespace frustum {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

template <class T>
Buffer buffer(T value) {
  return std::make_shared<const T>(std::move(value));
}

// A unit square in the xy plane, of two triangles.
Mesh square() {
  const glm::vec3 p[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const glm::uvec3 t[] = {{0, 1, 2}, {0, 2, 3}};
  Mesh m;
  m.columns = {Column::make<glm::vec3>("position", Domain::vertex, p, Space::object),
               Column::make<glm::uvec3>("triangle", Domain::face, t)};
  return m;
}

TEST(Scan, FindsEachKindWhereverItStands) {
  for (const std::size_t n : {1u, 255u, 256u, 257u, 1000u})
    for (const std::size_t at : {std::size_t{0}, n / 2, n - 1})
      for (const float bad : {nan, inf, -inf, -nan}) {
        std::vector<float> v(n, -std::numeric_limits<float>::max());
        v[at] = bad;
        const Scan s = scan(std::span<const float>(v));
        EXPECT_EQ(s.nan, std::isnan(bad) ? 1u : 0u);
        EXPECT_EQ(s.positive_infinity, bad == inf ? 1u : 0u);
        EXPECT_EQ(s.negative_infinity, bad == -inf ? 1u : 0u);
        EXPECT_EQ(s.first, at);
        const std::vector<double> d(v.begin(), v.end());
        EXPECT_EQ(scan(std::span<const double>(d)).first, at);
      }
}

TEST(Scan, NamesTheFirstOfManyInABlockThatIsScannedInParallel) {
  std::vector<float> v(3'000'000, 1.0f);
  for (const std::size_t at : {2'999'999u, 1'700'003u, 900'001u}) v[at] = nan;
  v[2'000'000] = inf;
  const Scan s = scan(std::span<const float>(v));
  EXPECT_EQ(s.nan, 3u);
  EXPECT_EQ(s.positive_infinity, 1u);
  EXPECT_EQ(s.first, 900'001u);
}

TEST(Statistics, AreThoseOfTheFiniteValues) {
  const Statistics s = measure(std::vector<float>{4, nan, 1, 3, inf, 2, 5, 1e-40f});
  EXPECT_EQ(s.count, 6u);
  EXPECT_EQ(s.nan, 1u);
  EXPECT_EQ(s.positive_infinity, 1u);
  EXPECT_EQ(s.denormal, 1u);
  EXPECT_FLOAT_EQ(static_cast<float>(s.min), 1e-40f);
  EXPECT_EQ(s.max, 5);
  EXPECT_DOUBLE_EQ(s.mean, 15.0 / 6);
  EXPECT_EQ(s.percentiles[3], 2);  // rank floor(0.5 * 5) of 0 1 2 3 4 5
  EXPECT_EQ(s.histogram.front(), 1u);
  EXPECT_EQ(s.histogram.back(), 1u);
}

TEST(Statistics, DoNotOverflowAtTheEndsOfDouble) {
  constexpr double big = std::numeric_limits<double>::max();
  const Statistics s = measure(std::vector<double>{big, big, -big, big});
  EXPECT_DOUBLE_EQ(s.mean, big / 2);
  EXPECT_EQ(s.histogram.front(), 1u);
  EXPECT_EQ(s.histogram.back(), 3u);
}

TEST(Statistics, OfNothingAreZeroAndSayNothingOfARange) {
  EXPECT_EQ(to_json(measure(std::vector<float>{nan})), (Json{{"count", 0}, {"nan", 1}}));
}

TEST(JsonNumber, WritesAFloatAsShortAsItCanBeAndWhatJsonLacksAsText) {
  EXPECT_EQ(json_number(0.1f).dump(), "0.1");
  EXPECT_EQ(json_number(nan), "nan");
  EXPECT_EQ(json_number(-std::numeric_limits<double>::infinity()), "-inf");
}

TEST(Column, StartsOnACacheLineAndIsSharedUnderAnotherName) {
  const auto c = Column::make<glm::vec3>("position", Domain::vertex, 5, Space::object);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(c->data()) % 64, 0u);
  const Ref<Column> world = c->renamed("world", Space::world);
  EXPECT_EQ(world->data(), c->data());
  EXPECT_EQ(world->name(), "world");
  EXPECT_EQ(c->space(), Space::object);
  EXPECT_THROW(c->values<glm::vec4>(), std::logic_error);
  EXPECT_THROW(c->values<glm::dvec3>(), std::logic_error);
}

TEST(Column, WidensSilentlyAndNeverNarrows) {
  const float v[] = {0.1f, 2.0f};
  const Ref<Column> single = Column::make<float>("w", Domain::vertex, v);
  const Ref<Column> wide = as_real<double>(single);
  EXPECT_EQ(wide->values<double>()[0], static_cast<double>(0.1f));
  EXPECT_EQ(as_real<float>(single), single);
  try {
    as_real<float>(wide);
    FAIL();
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "narrowing");
  }
}

TEST(Column, TooLargeForAnyMemoryIsAnErrorOfTheWorld) {
  try {
    Column::make<glm::dvec4>("x", Domain::vertex, std::numeric_limits<std::size_t>::max() / 4);
    FAIL();
  } catch (const WorldError& e) {
    EXPECT_EQ(e.code, "out_of_memory");
  }
}

TEST(Mesh, HealthNamesTheVertex) {
  const float w[] = {1, 2, nan, inf};
  const Buffer b = buffer(square().with(Column::make<float>("heat", Domain::vertex, w)));
  const Health h = b.health();
  EXPECT_EQ(h.nan, 1u);
  EXPECT_EQ(h.positive_infinity, 1u);
  EXPECT_EQ(h.first, "column heat, vertex 2");
}

TEST(Mesh, DigestFollowsContentAndNotAddresses) {
  EXPECT_EQ(buffer(square()).digest(), buffer(square()).digest());
  Mesh other = square();
  other.closed = false;
  EXPECT_NE(buffer(square()).digest(), buffer(other).digest());
  const glm::vec3 p[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-0.0f, 1, 0}};
  EXPECT_NE(
      buffer(square()).digest(),
      buffer(square().with(Column::make<glm::vec3>("position", Domain::vertex, p, Space::object))).digest());
}

TEST(Mesh, ValidatesItsInvariants) {
  EXPECT_EQ(square().validate(), "");
  const glm::uvec3 far[] = {{0, 1, 2}, {0, 2, 4}};
  EXPECT_EQ(square().with(Column::make<glm::uvec3>("triangle", Domain::face, far)).validate(),
            "face 1 names a vertex beyond the 4 there are");
  EXPECT_EQ(square().with(Column::make<glm::vec2>("uv", Domain::corner, 5)).validate(),
            "column uv has 5 rows for 6 of domain corner");
  EXPECT_EQ(square().with(Column::make<glm::vec3>("uv", Domain::vertex, 4)).validate(),
            "column uv must be real x 2 on vertices or corners");
  const std::uint32_t ids[] = {0, 1};
  EXPECT_EQ(square().with(Column::make<std::uint32_t>("material", Domain::face, ids)).validate(),
            "face 1 names material 1 of 1");
  EXPECT_EQ(Mesh{}.validate(), "there is no column 'triangle'");
  EXPECT_THROW(Mesh{}.at("position"), NodeError);
}

TEST(Mesh, TableShowsVerticesAndFacesSideBySide) {
  const Mesh m = square();
  const Json t = buffer_type<Mesh>().table(&m, 1, 2);
  EXPECT_EQ(t["columns"][0], "vertex position.x");
  EXPECT_EQ(t["total"], 4);
  EXPECT_EQ(t["rows"], Json::parse("[[1.0,0.0,0.0, 0,2,3], [1.0,1.0,0.0, null,null,null]]"));
}

Raster two_planes(int samples, float value) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = samples;
  pattern->x.assign(static_cast<std::size_t>(samples), 2048);
  pattern->y = pattern->x;
  Raster r(Frame{.window = {-2, 5, 3, 9}, .pattern = pattern, .planes = {{"Z"}, {"id", PlaneKind::u32}}});
  const Tile t = r.view();
  for (int s = 0; s < samples; ++s)
    for (int y = 5; y < 9; ++y)
      for (int x = 0; x < 5; ++x)
        t.row<float>(0, s, y)[x] = value, t.row<std::uint32_t>(1, s, y)[x] = no_face;
  return r;
}

TEST(Pixels, HealthNamesPlanePixelAndSample) {
  const Raster r = two_planes(3, 1);
  r.view().row<float>(0, 1, 7)[4] = nan;
  r.view().row<float>(0, 2, 5)[0] = -inf;
  const Health h = buffer(Visibility{r}).health();
  EXPECT_EQ(h.values, 3u * 20) << "ids are not counted";
  EXPECT_EQ(h.nan, 1u);
  EXPECT_EQ(h.negative_infinity, 1u);
  EXPECT_EQ(h.first, "plane Z, sample 1, pixel 2,7");
}

TEST(Pixels, DigestLeavesThePaddingOut) {
  const Raster a = two_planes(1, 1), b = two_planes(1, 1);
  b.view().row<float>(0, 0, 5)[7] = 3;  // columns 5 to 15 are padding
  EXPECT_EQ(buffer(Image{a}).digest(), buffer(Image{b}).digest());
  b.view().row<float>(0, 0, 5)[4] = 3;
  EXPECT_NE(buffer(Image{a}).digest(), buffer(Image{b}).digest());
  EXPECT_NE(buffer(Image{a}).digest(), buffer(Depth{a}).digest()) << "kinds differ";
}

TEST(Pixels, SummaryCountsSamplesWithoutAFaceApart) {
  const Raster r = two_planes(1, 0.5f);
  r.view().row<std::uint32_t>(1, 0, 6)[2] = 17;
  const Visibility v{r};
  const Json s = buffer_type<Visibility>().summary(&v);
  EXPECT_EQ(s["window"], Json({-2, 5, 3, 9}));
  EXPECT_EQ(s["planes"][0]["mean"], 0.5);
  EXPECT_EQ(s["planes"][1]["no_face"], 19);
  EXPECT_EQ(s["planes"][1]["max"], 17);
  const Json t = buffer_type<Visibility>().table(&v, 7, 1);
  EXPECT_EQ(t["columns"], Json({"x", "y", "Z", "id"}));
  EXPECT_EQ(t["rows"], Json::parse("[[0, 6, 0.5, 17]]"));
  EXPECT_EQ(buffer_type<Visibility>().table(&v, 100, 5)["rows"], Json::array());
}

TEST(Pixels, AnEmptyWindowIsHealthyAndHasNoRows) {
  const Image empty;
  EXPECT_TRUE(buffer(empty).health().finite());
  EXPECT_EQ(buffer_type<Image>().table(&empty, 0, 10)["total"], 0);
  EXPECT_EQ(buffer_type<Image>().summary(&empty)["planes"], Json::array());
}

std::size_t bytes_of_parts(const std::vector<Buffer>& buffers) {
  std::map<const void*, std::size_t> parts;
  for (const Buffer& b : buffers)
    b.type().parts(b.data(), [&](const void* p, std::size_t n) { parts[p] = n; });
  std::size_t sum = 0;
  for (const auto& [p, n] : parts) sum += n;
  return sum;
}

TEST(Parts, SharedColumnsAndRastersCountOnce) {
  const Mesh a = square(), b = a.with(Column::make<float>("heat", Domain::vertex, 4));
  EXPECT_EQ(bytes_of_parts({buffer(a), buffer(b)}), 4u * 12 + 2 * 12 + 4 * 4);
  const Raster r = two_planes(1, 0);
  EXPECT_EQ(bytes_of_parts({buffer(Image{r}), buffer(Visibility{r})}), r.bytes());
}

TEST(Values, ReadLiteralsAndReportWhatIsNone) {
  Diagnostics problems;
  ParamReader reader(problems, "/nodes/n/in/x/value", "");
  EXPECT_EQ(buffer_type<Number>().from_json(2.5, reader).as<Number>()->value, 2.5);
  const Json rows = Json::parse("[[1,2,3,4],[0,1,0,0],[0,0,1,0],[0,0,0,1]]");
  EXPECT_EQ(buffer_type<Matrix>().from_json(rows, reader).as<Matrix>()->value[3][0], 4);
  EXPECT_TRUE(problems.empty());
  EXPECT_FALSE(buffer_type<Number>().from_json("two", reader));
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems.list()[0].pointer, "/nodes/n/in/x/value");
}

TEST(Values, ACameraMayLookToInfinityButNotFromNaN) {
  Camera c;
  c.far_z = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(buffer(c).health().finite());
  c.eye.y = std::nan("");
  EXPECT_EQ(buffer(c).health().first, "camera, eye");
}

TEST(Values, EveryKindIsDescribed) {
  for (const BufferType* t :
       {&buffer_type<Mesh>(), &buffer_type<Image>(), &buffer_type<Depth>(), &buffer_type<Visibility>(),
        &buffer_type<SamplePattern>(), &buffer_type<Camera>(), &buffer_type<LightSet>(),
        &buffer_type<Material>(), &buffer_type<Texture>(), &buffer_type<Surface>(), &buffer_type<Number>(),
        &buffer_type<Matrix>(), &buffer_type<Table>(), &buffer_type<Fragments>()}) {
    EXPECT_FALSE(t->name.empty());
    EXPECT_TRUE(t->doc.ends_with('.')) << t->name;
    EXPECT_THAT(std::string(t->color), testing::MatchesRegex("#[0-9a-f]{6}")) << t->name;
    EXPECT_TRUE(t->bytes && t->hash && t->health && t->summary) << t->name;
  }
}

TEST(Texture, DigestTellsLevelsApart) {
  const MipPyramid one{{{1, 2, std::vector<float>(8, 1.0f)}}}, two{{{2, 1, std::vector<float>(8, 1.0f)}}};
  EXPECT_NE(buffer(Texture{one}).digest(), buffer(Texture{two}).digest());
  MipPyramid bad = one;
  bad.levels[0].rgba[5] = inf;
  EXPECT_EQ(buffer(Texture{bad}).health().first, "level 0, texel 0,1");
  MipPyramid half{{{1, 2, {}}}};
  half.levels[0].half_rgba.assign(8, 0x3C00);  // 1
  EXPECT_NE(buffer(Texture{half}).digest(), buffer(Texture{one}).digest());
  EXPECT_TRUE(buffer(Texture{half}).health().finite());
  EXPECT_EQ(Texture{one}.bytes() - Texture{half}.bytes(), 16u);
  half.levels[0].half_rgba[6] = 0x7C00;  // infinity
  EXPECT_EQ(buffer(Texture{half}).health().first, "level 0, texel 0,1");
}

TEST(Material, ASharedTextureCountsOnceAndItsTexelsAreOfTheDigest) {
  const auto texture = [](float texel) {
    return std::make_shared<const Texture>(MipPyramid{{{8, 8, std::vector<float>(256, texel)}}});
  };
  const auto mesh = [](Ref<Texture> a, Ref<Texture> b) {
    Mesh m;
    m.columns = {Column::make<glm::vec3>("position", Domain::vertex, 0, Space::world),
                 Column::make<glm::uvec3>("triangle", Domain::face, 0)};
    m.materials = std::make_shared<MaterialSet>(
        MaterialSet{{Material{.texture = std::move(a)}, Material{.texture = std::move(b)}}});
    return buffer(m);
  };
  const auto one = texture(0.5f), two = texture(0.5f);
  EXPECT_EQ(mesh(one, two).bytes() - mesh(one, one).bytes(), one->bytes());
  EXPECT_EQ(mesh(one, two).digest(), mesh(one, one).digest()) << "sharing is no content";
  EXPECT_NE(mesh(one, texture(0.25f)).digest(), mesh(one, one).digest());
  EXPECT_FALSE(mesh(one, texture(inf)).health().finite());
  std::size_t sum = 0;
  const Buffer b = mesh(one, one);
  b.type().parts(b.data(), [&](const void*, std::size_t bytes) { sum += bytes; });
  EXPECT_EQ(sum + sizeof(Mesh), b.bytes());
}

TEST(Material, UvColumnsHaveNumbers) {
  EXPECT_EQ(uv_column_name(0), "uv");
  EXPECT_EQ(uv_column_name(12), "uv12");
  for (const char* name : {"uv", "uv1", "uv12"}) EXPECT_TRUE(is_uv_column(name)) << name;
  for (const char* name : {"u", "uvw", "uv0", "uv-1", "uv1a"}) EXPECT_FALSE(is_uv_column(name)) << name;
}

}  // namespace
}  // namespace frustum
