// What `frustum inspect` says as text, made from what it says as JSON.
#pragma once

#include "runtime/core/buffer.h"

#include <cstddef>
#include <string>

namespace frustum::cli {

// The header and the summary of a buffer. Statistics are one row a component ("position.x"), with the space they are in,
// their range, and, under "not finite", a mark for every one that holds NaN or infinities.
std::string buffer_text(const Json& shown);

// Rows of a buffer's table, the first of them numbered `first`; rows with NaN or infinities are marked with "!".
std::string table_text(const Json& table, std::size_t first);

// [{"sample": 0, "R": ...}, ...] as one row each.
std::string samples_text(const Json& samples);

}  // namespace frustum::cli
