// What --memory refuses.
#pragma once

#include <cstdint>

namespace frustum {

// Throws NodeError("memory") where `live` bytes and `further` ones are more than the limit; 0 is no limit.
void check_memory_limit(std::uint64_t live, std::uint64_t further, std::uint64_t limit);

}  // namespace frustum
