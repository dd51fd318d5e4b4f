#include "runtime/core/text.h"

#include <gtest/gtest.h>

namespace frustum {
namespace {

using namespace std::chrono_literals;

TEST(Bytes, AreReadWithPowersOf1024) {
  EXPECT_EQ(parse_bytes("512"), 512u);
  EXPECT_EQ(parse_bytes("512B"), 512u);
  EXPECT_EQ(parse_bytes("2G"), std::uint64_t{2} << 30);
  EXPECT_EQ(parse_bytes("1.5m"), 3u << 19);
  EXPECT_EQ(parse_bytes("64KiB"), 65536u);
  EXPECT_EQ(parse_bytes("0"), 0u);
}

TEST(Bytes, ThatAreNoSizeAreNothing) {
  for (const char* text : {"", "G", "-1G", "1X", "1 G", "nan", "inf", "1e30", "0x10", "2GG"})
    EXPECT_FALSE(parse_bytes(text)) << text;
}

TEST(Bytes, AreWrittenWithOneDecimal) {
  EXPECT_EQ(human_bytes(0), "0 B");
  EXPECT_EQ(human_bytes(1023), "1023 B");
  EXPECT_EQ(human_bytes(1536), "1.5 KiB");
  EXPECT_EQ(human_bytes((1u << 20) - 1), "1.0 MiB");  // not 1024.0 KiB
  EXPECT_EQ(human_bytes(std::uint64_t{3} << 30), "3.0 GiB");
}

TEST(Time, HasTheUnitThatReadsBest) {
  EXPECT_EQ(human_time(12ns), "12 ns");
  EXPECT_EQ(human_time(812us), "812.0 us");
  EXPECT_EQ(human_time(3210ms), "3.21 s");
  EXPECT_EQ(human_time(125s), "2 min 05 s");
  EXPECT_EQ(human_time(2h + 5min), "2 h 05 min");
}

TEST(Columns, AreAlignedAndEndWithoutSpaces) {
  EXPECT_EQ(aligned({{"a", "b"}, {"long", "c"}, {"x", ""}}, 2), "  a     b\n  long  c\n  x\n");
  EXPECT_EQ(aligned({}), "");
}

TEST(Wrapping, BreaksAtSpacesOnly) {
  EXPECT_EQ(wrapped("one two three", 8, 2), "one two\n  three");
  EXPECT_EQ(wrapped("unbreakable", 4, 0), "unbreakable");
  EXPECT_EQ(wrapped("", 4, 0), "");
}

}  // namespace
}  // namespace frustum
