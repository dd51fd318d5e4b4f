#include "runtime/app/export.h"

#include "runtime/app/files.h"
#include "runtime/core/error.h"
#include "runtime/io/image_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <limits>

namespace frustum {
namespace {

template <class T>
void copy_sample(const Tile& from, const Tile& to, int plane, int sample) {
  const Rect& r = to.rect();
  for (int y = r.y0; y < r.y1; ++y)
    std::copy_n(from.row<T>(plane, sample, y), r.width(), to.row<T>(plane, 0, y));
}

std::string cell(const Json& value) {
  if (value.is_null()) return "";
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string csv_row(const Json& cells) {
  std::string out;
  for (const Json& c : cells) out += (&c == &cells.front() ? "" : ",") + cell(c);
  return out + "\r\n";
}

}  // namespace

Raster one_sample(const Raster& raster, int sample) {
  const Frame& frame = raster.frame();
  if (!frame.pattern) return raster;
  if (sample < 0 || sample >= frame.samples())
    throw NodeError("out_of_range",
                    fmt::format("sample {}: there are {} in a pixel", sample, frame.samples()));
  Frame single = frame;
  single.pattern = nullptr;
  Raster out(single);
  for (int p = 0; p < static_cast<int>(frame.planes.size()); ++p)
    switch (frame.planes[static_cast<std::size_t>(p)].kind) {
      case PlaneKind::f32: copy_sample<float>(raster.view(), out.view(), p, sample); break;
      case PlaneKind::f64: copy_sample<double>(raster.view(), out.view(), p, sample); break;
      case PlaneKind::u32: copy_sample<std::uint32_t>(raster.view(), out.view(), p, sample); break;
    }
  return out;
}

void save_raster(const Raster& raster, const std::string& path) {
  const Rect window = raster.frame().window;
  SinkRequest request;
  request.path = path;
  request.region = request.display_window = window;
  request.layers = {{"", raster.frame()}};
  if (path.ends_with(".exr")) request.bits = 32;  // every bit of a float; colours are half otherwise
  const auto sink = open_image_sink(request);
  const Tile all = raster.view();
  sink->write({&all, 1});
  sink->finish();
}

Raster load_raster(const std::string& path) { return read_image(path, path).raster; }

std::string csv_text(const Json& table) {
  std::string out = csv_row(table.at("columns"));
  for (const Json& row : table.at("rows")) out += csv_row(row);
  return out;
}

void save_buffer(const Buffer& buffer, const std::string& path, int sample) {
  if (buffer.type().is_pixels())
    return save_raster(one_sample(buffer.type().raster(buffer.data()), sample), path);
  const Json table = buffer.type().table != nullptr
                         ? buffer.type().table(buffer.data(), 0, std::numeric_limits<std::size_t>::max())
                         : Json(nullptr);
  if (table.is_null() || !path.ends_with(".csv"))
    throw NodeError("cannot_save", table.is_null()
                                       ? fmt::format("a {} has no file form", buffer.type().name)
                                       : fmt::format("a {} is saved as .csv", buffer.type().name));
  write_text(path, csv_text(table));
}

}  // namespace frustum
