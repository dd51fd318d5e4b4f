// Files of Bezier patches.
#include "nodes/io/load_patches.h"

#include "runtime/core/context.h"
#include "tests/fuzz/support/check.h"
#include "tests/fuzz/support/target.h"

namespace frustum::fuzz {
namespace {

void read(std::string_view input) {
  reading({"input.json", "input.json"}, [&](Context&) {
    const Surface surface = parse_patches(input, "input.json");
    for (const auto& patch : surface.patches)
      for (const std::uint32_t point : patch)
        require(point < surface.points.size(), "a patch names no point");
  });
}
const Registered patches({"patches", read, {1 << 20, 1024}});

}  // namespace
}  // namespace frustum::fuzz
