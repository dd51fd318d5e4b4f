#include "runtime/io/gltf_data.h"

#include "runtime/core/error.h"
#include "runtime/core/missing_file.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

namespace frustum::gltf {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

// RFC 3986, 2.1; a stray % stands for itself.
std::string percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(text[i + 2]) : -1;
    if (low >= 0) i += 2;
    out.push_back(low >= 0 ? static_cast<char>(high * 16 + low) : text[i]);
  }
  return out;
}

// RFC 3986, 3.1: a letter, then letters, digits, + - . up to a colon.
bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  for (std::size_t i = 0; i < colon; ++i) {
    const char c = uri[i];
    const bool later = (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
    if (!is_letter(c) && (i == 0 || !later)) return false;
  }
  return true;
}

// RFC 4648, 4. Returns false where a character is not of the alphabet.
bool decode_base64(std::string_view text, std::string& out) {
  static constexpr auto value = [] {
    std::array<std::int8_t, 256> table{};
    table.fill(-1);
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < alphabet.size(); ++i)
      table[static_cast<unsigned char>(alphabet[i])] = static_cast<std::int8_t>(i);
    return table;
  }();
  for (int i = 0; i < 2 && !text.empty() && text.back() == '='; ++i) text.remove_suffix(1);
  if (text.size() % 4 == 1) return false;
  out.clear();
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int have = 0;
  for (const char c : text) {
    const int v = value[static_cast<unsigned char>(c)];
    if (v < 0) return false;
    bits = bits << 6 | static_cast<std::uint32_t>(v);
    have += 6;
    if (have < 8) continue;
    have -= 8;
    out.push_back(static_cast<char>(bits >> have & 0xFF));
  }
  return true;
}

std::optional<Component> component_of(std::uint64_t code) {
  switch (code) {
    case 5120:
    case 5121:
    case 5122:
    case 5123:
    case 5125:
    case 5126: return static_cast<Component>(code);
    default: return {};
  }
}

int width_of(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 0;
}

// Elements of `size` bytes every `stride` bytes, from `offset`: whether they lie within `bytes`.
// All numbers are at most 2^53 and stride at most 2^8, so nothing overflows.
bool fits(std::size_t bytes, std::size_t offset, std::size_t count, std::size_t stride, std::size_t size) {
  return count == 0 || (offset <= bytes && size <= bytes - offset &&
                        (count - 1) <= (bytes - offset - size) / std::max<std::size_t>(1, stride));
}

}  // namespace

std::size_t bytes_of(Component c) {
  switch (c) {
    case Component::i8:
    case Component::u8: return 1;
    case Component::i16:
    case Component::u16: return 2;
    default: return 4;
  }
}

FilePath resolved_uri(const FilePath& file, std::string_view uri, std::string_view element) {
  namespace fs = std::filesystem;
  const auto refuse = [&](std::string_view why) {
    throw NodeError("unsafe_path", fmt::format("{}: {}: \"{}\" {}", file.written, element, uri, why));
  };
  if (has_scheme(uri)) refuse("is not a file beside this one");
  const std::string path = percent_decoded(uri);
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 32; };
  if (path.empty() || std::any_of(path.begin(), path.end(), is_control)) refuse("is not the name of a file");
  if (path[0] == '/' || path[0] == '\\') refuse("is an absolute path");
  const fs::path normal = fs::path(path).lexically_normal();
  if (!normal.empty() && *normal.begin() == "..") refuse("leads out of the folder of this file");
  const auto beside = [&](const std::string& of) { return (fs::path(of).parent_path() / normal).string(); };
  return {beside(file.written), beside(file.resolved)};
}

UriBytes::UriBytes(const FilePath& file, std::string_view uri, std::string_view element) {
  if (!uri.starts_with("data:")) {
    const FilePath path = resolved_uri(file, uri, element);
    if (const std::string why = why_missing(path.resolved, path.written); !why.empty())
      throw NodeError("missing_file", fmt::format("{}: {}: {}", file.written, element, why));
    try {
      file_ = std::make_unique<FileBytes>(path);
    } catch (const WorldError& e) {
      throw WorldError(e.code, fmt::format("{}: {}: {}", file.written, element, e.what()));
    }
    return;
  }
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64"))
    fail(file, element, "its data URI is not in base64");
  if (!decode_base64(uri.substr(comma + 1), own_)) fail(file, element, "its data URI is malformed base64");
}

Data::Data(const Object& document, const FilePath& file, std::optional<std::string_view> binary)
    : file_(file),
      binary_(binary),
      buffers_(document.objects("buffers")),
      views_(document.objects("bufferViews")),
      accessors_(document.objects("accessors")),
      read_(buffers_.size()) {}

std::string_view Data::buffer(std::size_t i) {
  Buffer& b = read_[i];
  if (b.read) return b.bytes;
  const Object& o = buffers_[i];
  const std::size_t length = o.required("byteLength");
  const auto uri = o.text("uri");
  if (uri) {
    b.own = std::make_unique<UriBytes>(file_, *uri, o.path());
    b.bytes = b.own->bytes();
  } else if (i == 0 && binary_) {
    b.bytes = *binary_;
  } else {
    o.fail("it has no uri, and this file no binary chunk for it");
  }
  if (b.bytes.size() < length)
    o.fail(fmt::format("byteLength says {} bytes, and there are {}", length, b.bytes.size()));
  b.bytes = b.bytes.substr(0, length);
  b.read = true;
  bytes_ += length;
  return b.bytes;
}

View Data::view(std::size_t i) {
  const Object& o = views_[i];
  for (const char* compression : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (o.extension(compression))
      o.fail(fmt::format("it is compressed by {}, which is not read", compression));
  const auto at = o.index("buffer", "buffers", buffers_.size());
  if (!at) o.fail("there is no \"buffer\"");
  const std::string_view all = buffer(*at);
  const std::size_t offset = o.integer("byteOffset", 0), length = o.required("byteLength");
  if (offset > all.size() || length > all.size() - offset)
    o.fail(fmt::format("bytes {} to {} lie beyond the {} of buffers[{}]", offset, offset + length, all.size(),
                       *at));
  const auto stride = o.integer("byteStride");
  if (stride && (*stride < 4 || *stride > 252)) o.fail_at("byteStride", "this must be 4 to 252");
  return {all.substr(offset, length), stride.value_or(0)};
}

Accessor::Sparse Data::sparse_of(const Object& o, const Accessor& a) {
  Accessor::Sparse s;
  s.count = o.required("count");
  if (s.count > a.count) o.fail(fmt::format("it replaces {} of {} elements", s.count, a.count));
  const auto part = [&](const char* key, std::size_t size) {
    const auto p = o.object(key);
    if (!p) o.fail(fmt::format("there is no \"{}\"", key));
    const auto at = p->index("bufferView", "bufferViews", views_.size());
    if (!at) p->fail("there is no \"bufferView\"");
    const std::string_view bytes = view(*at).bytes;
    const std::size_t offset = p->integer("byteOffset", 0);
    if (!fits(bytes.size(), offset, s.count, size, size))
      p->fail(fmt::format("{} elements of {} bytes lie beyond the {} bytes of bufferViews[{}]", s.count, size,
                          bytes.size(), *at));
    return bytes.data() + offset;
  };
  const auto indices = o.object("indices");
  const auto type = indices ? component_of(indices->required("componentType")) : std::nullopt;
  if (!type || (*type != Component::u8 && *type != Component::u16 && *type != Component::u32))
    o.fail("its indices must be unsigned bytes, shorts or ints");
  s.index = *type;
  s.indices = part("indices", bytes_of(*type));
  s.values = part("values", bytes_of(a.component) * static_cast<std::size_t>(a.width));
  return s;
}

bool Data::is_matrix(std::size_t accessor) const {
  return accessors_[accessor].text("type").value_or("").starts_with("MAT");
}

Accessor Data::accessor(std::size_t i) {
  const Object& o = accessors_[i];
  Accessor a;
  a.path = o.path();
  const auto component = component_of(o.required("componentType"));
  if (!component) o.fail_at("componentType", "this is none of the six types of numbers");
  a.component = *component;
  a.width = width_of(o.text("type").value_or(""));
  if (a.width == 0) o.fail_at("type", "this must be SCALAR, VEC2, VEC3 or VEC4");
  a.normalized = o.boolean("normalized").value_or(false);
  a.count = o.required("count");
  const std::size_t size = bytes_of(a.component) * static_cast<std::size_t>(a.width);
  a.stride = size;
  if (const auto at = o.index("bufferView", "bufferViews", views_.size())) {
    const View v = view(*at);
    const std::size_t offset = o.integer("byteOffset", 0);
    if (v.stride != 0) a.stride = v.stride;
    if (!fits(v.bytes.size(), offset, a.count, a.stride, size))
      o.fail(
          fmt::format("{} elements of {} bytes, one every {}, from byte {} on lie beyond the {} bytes of "
                      "bufferViews[{}]",
                      a.count, size, a.stride, offset, v.bytes.size(), *at));
    a.first = v.bytes.data() + offset;
  }
  if (const auto sparse = o.object("sparse")) a.sparse = sparse_of(*sparse, a);
  return a;
}

}  // namespace frustum::gltf
