#pragma once

#include "runtime/io/deep_files.h"

namespace frustum::oiio {

Fragments read_deep(const std::string& path, std::string_view name, int part,
                    const std::function<void(std::uint64_t bytes)>& claim);
void write_deep(const Fragments& fragments, const SaveRequest& request);

}  // namespace frustum::oiio
