#include "runtime/io/sink_plan.h"

#include "runtime/core/diagnostic.h"
#include "runtime/core/error.h"
#include "runtime/io/image_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <set>
#include <span>

namespace frustum {
namespace {

using Type = SinkChannel::Type;

struct Format {
  std::string_view name;
  std::vector<std::string_view> extensions;
  std::vector<int> bits;  // the usual depth first
  bool any_channels, alpha, grey;
  std::vector<std::string_view> compressions;
};

const std::array<Format, 5>& formats() {
  static const std::array<Format, 5> all{{
      {"exr",
       {"exr"},
       {0, 16, 32},
       true,
       true,
       true,
       {"none", "rle", "zip", "zips", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}},
      {"png", {"png"}, {8, 16}, false, true, true, {}},
      {"tiff", {"tif", "tiff"}, {16, 8, 32}, false, true, true, {"none", "lzw", "zip", "packbits"}},
      {"jpeg", {"jpg", "jpeg"}, {8}, false, false, true, {"quality:1 to quality:100"}},
      {"hdr", {"hdr"}, {32}, false, false, false, {}},
  }};
  return all;
}

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return s;
}

const Format* find_format(std::string_view path) {
  std::string ext = lower(std::filesystem::path(path).extension().string());
  if (!ext.empty()) ext.erase(0, 1);
  for (const Format& f : formats())
    if (std::find(f.extensions.begin(), f.extensions.end(), ext) != f.extensions.end()) return &f;
  return nullptr;
}

[[noreturn]] void cannot_hold(const SinkRequest& r, const Format& f, std::string_view why) {
  throw NodeError("format_cannot_hold", fmt::format("{}: {} {}; .exr holds any planes", r.path, f.name, why));
}

// "N" and "N.x" make "N.X"; "albedo" and "R" make "albedo.R"; the main layer keeps the plane's name.
std::string channel_name(std::string_view layer, std::string_view plane) {
  std::string name(plane);
  if (!layer.empty() && plane != layer && !plane.starts_with(std::string(layer) + "."))
    name = fmt::format("{}.{}", layer, plane);
  const std::size_t n = name.size();
  if (n > 2 && name[n - 2] == '.' && name[n - 1] >= 'w' && name[n - 1] <= 'z')
    name[n - 1] = static_cast<char>(name[n - 1] - 32);
  return name;
}

bool is_color(std::string_view channel) {
  const std::string_view last = channel.substr(channel.find_last_of('.') + 1);
  return last == "R" || last == "G" || last == "B" || last == "A";
}

Type exr_type(const Plane& p, std::string_view channel, int bits) {
  if (p.kind == PlaneKind::u32) return Type::u32;
  if (bits == 0) return is_color(channel) ? Type::half : Type::f32;
  return bits == 16 ? Type::half : Type::f32;
}

void plan_any(const SinkRequest& r, int bits, SinkPlan& plan) {
  std::set<std::string> names;
  for (std::size_t l = 0; l < r.layers.size(); ++l)
    for (std::size_t p = 0; p < r.layers[l].frame.planes.size(); ++p) {
      const Plane& plane = r.layers[l].frame.planes[p];
      std::string name = channel_name(r.layers[l].name, plane.name);
      if (!names.insert(name).second)
        throw NodeError("format_cannot_hold", fmt::format("{}: two planes are called '{}'", r.path, name));
      const Type type = exr_type(plane, name, bits);
      plan.channels.push_back({std::move(name), static_cast<int>(l), static_cast<int>(p), type});
    }
  if (plan.channels.empty()) throw NodeError("format_cannot_hold", r.path + ": there are no planes to write");
}

void plan_color(const SinkRequest& r, const Format& f, int bits, SinkPlan& plan) {
  const Type type = f.name == "hdr" || bits == 32 ? Type::f32 : bits == 16 ? Type::u16 : Type::u8;
  if (r.layers.size() != 1) cannot_hold(r, f, fmt::format("holds one layer, not {}", r.layers.size()));
  const Frame& frame = r.layers[0].frame;
  for (const Plane& p : frame.planes)
    if (p.kind == PlaneKind::u32) cannot_hold(r, f, fmt::format("holds colours, and '{}' counts", p.name));
  const auto add = [&](std::string_view plane) {
    plan.channels.push_back({std::string(plane), 0, *frame.find(plane), type});
  };
  if (frame.planes.size() == 1 && f.grey) {
    plan.channels.push_back({"Y", 0, 0, type});
    return;
  }
  for (const Plane& p : frame.planes)
    if (p.name != "R" && p.name != "G" && p.name != "B" && p.name != "A")
      cannot_hold(r, f, fmt::format("holds R, G, B{}, not '{}'", f.alpha ? " and A" : "", p.name));
  for (const std::string_view plane : {"R", "G", "B"}) {
    if (!frame.find(plane)) cannot_hold(r, f, fmt::format("needs R, G and B, and there is no {}", plane));
    add(plane);
  }
  if (f.alpha && frame.find("A")) plan.alpha = 3, add("A");
  if (!f.alpha) plan.lost_alpha = frame.find("A").value_or(-1);
  plan.straighten = f.name == "png" && plan.alpha >= 0 && frame.alpha == Alpha::premultiplied;
}

void check_compression(const SinkRequest& r, const Format& f) {
  if (r.compression.empty()) return;
  if (f.name == "jpeg" && r.compression.starts_with("quality:")) {
    int q = 0;
    const char *first = r.compression.data() + 8, *last = r.compression.data() + r.compression.size();
    const auto [end, error] = std::from_chars(first, last, q);
    if (error == std::errc{} && end == last && q >= 1 && q <= 100) return;
  }
  if (f.name != "jpeg" &&
      std::find(f.compressions.begin(), f.compressions.end(), r.compression) != f.compressions.end())
    return;
  const std::string known =
      f.compressions.empty() ? "it has no choice" : fmt::format("known: {}", fmt::join(f.compressions, ", "));
  throw NodeError("unknown_compression",
                  fmt::format("{}: '{}' is no compression of {}; {}", r.path, r.compression, f.name, known));
}

}  // namespace

std::string_view format_of_extension(std::string_view path) {
  const Format* f = find_format(path);
  return f != nullptr ? f->name : std::string_view{};
}

std::vector<std::string> writable_extensions() {
  std::vector<std::string> all;
  for (const Format& f : formats()) all.insert(all.end(), f.extensions.begin(), f.extensions.end());
  return all;
}

SinkPlan plan_sink(const SinkRequest& r) {
  const Format* f = find_format(r.path);
  if (f == nullptr) {
    const std::string ext = std::filesystem::path(r.path).extension().string();
    const auto near = nearest_names(ext.empty() ? ext : ext.substr(1), writable_extensions());
    throw NodeError(
        "unknown_format",
        fmt::format("{}: pictures are written as {}{}", r.path, fmt::join(writable_extensions(), ", "),
                    near.empty() ? "" : fmt::format("; did you mean .{}?", near[0])));
  }
  const int bits = r.bits == 0 ? f->bits[0] : r.bits;
  if (std::find(f->bits.begin(), f->bits.end(), bits) == f->bits.end())
    throw NodeError("bad_bits",
                    fmt::format("{}: {} has {} bits, not {}", r.path, f->name,
                                fmt::join(f->name == "exr" ? std::vector{16, 32} : f->bits, " or "), bits));
  check_compression(r, *f);
  SinkPlan plan{.format = std::string(f->name),
                .channels = {},
                .windows = f->name == "exr",
                .compression = r.compression};
  if (f->any_channels)
    plan_any(r, bits, plan);
  else
    plan_color(r, *f, bits, plan);
  return plan;
}

}  // namespace frustum
