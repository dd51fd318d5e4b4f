// A finished sweep as a part of a page of docs/.
#pragma once

#include "runtime/app/sweep/sweep.h"

#include <filesystem>
#include <string>

namespace frustum {

// Markdown for stdout; the plot as SVG and a few small pictures are written below `images` under names that
// begin with `name`. Links start two folders above `images`, as docs/page.md has it with docs/images/page.
// Throws WorldError.
std::string sweep_markdown(const Sweep&, const std::filesystem::path& images, const std::string& name);

}  // namespace frustum
