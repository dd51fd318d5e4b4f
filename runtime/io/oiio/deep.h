#pragma once

#include "runtime/io/deep_files.h"

namespace frustum::oiio {

Fragments read_deep(const std::string& path, std::string_view name, int part, Context& ctx);
void write_deep(const Fragments& fragments, const SaveRequest& request, Context& ctx);

}  // namespace frustum::oiio
