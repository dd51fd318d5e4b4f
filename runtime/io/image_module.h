// What the image module gives: one object behind one C symbol.
#pragma once

#include "runtime/core/temporary_files.h"
#include "runtime/io/deep_files.h"
#include "runtime/io/image_files.h"
#include "runtime/io/sink_plan.h"

namespace frustum {

class ImageModule {
 public:
  virtual ~ImageModule() = default;
  virtual ImageFile read(const std::string& path, std::string_view name, int subimage) const = 0;
  virtual ImageFile read_bytes(std::string_view bytes, std::string_view name) const = 0;
  virtual std::unique_ptr<Sink> open(const SinkRequest&, const SinkPlan&) const = 0;
  // A PNG in memory, of planes R G B or R G B A of f32 in sRGB, straight; 8 or 16 bits a channel.
  virtual std::string encode_png(const Raster&, int bits, std::string_view name) const = 0;
  virtual RemoveTemporaryFiles temporary_files() const = 0;  // of the module's own copy
  virtual Fragments read_deep(const std::string& path, std::string_view name, int part,
                              Context& ctx) const = 0;
  virtual void write_deep(const Fragments&, const SaveRequest&, Context&) const = 0;
};

// The module, opened at the first call. Throws WorldError("no_image_module").
const ImageModule& image_module();

constexpr const char* image_module_file = "frustum_oiio.so";
constexpr const char* image_module_symbol = "frustum_image_module";
using ImageModuleEntry = const ImageModule* (*)();

}  // namespace frustum
