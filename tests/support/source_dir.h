// Seen by every test without an include.
#pragma once

namespace frustum::tests {
/// The root of the source tree: absolute, without a slash at its end.
extern const char* const source_dir;
}  // namespace frustum::tests

#define FRUSTUM_SOURCE_DIR (::frustum::tests::source_dir)
