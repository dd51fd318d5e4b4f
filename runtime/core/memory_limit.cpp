#include "runtime/core/memory_limit.h"

#include "runtime/core/error.h"
#include "runtime/core/text.h"

#include <fmt/format.h>

namespace frustum {

void check_memory_limit(std::uint64_t live, std::uint64_t further, std::uint64_t limit) {
  if (limit == 0 || (live <= limit && further <= limit - live)) return;
  throw NodeError(
      "memory", further == 0
                    ? fmt::format("{} are live, above the limit of {}", human_bytes(live), human_bytes(limit))
                    : fmt::format("{} are live and {} more are needed, above the limit of {}",
                                  human_bytes(live), human_bytes(further), human_bytes(limit)));
}

}  // namespace frustum
