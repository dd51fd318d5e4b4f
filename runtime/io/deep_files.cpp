#include "runtime/io/deep_files.h"

#include "runtime/core/error.h"
#include "runtime/io/image_module.h"

#include <fmt/format.h>

namespace frustum {

Fragments read_deep_file(const std::string& path, std::string_view name, int part, Context& ctx) {
  return image_module().read_deep(path, name, part, ctx);
}

void write_deep_file(const Fragments& fragments, const SaveRequest& request, Context& ctx) {
  if (fragments.samples() > 1)
    throw NodeError("format_cannot_hold",
                    fmt::format("{}: deep EXR has one list a pixel, and these fragments have {}",
                                request.path, fragments.samples()));
  image_module().write_deep(fragments, request, ctx);
}

}  // namespace frustum
