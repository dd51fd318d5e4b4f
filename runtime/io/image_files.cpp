#include "runtime/io/image_files.h"

#include "runtime/core/error.h"
#include "runtime/io/color_spaces.h"
#include "runtime/io/image_module.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <atomic>
#include <filesystem>

namespace frustum {
namespace {

// bin/frustum finds lib/frustum/frustum_oiio.so beside it, in a build tree as where it is installed.
const ImageModule& load() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto path = program.parent_path().parent_path() / "lib" / "frustum" / image_module_file;
  // Never closed: buffers and exceptions made by its code outlive every call. Local symbols: its copies of
  // ours stay its own.
  void* module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr)
    throw WorldError("no_image_module", fmt::format("cannot load the image library: {}", dlerror()));
  const auto entry = reinterpret_cast<ImageModuleEntry>(dlsym(module, image_module_symbol));
  if (entry == nullptr)
    throw WorldError("no_image_module", fmt::format("{} is not frustum's image library", path.string()));
  const ImageModule& loaded = *entry();
  include_temporary_files(loaded.temporary_files());
  return loaded;
}

std::atomic<bool> is_open{false};

// Programs show the numbers of these formats as they are, so linear light looks too dark.
void warn_of_linear_colors(const SinkRequest& request, const SinkPlan& plan) {
  if (!request.warn || (plan.format != "png" && plan.format != "jpeg")) return;
  const std::string& name = request.layers[0].frame.color_space;
  const ColorSpace* space = find_embedded(name);
  const bool linear = space != nullptr ? !space->data && space->curve == kernels::Curve::linear
                                       : name.starts_with("lin_") || name.starts_with("Linear ");
  if (linear)
    request.warn(
        "display_format_linear",
        fmt::format("{} gets linear colours ({}), which look too dark in a .{} file: color.convert to "
                    "srgb goes before it",
                    request.path, name, plan.format == "png" ? "png" : "jpg"));
}

}  // namespace

const ImageModule& image_module() {
  static const ImageModule& loaded = load();
  is_open = true;
  return loaded;
}
void open_image_module() { image_module(); }
bool image_module_is_open() { return is_open; }

ImageFile read_image(const std::string& path, std::string_view name, int subimage) {
  return image_module().read(path, name, subimage);
}

ImageFile read_image_bytes(std::string_view bytes, std::string_view name) {
  return image_module().read_bytes(bytes, name);
}

std::unique_ptr<Sink> open_image_sink(const SinkRequest& request) {
  const SinkPlan plan = plan_sink(request);
  warn_of_linear_colors(request, plan);
  return image_module().open(request, plan);
}

}  // namespace frustum
