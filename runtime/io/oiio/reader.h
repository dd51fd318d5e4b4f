#pragma once

#include "runtime/io/image_files.h"

namespace frustum::oiio {

ImageFile read(const std::string& path, std::string_view name, int subimage);
ImageFile read_bytes(std::string_view bytes, std::string_view name);

}  // namespace frustum::oiio
