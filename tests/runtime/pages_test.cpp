// Memory for large buffers: taken, given back, and taken again.
#include "runtime/core/pages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <utility>

namespace frustum {
namespace {

constexpr std::size_t megabyte = std::size_t{1} << 20;

bool all_zero(const Pages& p) {
  return std::all_of(p.data(), p.data() + p.size(), [](std::byte b) { return b == std::byte{0}; });
}

class KeptPages : public testing::Test {
 protected:
  KeptPages() {
    keep_idle_pages(0);
    keep_idle_pages(64 * megabyte);
  }
  ~KeptPages() override { keep_idle_pages(256 * megabyte); }
};

TEST_F(KeptPages, ABlockGivenBackServesTheNextOfItsSize) {
  const std::byte* first = nullptr;
  {
    const Pages p(5 * megabyte, Contents::anything);
    first = p.data();
  }
  EXPECT_EQ(idle_page_bytes(), 5 * megabyte);
  const Pages again(5 * megabyte - 100, Contents::anything);
  EXPECT_EQ(again.data(), first);
  EXPECT_EQ(again.size(), 5 * megabyte - 100);
  EXPECT_EQ(idle_page_bytes(), 0u);
}

TEST_F(KeptPages, ABlockMuchTooLargeIsLeftForOthers) {
  { const Pages p(8 * megabyte, Contents::anything); }
  const Pages small(5 * megabyte, Contents::anything);
  EXPECT_EQ(idle_page_bytes(), 8 * megabyte);
}

TEST_F(KeptPages, WhatMustBeZeroIsZero) {
  {
    const Pages p(3 * megabyte, Contents::anything);
    std::fill_n(p.data(), p.size(), std::byte{0xFF});
  }
  EXPECT_TRUE(all_zero(Pages(3 * megabyte)));
  EXPECT_TRUE(all_zero(Pages(100)));
}

TEST_F(KeptPages, NoMoreIsKeptThanAllowedAndTheOldestGoFirst) {
  keep_idle_pages(10 * megabyte);
  {
    Pages a(4 * megabyte, Contents::anything), b(5 * megabyte, Contents::anything);
    Pages c(6 * megabyte, Contents::anything);
    a = Pages();
    b = Pages();
    c = Pages();
  }
  EXPECT_EQ(idle_page_bytes(), 6 * megabyte);
  keep_idle_pages(0);
  EXPECT_EQ(idle_page_bytes(), 0u);
}

TEST_F(KeptPages, BlocksAreAlignedAndEmptyOnesAreNothing) {
  const Pages p(12345, Contents::anything);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(p.data()) % 64, 0u);
  EXPECT_EQ(Pages(0).data(), nullptr);
  Pages from(megabyte), to = std::move(from);
  EXPECT_EQ(from.data(), nullptr);
  EXPECT_EQ(to.size(), megabyte);
}

TEST_F(KeptPages, WhatNoSystemHasIsRefused) {
  EXPECT_THROW(Pages(std::size_t{1} << 60, Contents::anything), std::bad_alloc);
}

}  // namespace
}  // namespace frustum
