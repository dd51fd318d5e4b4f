#include "nodes/kernels/any_seen.h"

#include <gtest/gtest.h>

#include <vector>

namespace frustum {
namespace {

TEST(AnySeen, FindsTheOnlyFaceWhereverItStands) {
  for (std::size_t n = 0; n < 200; ++n) {
    std::vector<std::uint32_t> id(n + 1, ~0u);
    id[n] = 0;  // beyond the row
    EXPECT_FALSE(kernels::any_seen(id.data(), n)) << n;
    for (std::size_t x = 0; x < n; ++x) {
      for (const std::uint32_t face : {0u, ~0u - 1}) {
        id[x] = face;
        EXPECT_TRUE(kernels::any_seen(id.data(), n)) << x << " of " << n;
      }
      id[x] = ~0u;
    }
  }
}

}  // namespace
}  // namespace frustum
