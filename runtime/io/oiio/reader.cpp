#include "runtime/io/oiio/reader.h"

#include "runtime/core/error.h"
#include "runtime/io/oiio/png_check.h"
#include "runtime/io/primaries.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <set>

namespace frustum::oiio {
namespace {

namespace lib = OIIO;

struct File {
  std::string_view name;

  [[noreturn]] void malformed(std::string_view why) const {
    throw NodeError("malformed_file", fmt::format("{}: {}", name, why));
  }
};

// Returns the size of the file.
std::uint64_t check_readable(const std::string& path, const File& file) {
  struct stat info {};
  std::string_view why;
  if (stat(path.c_str(), &info) != 0)
    why = std::strerror(errno);
  else if (!S_ISREG(info.st_mode))
    why = "it is not a regular file";
  if (!why.empty()) throw WorldError("cannot_read_file", fmt::format("cannot read {}: {}", file.name, why));
  return static_cast<std::uint64_t>(info.st_size);
}

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// Leaves the bytes at their beginning.
void check_png(lib::Filesystem::IOProxy& bytes, const File& file) {
  const std::string fault =
      png_fault(bytes.size(), [&](void* to, std::size_t n) { return bytes.read(to, n); });
  if (!fault.empty()) file.malformed(fault);
  bytes.seek(0);
}

// What the library says, without the question that it asks back.
std::string why_not_open() {
  const std::string said = one_line(lib::geterror());
  if (said.find("could not find a format reader") == std::string::npos) return said;
  return "it is no picture of a kind that is read";
}

std::unique_ptr<lib::ImageInput> open_input(const std::string& path, const File& file) {
  lib::Filesystem::IOFile bytes(path, lib::Filesystem::IOProxy::Read);
  check_png(bytes, file);
  lib::ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);  // alpha is multiplied here, in floats and not in bytes
  auto input = lib::ImageInput::open(path, &hints);
  if (!input) file.malformed(why_not_open());
  return input;
}

// The extension of the format whose first bytes these are.
std::string_view format_of(std::string_view bytes) {
  constexpr std::pair<std::string_view, std::string_view> beginnings[] = {
      {"\x89PNG", "png"}, {"\xFF\xD8\xFF", "jpg"}, {"v/1\x01", "exr"},    {"#?RADIANCE", "hdr"},
      {"#?RGBE", "hdr"},  {{"II*\0", 4}, "tif"},   {{"MM\0*", 4}, "tif"}, {"BM", "bmp"}};
  for (const auto& [beginning, extension] : beginnings)
    if (bytes.starts_with(beginning)) return extension;
  return bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP") ? "webp" : "";
}

std::unique_ptr<lib::ImageInput> open_memory(lib::Filesystem::IOMemReader& memory, std::string_view bytes,
                                             const File& file) {
  const std::string_view format = format_of(bytes);
  if (format.empty()) file.malformed("this is no picture of a kind that is read from memory");
  check_png(memory, file);
  lib::ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);
  // Named twice: readers forget the one they were made with when they are opened with hints (2.4.7).
  lib::Filesystem::IOProxy* proxy = &memory;
  hints.attribute("oiio:ioproxy", lib::TypeDesc::PTR, static_cast<void*>(&proxy));
  auto input = lib::ImageInput::open(fmt::format("memory.{}", format), &hints, proxy);
  if (!input) file.malformed(why_not_open());
  return input;
}

// No file packs pixels tighter than this: deflate, the tightest of the compressions, makes at most 1032 bytes of
// one, which are 8 pixels each where they are one bit. A file that claims more is lying, and nothing is
// allocated for it.
void check_size(const lib::ImageSpec& s, std::uint64_t file_bytes, const File& file) {
  const double claimed = static_cast<double>(s.image_bytes(true));
  if (claimed > 16384.0 * static_cast<double>(file_bytes) + 0x1p24)
    file.malformed(fmt::format("it says {} x {} pixels, more than its {} bytes can hold", s.width, s.height,
                               file_bytes));
}

void check_spec(const lib::ImageSpec& s, const File& file) {
  if (s.deep) file.malformed("this is a deep picture (many depths a pixel): io.load_fragments reads it");
  if (s.depth > 1) file.malformed("this is a volume, not a picture");
  if (s.width <= 0 || s.height <= 0 || s.nchannels <= 0) file.malformed("the picture has no pixels");
}

// "N.X" is our "N.x"; the names of a file are unique or made so.
std::vector<std::string> plane_names(const lib::ImageSpec& s) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (int c = 0; c < s.nchannels; ++c) {
    std::string name = static_cast<std::size_t>(c) < s.channelnames.size()
                           ? s.channelnames[static_cast<std::size_t>(c)]
                           : "";
    if (name.empty()) name = fmt::format("channel{}", c);
    const std::size_t n = name.size();
    if (n > 2 && name[n - 2] == '.' && name[n - 1] >= 'W' && name[n - 1] <= 'Z')
      name[n - 1] = static_cast<char>(name[n - 1] + 32);
    std::string fresh = name;
    for (int k = 2; !taken.insert(fresh).second; ++k) fresh = fmt::format("{}_{}", name, k);
    names.push_back(fresh);
  }
  return names;
}

PlaneKind kind_of(lib::TypeDesc type) {
  return type.basetype == lib::TypeDesc::UINT32 ? PlaneKind::u32 : PlaneKind::f32;
}

std::string space_of_chromaticities(const lib::ImageSpec& s) {
  const lib::ParamValue* p = s.find_attribute("chromaticities");
  if (p == nullptr || p->type().basevalues() != 8 || p->type().basetype != lib::TypeDesc::FLOAT) return {};
  const auto* xy = static_cast<const float*>(p->data());
  for (const Primaries& known : known_primaries) {
    const bool same = std::equal(known.xy.begin(), known.xy.end(), xy, [](double a, float b) {
      return std::abs(a - static_cast<double>(b)) < 1e-3;
    });
    if (same) return std::string(known.linear_space);
  }
  return {};
}

std::string color_space_of(const lib::ImageSpec& s) {
  if (const std::string ours = s.get_string_attribute("frustum:colorSpace"); !ours.empty()) return ours;
  if (std::string known = space_of_chromaticities(s); !known.empty()) return known;
  const std::string said = s.get_string_attribute("oiio:ColorSpace");
  const auto is = [&](const char* name) { return lib::Strutil::iequals(said, name); };
  if (is("sRGB")) return "srgb";
  if (is("Rec709")) return "rec709";
  if (is("AdobeRGB")) return "adobe_rgb";
  if (is("ACEScg")) return "lin_ap1";
  if (is("ACES2065-1") || is("ACES")) return "lin_ap0";
  if (is("Linear") || is("scene_linear") || is("lin_srgb")) return "lin_rec709";
  return s.format.is_floating_point() ? "lin_rec709" : "srgb";
}

// One run of channels with the same kind, rows [y0, y1), interleaved. Integers stay what they are: dividing
// them is ours.
class Rows {
 public:
  Rows(lib::ImageInput& in, const lib::ImageSpec& spec, int subimage, const File& file)
      : in_(in), spec_(spec), subimage_(subimage), file_(file) {}

  template <class T>
  const T* read(int first_channel, int end_channel, int y0, int y1, lib::TypeDesc type) {
    const auto n = static_cast<std::size_t>(end_channel - first_channel);
    data_.resize(n * static_cast<std::size_t>(spec_.width) * static_cast<std::size_t>(y1 - y0) * sizeof(T));
    const bool done = spec_.tile_width == 0
                          ? in_.read_scanlines(subimage_, 0, y0, y1, spec_.z, first_channel, end_channel,
                                               type, data_.data())
                          : in_.read_tiles(subimage_, 0, spec_.x, spec_.x + spec_.width, y0, y1, spec_.z,
                                           spec_.z + 1, first_channel, end_channel, type, data_.data());
    // Some readers fill in what a truncated file lacks, and only leave a message.
    if (!done || in_.has_error())
      file_.malformed(fmt::format("rows {} to {} cannot be read: {}", y0, y1 - 1, one_line(in_.geterror())));
    return reinterpret_cast<const T*>(data_.data());
  }
  int step() const { return spec_.tile_width == 0 ? 64 : std::max(1, spec_.tile_height); }

 private:
  lib::ImageInput& in_;
  const lib::ImageSpec& spec_;
  int subimage_;
  const File& file_;
  std::vector<std::byte> data_;
};

template <class From, class To, class Convert>
void scatter(const From* from, const Tile& to, int first_plane, int planes, int y0, int y1,
             Convert&& convert) {
  const int width = to.rect().width();
  tbb::parallel_for(y0, y1, [&](int y) {
    const From* row = from + std::ptrdiff_t{y - y0} * width * planes;
    for (int p = 0; p < planes; ++p) {
      To* out = to.row<To>(first_plane + p, 0, y);
      for (int x = 0; x < width; ++x) out[x] = convert(row[std::ptrdiff_t{x} * planes + p]);
    }
  });
}

void fill(lib::ImageInput& in, const lib::ImageSpec& spec, int subimage, const Raster& raster,
          const File& file) {
  Rows rows(in, spec, subimage, file);
  const Tile to = raster.view();
  const auto& planes = raster.frame().planes;
  const auto base = spec.format.basetype;
  for (int first = 0, end = 0; first < spec.nchannels; first = end) {
    const PlaneKind kind = planes[static_cast<std::size_t>(first)].kind;
    for (end = first; end < spec.nchannels && planes[static_cast<std::size_t>(end)].kind == kind; ++end) {
    }
    for (int y0 = spec.y; y0 < spec.y + spec.height; y0 += rows.step()) {
      const int y1 = std::min(y0 + rows.step(), spec.y + spec.height), n = end - first;
      if (kind == PlaneKind::u32)
        scatter<std::uint32_t, std::uint32_t>(
            rows.read<std::uint32_t>(first, end, y0, y1, lib::TypeDesc::UINT32), to, first, n, y0, y1,
            [](std::uint32_t v) { return v; });
      else if (base == lib::TypeDesc::UINT8)
        scatter<std::uint8_t, float>(rows.read<std::uint8_t>(first, end, y0, y1, lib::TypeDesc::UINT8), to,
                                     first, n, y0, y1,
                                     [](std::uint8_t v) { return static_cast<float>(v) / 255.0f; });
      else if (base == lib::TypeDesc::UINT16)
        scatter<std::uint16_t, float>(rows.read<std::uint16_t>(first, end, y0, y1, lib::TypeDesc::UINT16), to,
                                      first, n, y0, y1,
                                      [](std::uint16_t v) { return static_cast<float>(v) / 65535.0f; });
      else
        scatter<float, float>(rows.read<float>(first, end, y0, y1, lib::TypeDesc::FLOAT), to, first, n, y0,
                              y1, [](float v) { return v; });
    }
  }
}

void premultiply(const Raster& raster) {
  const Frame& f = raster.frame();
  const auto a = f.find("A");
  const Tile t = raster.view();
  for (const std::string_view name : {"R", "G", "B"}) {
    const auto plane = f.find(name);
    if (!plane || !a) continue;
    tbb::parallel_for(t.rect().y0, t.rect().y1, [&](int y) {
      float* color = t.row<float>(*plane, 0, y);
      const float* alpha = t.row<const float>(*a, 0, y);
      for (int x = 0; x < t.rect().width(); ++x) color[x] *= alpha[x];
    });
  }
}

// A grey picture as R = G = B, so that what takes colour takes it.
Raster with_rgb(const Raster& grey) {
  Frame f = grey.frame();
  const bool alpha = f.find("A").has_value();
  f.planes = {{"R"}, {"G"}, {"B"}};
  if (alpha) f.planes.push_back({"A"});
  const Raster out(f);
  const Tile from = grey.view(), to = out.view();
  for (int p = 0; p < static_cast<int>(f.planes.size()); ++p)
    for (int y = f.window.y0; y < f.window.y1; ++y)
      std::copy_n(from.row<const float>(p == 3 ? 1 : 0, 0, y), f.window.width(), to.row<float>(p, 0, y));
  return out;
}

// The pixel of the stored picture (w x h) that a viewer shows at x, y; `orientation` as in TIFF 6.0,
// section 8.
std::pair<int, int> stored_pixel(int orientation, int x, int y, int w, int h) {
  switch (orientation) {
    case 2: return {w - 1 - x, y};
    case 3: return {w - 1 - x, h - 1 - y};
    case 4: return {x, h - 1 - y};
    case 5: return {y, x};
    case 6: return {y, h - 1 - x};
    case 7: return {w - 1 - y, h - 1 - x};
    case 8: return {w - 1 - y, x};
    default: return {x, y};
  }
}

Raster upright(const Raster& stored, int orientation) {
  Frame f = stored.frame();
  const int w = f.window.width(), h = f.window.height();
  f.window = orientation >= 5 ? Rect{0, 0, h, w} : Rect{0, 0, w, h};
  const Raster out(f);
  const Tile from = stored.view(), to = out.view();
  const auto turn = [&]<class T>(int plane, const T*) {
    tbb::parallel_for(0, f.window.height(), [&](int y) {
      for (int x = 0; x < f.window.width(); ++x) {
        const auto [sx, sy] = stored_pixel(orientation, x, y, w, h);
        to.row<T>(plane, 0, y)[x] = from.row<const T>(plane, 0, from.rect().y0 + sy)[sx];
      }
    });
  };
  for (int p = 0; p < static_cast<int>(f.planes.size()); ++p)
    if (f.planes[static_cast<std::size_t>(p)].kind == PlaneKind::u32)
      turn(p, static_cast<const std::uint32_t*>(nullptr));
    else
      turn(p, static_cast<const float*>(nullptr));
  return out;
}

ImageFile read_all(lib::ImageInput* in, int subimage, std::uint64_t file_bytes, bool keep_alpha,
                   const File& file) {
  if (subimage < 0 || !in->seek_subimage(subimage, 0))
    file.malformed(fmt::format("there is no subimage {}", subimage));
  const lib::ImageSpec spec = in->spec();
  check_spec(spec, file);
  check_size(spec, file_bytes, file);
  Frame f{.window = {spec.x, spec.y, spec.x + spec.width, spec.y + spec.height}};
  const auto names = plane_names(spec);
  for (int c = 0; c < spec.nchannels; ++c)
    f.planes.push_back({names[static_cast<std::size_t>(c)], kind_of(spec.channelformat(c))});
  const bool grey = (names[0] == "Y" || (names.size() == 1 && !spec.format.is_floating_point())) &&
                    f.planes[0].kind == PlaneKind::f32 &&
                    (names.size() == 1 || (names.size() == 2 && names[1] == "A"));
  const bool color = grey || (f.find("R") && f.find("G") && f.find("B"));
  if (color) f.color_space = color_space_of(spec);
  const bool straight = spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
  if (f.find("A")) f.alpha = straight && keep_alpha ? Alpha::straight : Alpha::premultiplied;
  Raster raster(f);
  fill(*in, spec, subimage, raster, file);
  in->close();
  if (grey) raster = with_rgb(raster);
  if (straight && !keep_alpha) premultiply(raster);
  ImageFile out{.raster = raster,
                .display_window = {spec.full_x, spec.full_y, spec.full_x + spec.full_width,
                                   spec.full_y + spec.full_height},
                .format = in->format_name()};
  if (const int orientation = spec.get_int_attribute("Orientation", 1); orientation > 1 && orientation <= 8) {
    out.raster = upright(raster, orientation);
    out.display_window = out.raster.frame().window;
  }
  for (const lib::ParamValue& p : spec.extra_attribs)
    out.metadata.emplace_back(p.name().string(), p.get_string());
  return out;
}

template <class Read>
ImageFile guarded(const File& file, Read&& read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
    throw WorldError("out_of_memory", fmt::format("no memory for the pixels of {}", file.name));
  } catch (const NodeError&) {
    throw;
  } catch (const WorldError&) {
    throw;
  } catch (const std::exception& e) {
    file.malformed(e.what());
  }
}

}  // namespace

ImageFile read(const std::string& path, std::string_view name, int subimage) {
  const File file{name};
  const std::uint64_t bytes = check_readable(path, file);
  return guarded(file, [&] { return read_all(open_input(path, file).get(), subimage, bytes, false, file); });
}

ImageFile read_bytes(std::string_view bytes, std::string_view name) {
  const File file{name};
  return guarded(file, [&] {
    lib::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
    return read_all(open_memory(memory, bytes, file).get(), 0, bytes.size(), true, file);
  });
}

}  // namespace frustum::oiio
