// A buffer as a small picture to look at, and where it differs from another one.
#pragma once

#include "runtime/core/buffer.h"

#include <filesystem>
#include <string>

namespace frustum {

constexpr int thumbnail_width = 320;  // pixels at most

// Writes NAME.png and, with a reference, NAME.error.png (black is no error, white the largest of the
// picture), below `folder`. Colours as an sRGB display shows them, over a checkerboard where
// alpha lets it through, ids in colours of their own, other numbers in grey from least to largest. Buffers that
// are no pixels write nothing. Throws WorldError.
void save_pictures(const std::filesystem::path& folder, const std::string& name, const Buffer& buffer,
                   const Buffer* reference);

// "data:image/png;base64,..." of a file, or an empty text where there is none.
std::string data_uri(const std::filesystem::path& png);

}  // namespace frustum
