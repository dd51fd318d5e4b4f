#include "runtime/io/image_module.h"
#include "runtime/io/oiio/deep.h"
#include "runtime/io/oiio/reader.h"
#include "runtime/io/oiio/writer.h"

namespace {

class OiioModule : public frustum::ImageModule {
 public:
  frustum::ImageFile read(const std::string& path, std::string_view name, int subimage) const override {
    return frustum::oiio::read(path, name, subimage);
  }
  frustum::ImageFile read_bytes(std::string_view bytes, std::string_view name) const override {
    return frustum::oiio::read_bytes(bytes, name);
  }
  std::unique_ptr<frustum::Sink> open(const frustum::SinkRequest& request,
                                      const frustum::SinkPlan& plan) const override {
    return frustum::oiio::open(request, plan);
  }
  std::string encode_png(const frustum::Raster& picture, int bits, std::string_view name) const override {
    return frustum::oiio::encode_png(picture, bits, name);
  }
  frustum::RemoveTemporaryFiles temporary_files() const override { return frustum::remove_temporary_files; }
  frustum::Fragments read_deep(const std::string& path, std::string_view name, int part,
                               frustum::Context& ctx) const override {
    return frustum::oiio::read_deep(path, name, part, ctx);
  }
  void write_deep(const frustum::Fragments& fragments, const frustum::SaveRequest& request,
                  frustum::Context& ctx) const override {
    frustum::oiio::write_deep(fragments, request, ctx);
  }
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const frustum::ImageModule* frustum_image_module() {
  static const OiioModule module;
  return &module;
}
