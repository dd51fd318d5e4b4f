#include "nodes/io/load_fragments.h"

#include "nodes/io.h"
#include "runtime/io/buffer_files.h"
#include "runtime/io/deep_files.h"
#include "tests/support/run_node.h"
#include "tests/support/temp_file.h"
#include "tests/support/ulps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <limits>
#include <numeric>
#include <sstream>

namespace frustum {
namespace {

using testing::HasSubstr;

const std::string data = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data";

// Lists of 0 to 4 fragments over a window that does not begin at 0, 0.
Fragments lists(int height = 11) {
  test::Random random(3);
  Fragments f{.window = {-3, 2, 14, 2 + height}, .color_space = "lin_rec709"};
  for (std::int64_t i = 0; i < f.window.area(); ++i) f.first.push_back(f.first.back() + random.below(5));
  const auto id = Column::make<std::uint32_t>("id", Domain::vertex, f.count());
  for (auto& v : id->values<std::uint32_t>()) v = static_cast<std::uint32_t>(random.bits());
  f.channels.push_back(id);
  for (const char* name : {"Z", "R", "G", "B", "A", "N.x"}) {
    const auto c = Column::make<float>(name, Domain::vertex, f.count());
    for (float& v : c->values<float>()) v = static_cast<float>(random.uniform());
    f.channels.push_back(c);
  }
  return f;
}

Fragments sorted(Fragments f) {
  std::uint64_t unsorted = 0;
  return in_order_of_depth(std::move(f), unsorted);
}

void expect_same(const Fragments& a, const Fragments& b) {
  EXPECT_EQ(a.window, b.window);
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.color_space, b.color_space);
  ASSERT_EQ(a.channels.size(), b.channels.size());
  for (const Ref<Column>& c : a.channels) {
    const Column* other = b.find(c->name());
    ASSERT_NE(other, nullptr) << c->name();
    EXPECT_EQ(c->kind(), other->kind()) << c->name();
    EXPECT_EQ(std::memcmp(c->data(), other->data(), c->bytes()), 0) << c->name();
  }
}

Ref<Fragments> load(const std::string& file, Context* ctx = nullptr, const std::string& folder = data) {
  return test::run_node(nodes::io_load_fragments(), {{"file", file}}, {}, ctx, folder)[0].as<Fragments>();
}

std::string saved(const Fragments& f, const test::TempFolder& folder) {
  const std::string path = folder.file("deep.exr");
  Context ctx;
  save_buffer_file(Ref<Fragments>(std::make_shared<const Fragments>(f)), {.path = path}, ctx);
  return path;
}

std::string bytes_of_file(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

TEST(LoadFragments, ReadsBackWhatWasWritten) {
  const test::TempFolder folder;
  const Fragments written = sorted(lists());
  Context ctx;
  saved(written, folder);
  expect_same(written, *load("deep.exr", &ctx, folder.path()));
  EXPECT_TRUE(ctx.warnings().empty());
  const std::string first = bytes_of_file(folder.file("deep.exr"));
  saved(*load("deep.exr", nullptr, folder.path()), folder);
  // The order of channels is the file's: by name. All else is the same, and no date is written.
  EXPECT_EQ(bytes_of_file(folder.file("deep.exr")), first);
}

TEST(LoadFragments, PutsListsInTheOrderOfDepthAndSaysSo) {
  const test::TempFolder folder;
  const Fragments unsorted = lists();
  saved(unsorted, folder);
  Context ctx;
  const Ref<Fragments> f = load("deep.exr", &ctx, folder.path());
  expect_same(sorted(unsorted), *f);
  const auto z = f->find("Z")->values<float>();
  for (std::size_t i = 0; i < f->lists(); ++i)
    for (std::size_t k = f->of_list(i).begin; k + 1 < f->of_list(i).end; ++k) ASSERT_LE(z[k], z[k + 1]);
  ASSERT_EQ(ctx.warnings().size(), 1u);
  EXPECT_EQ(ctx.warnings()[0].first, "fragments_sorted");
}

TEST(LoadFragments, EqualDepthsKeepTheirOrderAndNaNIsLast) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> z{nan, 2, 1, 2, 1};
  const std::vector<std::uint32_t> id{0, 1, 2, 3, 4};
  Fragments f{.window = {0, 0, 1, 1}, .first = {0, 5}};
  f.channels = {Column::make<float>("Z", Domain::vertex, z),
                Column::make<std::uint32_t>("id", Domain::vertex, id)};
  const Fragments in_order = sorted(std::move(f));
  const auto ids = in_order.find("id")->values<std::uint32_t>();
  EXPECT_EQ(std::vector<std::uint32_t>(ids.begin(), ids.end()), (std::vector<std::uint32_t>{2, 4, 1, 3, 0}));
}

TEST(LoadFragments, RangesOfDepthThatOverlapAreCounted) {
  const std::vector<float> z{1, 2, 1, 2}, back{2, 3, 2.5F, 3};
  Fragments f{.window = {0, 0, 2, 1}, .first = {0, 2, 4}};
  f.channels = {Column::make<float>("Z", Domain::vertex, z),
                Column::make<float>("ZBack", Domain::vertex, back)};
  EXPECT_EQ(overlapping_lists(f), 1u);
}

// Made with OpenEXR's own tiled writer: 24 x 17 pixels in tiles of 8 x 8, (x + y) mod 4 fragments, half colours.
TEST(LoadFragments, ReadsTilesAsItReadsRows) {
  const Ref<Fragments> f =
      load("deep_tiles.exr", nullptr, std::string(FRUSTUM_SOURCE_DIR) + "/tests/nodes/io");
  ASSERT_EQ(f->window, (Rect{5, -2, 29, 15}));
  for (int y = -2; y < 15; ++y)
    for (int x = 5; x < 29; ++x) {
      const auto [begin, end] = f->of_pixel(x, y);
      ASSERT_EQ(end - begin, static_cast<std::size_t>((x + y + 4) % 4)) << x << ", " << y;
      for (std::size_t i = begin; i < end; ++i) {
        const auto layer = static_cast<float>(i - begin);
        ASSERT_EQ(f->find("Z")->values<float>()[i], 1 + layer);
        ASSERT_EQ(f->find("R")->values<float>()[i], static_cast<float>(x) / 32);
        ASSERT_EQ(f->find("A")->values<float>()[i], 0.5F);
        ASSERT_EQ(f->find("id")->values<std::uint32_t>()[i], static_cast<std::uint32_t>(100 * (y + 2) + x));
      }
    }
}

TEST(LoadFragments, SaysWhatIsWrongWithAFile) {
  const test::TempFolder folder;
  const auto problem = [&](const std::string& file, const std::string& where) {
    return test::run_error(nodes::io_load_fragments(), {{"file", file}}, {}, where);
  };
  EXPECT_EQ(problem("card.png", data).first, "not_deep");
  EXPECT_EQ(problem(folder.write("text.exr", "no EXR file"), folder.path()).first, "malformed_file");
  EXPECT_EQ(problem("nothing.exr", data).first, "cannot_read_file");
  EXPECT_EQ(test::run_error(nodes::io_load_fragments(), nlohmann::json::object()).first, "no_file");
  const std::string whole = bytes_of_file(saved(lists(), folder));
  folder.write("cut.exr", std::string_view(whole).substr(0, whole.size() / 2));
  const auto cut = problem("cut.exr", folder.path());
  EXPECT_EQ(cut.first, "malformed_file");
  EXPECT_THAT(cut.second, HasSubstr("cut.exr"));
}

// A width of 2^30 px in a file of a few KiB: nothing is taken for it.
TEST(LoadFragments, ALyingWindowIsRefusedBeforeItsMemoryIsTaken) {
  const test::TempFolder folder;
  std::string bad = bytes_of_file(saved(sorted(lists()), folder));
  const std::string_view key("dataWindow\0box2i\0", 17);
  const std::size_t at = bad.find(key);
  ASSERT_NE(at, std::string::npos);
  const std::int32_t x_max = 1 << 30;
  std::memcpy(bad.data() + at + key.size() + 4 + 8, &x_max, sizeof x_max);
  const std::string path = folder.write("bad.exr", bad);
  Context ctx;
  try {
    read_deep_file(path, "bad.exr", 0, ctx);
    ADD_FAILURE() << "a picture of 2^30 columns";
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "malformed_file");
    EXPECT_THAT(e.what(), HasSubstr("bad.exr"));
  }
  EXPECT_EQ(ctx.claimed(), 0u);
}

// The file is written and read 64 rows at a time.
TEST(LoadFragments, APictureOfManyBandsReadsBack) {
  const test::TempFolder folder;
  const Fragments tall = lists(193);
  std::uint64_t unsorted = 0;
  Context ctx;
  expect_same(sorted(tall), in_order_of_depth(read_deep_file(saved(tall, folder), "tall", 0, ctx), unsorted));
}

Ref<Fragments> wide_numbers(int height) {
  Fragments f = lists(height);
  const auto c = Column::make<double>("area", Domain::vertex, f.count());
  std::iota(c->values<double>().begin(), c->values<double>().end(), 0.25);
  f.channels.push_back(c);
  return std::make_shared<const Fragments>(std::move(f));
}

TEST(LoadFragments, WideNumbersAreRoundedInEveryBand) {
  const test::TempFolder folder;
  const Ref<Fragments> f = wide_numbers(150);
  const Fragments back = [&] {
    Context ctx;
    return read_deep_file(saved(*f, folder), "wide", 0, ctx);
  }();
  const Column* area = back.find("area");
  ASSERT_NE(area, nullptr);
  for (std::size_t i = 0; i < area->rows(); ++i)
    ASSERT_EQ(area->values<float>()[i], static_cast<float>(0.25 + static_cast<double>(i)));
}

TEST(LoadFragments, AWriterThatIsCancelledLeavesNoFile) {
  const test::TempFolder folder;
  CancelFlag cancel;
  cancel.cancel();
  Context ctx;
  ctx.cancel = &cancel;
  EXPECT_THROW(save_buffer_file(Buffer(wide_numbers(150)), {.path = folder.file("deep.exr")}, ctx),
               Cancelled);
  EXPECT_FALSE(std::filesystem::exists(folder.file("deep.exr")));
  const std::string whole = saved(lists(150), folder);
  EXPECT_THROW(read_deep_file(whole, "deep.exr", 0, ctx), Cancelled);
}

// A band of 64 rows of 17 pixels: a count and a pointer a channel for each, and the numbers that are narrowed.
TEST(LoadFragments, AWriterAsksForTheMemoryOfABand) {
  const test::TempFolder folder;
  const Ref<Fragments> f = wide_numbers(150);
  Context ctx;
  save_buffer_file(Buffer(f), {.path = folder.file("deep.exr")}, ctx);
  const std::uint64_t pixels = 64 * 17, lists = pixels * (4 + 8 * f->channels.size());
  EXPECT_GT(ctx.claimed(), lists + f->count() / 3 * 4);
  EXPECT_LT(ctx.claimed(), lists + f->count() * 4);

  const test::TempFolder other;
  Context poor;
  poor.admit = [&](std::uint64_t all) {
    if (all > lists) throw NodeError("memory", "too much");
  };
  EXPECT_THROW(save_buffer_file(Buffer(f), {.path = other.file("deep.exr")}, poor), NodeError);
  EXPECT_FALSE(std::filesystem::exists(other.file("deep.exr")));
}

TEST(LoadFragments, SeveralSamplesAPixelDoNotGoIntoTheFormat) {
  const test::TempFolder folder;
  Fragments f{.window = {0, 0, 1, 1}, .first = {0, 0, 0}};
  SamplePattern two{2, 1, {0, 1}, {0, 1}};
  f.pattern = std::make_shared<const SamplePattern>(two);
  try {
    saved(f, folder);
    ADD_FAILURE() << "two lists a pixel";
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "format_cannot_hold");
  }
}

}  // namespace
}  // namespace frustum
