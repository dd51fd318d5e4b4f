#include "runtime/app/export.h"

#include "runtime/app/files.h"
#include "runtime/buffers/image.h"
#include "runtime/core/error.h"
#include "runtime/core/memory_limit.h"
#include "runtime/io/buffer_files.h"
#include "runtime/io/image_files.h"
#include "runtime/io/mesh_readers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

namespace frustum {
namespace {

template <class T>
void copy_sample(const Tile& from, const Tile& to, int plane, int sample) {
  const Rect& r = to.rect();
  for (int y = r.y0; y < r.y1; ++y)
    std::copy_n(from.row<T>(plane, sample, y), r.width(), to.row<T>(plane, 0, y));
}

// The records of RFC 4180 text: fields by commas, quotes doubled inside quotes.
std::vector<std::vector<std::string>> csv_records(const std::string& text, const std::string& path) {
  std::vector<std::vector<std::string>> records;
  std::vector<std::string> record{""};
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
      record.back() += text[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (quoted)
      record.back() += c;
    else if (c == ',')
      record.emplace_back();
    else if (c == '\n')
      records.push_back(std::exchange(record, {""}));
    else if (c != '\r')
      record.back() += c;
  }
  if (quoted) throw NodeError("malformed_file", fmt::format("{}: a quote is not closed", path));
  if (record.size() > 1 || !record.front().empty()) records.push_back(std::move(record));
  return records;
}

Json cell_value(const std::string& text) {
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc{} && end == text.data() + text.size() && std::isfinite(value) ? Json(value)
                                                                                            : Json(text);
}

}  // namespace

Raster one_sample(const Raster& raster, int sample) {
  const Frame& frame = raster.frame();
  if (sample < 0 || sample >= frame.samples())
    throw NodeError("out_of_range", frame.samples() == 1
                                        ? fmt::format("sample {}: a pixel has one, number 0", sample)
                                        : fmt::format("sample {}: a pixel has {}, from 0 to {}", sample,
                                                      frame.samples(), frame.samples() - 1));
  if (!frame.pattern) return raster;
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

void save_raster(const Raster& raster, const std::string& path, const FileWarning& warn, const Context& ctx) {
  const Rect window = raster.frame().window;
  SinkRequest request;
  request.path = path;
  request.region = request.display_window = window;
  request.layers = {{"", raster.frame()}};
  request.warn = warn;
  if (path.ends_with(".exr")) request.bits = 32;  // every bit of a float; colours are half otherwise
  const auto sink = open_image_sink(request);
  constexpr int band_rows = 64;
  for (int y = window.y0; y < window.y1; y += band_rows) {
    ctx.poll();
    const Tile band = raster.view().part({window.x0, y, window.x1, std::min(y + band_rows, window.y1)});
    sink->write({&band, 1});
  }
  ctx.poll();
  sink->finish();
}

Raster load_raster(const std::string& path) { return read_image(path, path).raster; }

Buffer load_buffer(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  for (const MeshReader& reader : mesh_readers()) {
    if (extension != fmt::format(".{}", reader.extension)) continue;
    Context ctx;
    ctx.precision = Precision::real_double;
    return Ref<Mesh>(std::make_shared<const Mesh>(reader.read(read_text(path), {path, path}, ctx)));
  }
  return Ref<Image>(std::make_shared<const Image>(Image{load_raster(path)}));
}

Json csv_table(const std::string& path) {
  Json out = {{"columns", Json::array()}, {"rows", Json::array()}};
  std::size_t width = 0;
  for (const auto& record : csv_records(read_text(path), path)) {
    Json row = Json::array();
    for (const std::string& text : record)
      row.push_back(out["columns"].empty() ? Json(text) : cell_value(text));
    if (out["columns"].empty()) {
      width = row.size(), out["columns"] = std::move(row);
    } else {
      if (row.size() != width)
        throw NodeError("malformed_file", fmt::format("{}: row {} has {} cells, not {}", path,
                                                      out["rows"].size() + 1, row.size(), width));
      out["rows"].push_back(std::move(row));
    }
  }
  return out;
}

std::vector<std::string> forms_of(const BufferType& kind, bool whole) {
  std::vector<std::string> forms =
      kind.is_pixels() && !whole ? writable_extensions() : std::vector<std::string>();
  for (std::string& form : saved_as(kind))
    if (std::find(forms.begin(), forms.end(), form) == forms.end()) forms.push_back(std::move(form));
  return forms;
}

Context saving_context(const Buffer& buffer, const CancelFlag* cancel, std::uint64_t memory) {
  Context ctx;
  ctx.cancel = cancel;
  ctx.admit = [held = buffer.bytes(), memory](std::uint64_t all) { check_memory_limit(held, all, memory); };
  return ctx;
}

void save_buffer(const Buffer& buffer, const std::string& path, Context& ctx, std::optional<int> sample,
                 const FileWarning& warn) {
  const std::vector<std::string> forms = saved_as(buffer.type());
  const bool whole = std::any_of(forms.begin(), forms.end(),
                                 [&](const std::string& form) { return path.ends_with("." + form); });
  if (!buffer.type().is_pixels() || whole) return save_buffer_file(buffer, {.path = path, .warn = warn}, ctx);
  const Raster& raster = buffer.type().raster(buffer.data());
  const Frame& frame = raster.frame();
  if (!sample && warn && frame.samples() > 1 && frame.find("R"))
    warn("sampled_output",
         fmt::format("{} gets the first of {} samples a pixel: supersample.resolve would filter them", path,
                     frame.samples()));
  save_raster(one_sample(raster, sample.value_or(0)), path, warn, ctx);
}

}  // namespace frustum
