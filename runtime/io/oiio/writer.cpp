#include "runtime/io/oiio/writer.h"

#include "runtime/core/error.h"
#include "runtime/core/partial_file.h"
#include "runtime/io/primaries.h"

#include <Imath/half.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstring>
#include <new>

namespace frustum::oiio {
namespace {

namespace lib = OIIO;
using Type = SinkChannel::Type;

lib::TypeDesc type_desc(Type t) {
  switch (t) {
    case Type::u8: return lib::TypeDesc::UINT8;
    case Type::u16: return lib::TypeDesc::UINT16;
    case Type::half: return lib::TypeDesc::HALF;
    case Type::u32: return lib::TypeDesc::UINT32;
    case Type::f32: break;
  }
  return lib::TypeDesc::FLOAT;
}

std::size_t bytes_of(Type t) { return t == Type::u8 ? 1 : t == Type::u16 || t == Type::half ? 2 : 4; }

// round(v most), v cut to [0, 1], halves to the even integer; NaN, for which every comparison is false, is 0.
// Exact: the product has at most 40 digits, and adding 1.5 * 2^52 rounds it to an integer (hard case COL-10).
template <class T>
T quantized(float v, double most) {
  constexpr double shifter = 0x1.8p52;
  return v > 0 ? static_cast<T>(v < 1 ? (static_cast<double>(v) * most + shifter) - shifter : most) : T{0};
}

Imath::half to_half(float v) {
  constexpr float largest = 65504;
  return Imath::half(std::isfinite(v) ? std::min(std::max(v, -largest), largest) : v);
}

template <class T>
void store(std::byte* to, T v) {
  std::memcpy(to, &v, sizeof v);
}

void store_as(Type type, float v, std::byte* to) {
  switch (type) {
    case Type::u8: return store(to, quantized<std::uint8_t>(v, 255));
    case Type::u16: return store(to, quantized<std::uint16_t>(v, 65535));
    case Type::half: return store(to, to_half(v));
    case Type::f32: return store(to, v);
    case Type::u32: return store(to, v > 0 ? static_cast<std::uint32_t>(std::min(v, 4294967040.0f)) : 0u);
  }
}

const Primaries* primaries_of(std::string_view space) {
  for (const Primaries& p : known_primaries)
    if (p.linear_space == space) return &p;
  return nullptr;
}

void describe_color(const Frame& frame, const SinkPlan& plan, lib::ImageSpec& spec) {
  // In TIFF a colour space makes the library write an EXIF directory, and then files that it cannot read
  // itself (2.4.7).
  if (frame.color_space.empty() || plan.format == "tiff") return;
  spec.attribute("frustum:colorSpace", frame.color_space);
  if (frame.color_space == "srgb") spec.attribute("oiio:ColorSpace", "sRGB");
  const Primaries* p = primaries_of(frame.color_space);
  if (p == nullptr) return;
  spec.attribute("oiio:ColorSpace", "Linear");
  if (plan.format != "exr") return;
  std::array<float, 8> xy{};
  std::transform(p->xy.begin(), p->xy.end(), xy.begin(), [](double v) { return static_cast<float>(v); });
  spec.attribute("chromaticities", lib::TypeDesc(lib::TypeDesc::FLOAT, 8), xy.data());
}

lib::ImageSpec make_spec(const SinkRequest& r, const SinkPlan& plan) {
  const Rect& w = r.region;
  lib::ImageSpec spec(w.width(), w.height(), static_cast<int>(plan.channels.size()),
                      type_desc(plan.channels[0].type));
  spec.channelnames.clear();
  for (const SinkChannel& c : plan.channels) {
    spec.channelnames.push_back(c.name);
    spec.channelformats.push_back(type_desc(c.type));
  }
  if (std::all_of(spec.channelformats.begin(), spec.channelformats.end(),
                  [&](auto t) { return t == spec.format; }))
    spec.channelformats.clear();
  spec.alpha_channel = plan.alpha;
  if (plan.windows) {
    spec.x = w.x0, spec.y = w.y0;
    const Rect& d = r.display_window;
    spec.full_x = d.x0, spec.full_y = d.y0, spec.full_width = d.width(), spec.full_height = d.height();
  }
  if (plan.format == "jpeg") {
    spec.attribute("compression",
                   plan.compression.empty() ? "jpeg:98" : "jpeg:" + plan.compression.substr(8));
    spec.attribute("jpeg:subsampling", "4:4:4");
  } else if (!plan.compression.empty()) {
    spec.attribute("compression", plan.compression);
  }
  const Frame& main = r.layers[static_cast<std::size_t>(plan.channels[0].layer)].frame;
  if (plan.alpha >= 0 && (plan.straighten || main.alpha == Alpha::straight))
    spec.attribute("oiio:UnassociatedAlpha", 1);
  describe_color(main, plan, spec);
  spec.attribute("DateTime", "");  // else the library writes the time of day, and equal pictures differ
  for (const auto& [key, value] : r.metadata) {
    // TIFF has no names of one's own.
    if (plan.format == "tiff" && key.starts_with("frustum:"))
      spec.attribute("DocumentName", key + " " + value);
    else
      spec.attribute(key, value);
  }
  return spec;
}

// The library's view of a partial file.
class Stream : public lib::Filesystem::IOProxy {
 public:
  Stream(const std::string& path, PartialFile& file) : IOProxy(path, IOProxy::Write), file_(file) {}
  const char* proxytype() const override { return "frustum"; }
  void close() override {}
  bool opened() const override { return true; }
  std::int64_t tell() override { return file_.tell(); }
  bool seek(std::int64_t offset) override { return file_.seek(offset); }
  std::size_t size() const override { return static_cast<std::size_t>(file_.size()); }
  std::size_t read(void* to, std::size_t n) override { return file_.read(to, n); }
  // All of it, in the library's eyes: what failed is known to the file, and libpng would say it on stderr.
  std::size_t write(const void* from, std::size_t n) override {
    file_.write(from, n);
    return n;
  }
  std::size_t pread(void* to, std::size_t n, std::int64_t offset) override {
    return at(offset, [&] { return file_.read(to, n); });
  }
  std::size_t pwrite(const void* from, std::size_t n, std::int64_t offset) override {
    return at(offset, [&] { return file_.write(from, n); });
  }

 private:
  template <class Body>
  std::size_t at(std::int64_t offset, Body&& body) {
    const std::int64_t back = file_.tell();
    const std::size_t n = file_.seek(offset) ? body() : 0;
    file_.seek(back);
    return n;
  }
  PartialFile& file_;
};

class FileSink : public Sink {
 public:
  FileSink(const SinkRequest& request, const SinkPlan& plan)
      : plan_(plan),
        region_(request.region),
        path_(request.path),
        warn_(request.warn),
        file_(request.path),
        stream_(request.path, file_),
        out_(lib::ImageOutput::create(plan.format == "exr" ? "openexr" : plan.format)) {
    if (!out_) fail(lib::geterror());
    const lib::ImageSpec spec = make_spec(request, plan);
    native_ = spec.channelformats.empty() ? spec.format : lib::TypeDesc::UNKNOWN;
    y_offset_ = spec.y - region_.y0;
    next_row_ = region_.y0;
    for (const SinkChannel& c : plan_.channels) {
      offsets_.push_back(pixel_bytes_);
      pixel_bytes_ += bytes_of(c.type);
    }
    if (!out_->set_ioproxy(&stream_)) fail("its writer takes no stream");
    if (!out_->open(request.path, spec)) fail(out_->geterror());
  }
  ~FileSink() override {
    try {
      if (out_ && !finished_ && plan_.format == "png") begin_quietly();
      out_.reset();  // may still write, so before the file
    } catch (...) {  // an unfinished file is removed: what its writer says of it is of no use
    }
  }

  void write(std::span<const Tile> layers) override {
    const Rect band = layers[0].rect();
    row_bytes_ = pixel_bytes_ * static_cast<std::size_t>(band.width());
    data_.resize(row_bytes_ * static_cast<std::size_t>(band.height()));
    tbb::parallel_for(band.y0, band.y1, [&](int y) { fill_row(layers, y); });
    next_row_ = band.y1;
    if (plan_.lost_alpha >= 0) count_see_through(layers[0]);
    guarded([&] {
      return out_->write_scanlines(band.y0 + y_offset_, band.y1 + y_offset_, 0, native_, data_.data());
    });
  }

  void finish() override {
    guarded([&] { return out_->close(); });
    finished_ = true;
    file_.commit();
    if (see_through_ > 0 && warn_)
      warn_(
          "left_out",
          fmt::format("{} has no place for alpha: {} of {} pixels are see-through, and lie over black there",
                      plan_.format, see_through_, region_.area()));
  }

 private:
  // libpng says "No IDATs written into file" on stderr when it is closed before it has put out any pixels.
  // Rows of noise, which does not compress, make it put some out within a few KiB: the file is removed
  // anyway.
  void begin_quietly() {
    const std::size_t row = pixel_bytes_ * static_cast<std::size_t>(region_.width());
    data_.resize(row);
    std::uint32_t state = 1;
    const std::int64_t header = file_.size();
    for (int y = next_row_; y < region_.y1 && file_.size() - header < 64; ++y) {
      for (std::byte& b : data_) b = static_cast<std::byte>((state = state * 1664525u + 1013904223u) >> 24);
      if (!out_->write_scanlines(y + y_offset_, y + 1 + y_offset_, 0, native_, data_.data())) return;
    }
  }

  [[noreturn]] void fail(std::string why) const {
    file_.check();  // says it better
    while (!why.empty() && why.back() == '\n') why.pop_back();
    throw WorldError("cannot_write_file", fmt::format("cannot write {}: {}", path_, why));
  }

  template <class Call>
  void guarded(Call&& call) {
    bool done = false;
    try {
      done = call();
    } catch (const std::exception& e) {
      fail(e.what());
    }
    if (!done) fail(out_->geterror());
    file_.check();
  }

  void count_see_through(const Tile& t) {
    const auto count = [&]<class T>(T) {
      for (int y = t.rect().y0; y < t.rect().y1; ++y) {
        const T* alpha = t.row<const T>(plan_.lost_alpha, 0, y);
        see_through_ += std::count_if(alpha, alpha + t.rect().width(), [](T a) { return a != 1; });
      }
    };
    if (t.frame().planes[static_cast<std::size_t>(plan_.lost_alpha)].kind == PlaneKind::f64)
      count(double{});
    else
      count(float{});
  }

  void fill_row(std::span<const Tile> layers, int y) {
    std::byte* row = data_.data() + row_bytes_ * static_cast<std::size_t>(y - layers[0].rect().y0);
    for (std::size_t c = 0; c < plan_.channels.size(); ++c) {
      const SinkChannel& channel = plan_.channels[c];
      const Tile& t = layers[static_cast<std::size_t>(channel.layer)];
      std::byte* to = row + offsets_[c];
      switch (t.frame().planes[static_cast<std::size_t>(channel.plane)].kind) {
        case PlaneKind::f32: convert<float>(t, channel, layers, y, to); break;
        case PlaneKind::f64: convert<double>(t, channel, layers, y, to); break;
        case PlaneKind::u32: convert<std::uint32_t>(t, channel, layers, y, to); break;
      }
    }
  }

  template <class T>
  void convert(const Tile& t, const SinkChannel& channel, std::span<const Tile> layers, int y,
               std::byte* to) const {
    const T* from = t.row<const T>(channel.plane, 0, y);
    const int width = t.rect().width();
    if constexpr (std::is_same_v<T, std::uint32_t>) {
      if (channel.type == Type::u32) {
        for (int x = 0; x < width; ++x, to += pixel_bytes_) store(to, from[x]);
        return;
      }
    }
    if (plan_.straighten && &channel != &plan_.channels[static_cast<std::size_t>(plan_.alpha)]) {
      const SinkChannel& a = plan_.channels[static_cast<std::size_t>(plan_.alpha)];
      const PlaneKind kind = t.frame().planes[static_cast<std::size_t>(a.plane)].kind;
      const Tile& at = layers[static_cast<std::size_t>(a.layer)];
      for (int x = 0; x < width; ++x, to += pixel_bytes_) {
        const double alpha = kind == PlaneKind::f64
                                 ? at.row<const double>(a.plane, 0, y)[x]
                                 : static_cast<double>(at.row<const float>(a.plane, 0, y)[x]);
        const double v = static_cast<double>(from[x]);
        store_as(channel.type, static_cast<float>(alpha > 0 ? v / alpha : v), to);
      }
      return;
    }
    for (int x = 0; x < width; ++x, to += pixel_bytes_)
      store_as(channel.type, static_cast<float>(from[x]), to);
  }

  SinkPlan plan_;
  Rect region_;
  std::string path_;
  std::function<void(std::string_view code, const std::string& message)> warn_;
  std::ptrdiff_t see_through_ = 0;  // pixels so far
  PartialFile file_;
  Stream stream_;
  std::unique_ptr<lib::ImageOutput> out_;
  lib::TypeDesc native_;
  int y_offset_ = 0, next_row_ = 0;
  bool finished_ = false;
  std::vector<std::size_t> offsets_;
  std::size_t pixel_bytes_ = 0, row_bytes_ = 0;
  std::vector<std::byte> data_;
};

}  // namespace

std::string encode_png(const Raster& picture, int bits, std::string_view name) {
  const Rect w = picture.frame().window;
  const int channels = static_cast<int>(picture.frame().planes.size());
  const Type type = bits == 8 ? Type::u8 : Type::u16;
  lib::ImageSpec spec(w.width(), w.height(), channels, type_desc(type));
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("DateTime", "");
  if (channels == 4) spec.alpha_channel = 3, spec.attribute("oiio:UnassociatedAlpha", 1);
  const std::size_t pixel = bytes_of(type) * static_cast<std::size_t>(channels);
  std::vector<std::byte> data(pixel * static_cast<std::size_t>(w.area()));
  for (int y = w.y0; y < w.y1; ++y)
    for (int c = 0; c < channels; ++c) {
      const float* from = picture.view().row<const float>(c, 0, y);
      std::byte* to = data.data() + pixel * static_cast<std::size_t>((y - w.y0) * w.width()) +
                      bytes_of(type) * static_cast<std::size_t>(c);
      for (int x = 0; x < w.width(); ++x, to += pixel) store_as(type, from[x], to);
    }
  std::vector<unsigned char> bytes;
  lib::Filesystem::IOVecOutput stream(bytes);
  const auto out = lib::ImageOutput::create("png");
  if (!out || !out->set_ioproxy(&stream) || !out->open("texture.png", spec) ||
      !out->write_image(type_desc(type), data.data()) || !out->close())
    throw WorldError("cannot_write_file", fmt::format("{}: cannot make a PNG of a texture: {}", name,
                                                      out ? out->geterror() : lib::geterror()));
  return {bytes.begin(), bytes.end()};
}

std::unique_ptr<Sink> open(const SinkRequest& request, const SinkPlan& plan) {
  try {
    return std::make_unique<FileSink>(request, plan);
  } catch (const std::bad_alloc&) {
    throw WorldError("out_of_memory", fmt::format("no memory to write {}", request.path));
  }
}

}  // namespace frustum::oiio
