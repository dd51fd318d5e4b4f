#pragma once

#include "runtime/io/image_files.h"

namespace frustum::oiio {

ImageFile read(const std::string& path, std::string_view name, int subimage);

}  // namespace frustum::oiio
