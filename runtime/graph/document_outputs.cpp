#include "runtime/graph/document_reader.h"
#include "runtime/graph/output_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <vector>

namespace frustum {
namespace {

// The first "{...}" in a file name that is not {frame}, to the end where it is not closed; empty where there
// is none.
std::string unknown_placeholder(std::string_view file) {
  for (std::size_t at; (at = file.find_first_of("{}")) != std::string_view::npos; file.remove_prefix(at)) {
    if (!file.substr(at).starts_with("{frame}")) {
      const std::size_t end = file.find('}', at);
      return std::string(file.substr(at, end == std::string_view::npos ? end : end - at + 1));
    }
    at += std::string_view("{frame}").size();
  }
  return {};
}

// "quality:1" to "quality:100"
bool is_quality(std::string_view s) {
  constexpr std::string_view prefix = "quality:";
  if (!s.starts_with(prefix)) return false;
  int n = 0;
  const auto [end, error] = std::from_chars(s.data() + prefix.size(), s.data() + s.size(), n);
  return error == std::errc() && end == s.data() + s.size() && n >= 1 && n <= 100;
}

bool leaves_folder(const std::filesystem::path& path) {
  return path.is_absolute() || (!path.empty() && *path.lexically_normal().begin() == "..");
}

}  // namespace

void DocumentReader::read_outputs(const Json& file) {
  const Json* outputs = object_at(file, "outputs", "");
  if (outputs == nullptr) return;
  doc_->outputs.reserve(outputs->size());
  for (const auto& [name, j] : outputs->items()) {
    const std::string pointer = child_pointer("/outputs", name);
    if (!good_id(name, pointer, "an output")) continue;
    doc_->outputs.push_back({.name = name, .pointer = pointer});
    read_output(doc_->outputs.back(), j);
  }
  check_same_files();
}

void DocumentReader::read_output(DocumentOutput& output, const Json& j) {
  if (!j.is_object())
    return wrong_type(output.pointer, R"(an object, such as {"from": "node.port", "file": "name.png"})", j);
  unknown_keys(j, output.pointer, {"from", "layers", "file", "bits", "compression"}, "an output");
  const bool from = j.contains("from");
  output.layered = !from && j.contains("layers");
  if (from && j.contains("layers"))
    problem({.code = "ambiguous_output",
             .pointer = child_pointer(output.pointer, "layers"),
             .message = "an output has either \"from\" or \"layers\"",
             .expected = "one of: from, layers",
             .got = "both"},
            true);
  if (from)
    output.layers.push_back({"", read_link(j["from"], child_pointer(output.pointer, "from"), false)});
  else if (output.layered)
    read_layers(output, j);
  else
    missing_key(output.pointer, "from", "an output, or \"layers\"");
  read_file(output, j);
}

void DocumentReader::read_layers(DocumentOutput& output, const Json& j) {
  const Json* layers = object_at(j, "layers", output.pointer);
  if (layers == nullptr) return;
  const std::string pointer = child_pointer(output.pointer, "layers");
  for (const auto& [name, link] : layers->items()) {
    const std::string at = child_pointer(pointer, name);
    const bool plain = name.find_first_of(". ") == std::string::npos;
    if (name.empty() || (plain && name.size() < 100)) {
      output.layers.push_back({name, read_link(link, at, false)});
      continue;
    }
    problem({.code = "bad_id",
             .pointer = at,
             .message = fmt::format("'{}' cannot name a layer: no dots, no blanks, at most 99 bytes",
                                    name.substr(0, 60)),
             .expected = "a layer's name, or \"\" for the main layer",
             .got = name.substr(0, 60)},
            true);
  }
  if (layers->empty()) wrong_type(pointer, "at least one layer", *layers);
  if (!j.contains("file")) missing_key(output.pointer, "file", "an output with layers");
}

void DocumentReader::read_file(DocumentOutput& output, const Json& j) {
  const Json* file = text_at(j, "file", output.pointer);
  if (file == nullptr) {
    for (const char* key : {"bits", "compression"})
      if (j.contains(key) && !j.contains("file"))
        missing_key(output.pointer, "file", fmt::format("an output with '{}'", key));
    return;
  }
  output.file = file->get<std::string>();
  if (check_file_name(output)) check_format(output, j);
}

bool DocumentReader::check_file_name(const DocumentOutput& output) {
  const std::string pointer = child_pointer(output.pointer, "file");
  const std::filesystem::path path(output.file);
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20; };
  if (!path.has_filename() || path.stem() == ".." ||
      std::any_of(output.file.begin(), output.file.end(), is_control))
    return problem({.code = "bad_path",
                    .pointer = pointer,
                    .message = fmt::format("'{}' does not name a file", output.file),
                    .expected = "a file name",
                    .got = output.file}),
           false;
  if (leaves_folder(path))
    problem({.code = "path_escapes",
             .pointer = pointer,
             .message = fmt::format("'{}' leaves the output folder", output.file),
             .expected = "a path below the output folder",
             .got = output.file,
             .suggestions = {path.filename().string()}});
  if (const std::string unknown = unknown_placeholder(output.file); !unknown.empty())
    problem({.code = "unknown_placeholder",
             .pointer = pointer,
             .message = fmt::format("'{}' is not a placeholder of file names", unknown),
             .expected = "{frame}",
             .got = unknown,
             .suggestions = {"{frame}"}});
  return true;
}

void DocumentReader::check_format(DocumentOutput& output, const Json& j) {
  const std::string extension = extension_of(output.file);
  const PictureFormat* format = find_picture_format(extension);
  if (format == nullptr && !check_buffer_format(output, extension)) return;
  output.whole = format == nullptr;
  static const PictureFormat buffer_format{{}, {}, {}, false};
  if (output.whole) format = &buffer_format;
  if (!format->layers &&
      (output.layers.size() > 1 || (output.layers.size() == 1 && !output.layers[0].name.empty())))
    problem({.code = "one_layer_format",
             .pointer = child_pointer(output.pointer, "layers"),
             .message = fmt::format("a .{} file holds {} only", extension,
                                    output.whole ? "one buffer" : "the main layer \"\""),
             .expected = output.whole ? "\"from\" and one port" : "an .exr file, or one layer",
             .got = fmt::format("{} layers", output.layers.size())});
  check_bits(output, j, *format);
  check_compression(output, j, *format);
}

// Whether any kind of buffer can be saved in a file of that extension; which one it is shows when links are
// followed.
bool DocumentReader::check_buffer_format(const DocumentOutput& output, const std::string& extension) {
  std::vector<std::string> names;
  for (const PictureFormat& f : picture_formats()) names.emplace_back(f.extension);
  for (const auto& [name, kind] : documents_.kinds())
    for (const std::string& e : documents_.saved_as(*kind))
      if (std::find(names.begin(), names.end(), e) == names.end()) names.push_back(e);
  if (std::find(names.begin(), names.end(), extension) != names.end()) return true;
  problem({.code = "unknown_extension",
           .pointer = child_pointer(output.pointer, "file"),
           .message = extension.empty()
                          ? fmt::format("'{}' has no extension that says its format", output.file)
                          : fmt::format("'.{}' is not a format that can be written", extension),
           .expected = fmt::format("one of: {}", fmt::join(names, ", ")),
           .got = extension,
           .suggestions = nearest_names(extension, names)});
  return false;
}

void DocumentReader::check_bits(DocumentOutput& output, const Json& j, const PictureFormat& format) {
  const auto bits = j.find("bits");
  if (bits == j.end()) return;
  const std::string pointer = child_pointer(output.pointer, "bits"),
                    expected = output.whole ? "no bits" : fmt::format("{}", fmt::join(format.bits, " or "));
  if (!bits->is_number_integer()) return wrong_type(pointer, expected, *bits);
  if (std::find(format.bits.begin(), format.bits.end(), *bits) != format.bits.end()) {
    output.bits = bits->get<int>();
    return;
  }
  problem({.code = "out_of_range",
           .pointer = pointer,
           .message = output.whole
                          ? fmt::format("a .{} file has no depth of channels", extension_of(output.file))
                          : fmt::format("a .{} file has {} bits a channel, not {}", format.extension,
                                        expected, quoted_json(*bits)),
           .expected = expected,
           .got = quoted_json(*bits)});
}

void DocumentReader::check_compression(DocumentOutput& output, const Json& j, const PictureFormat& format) {
  const Json* compression = text_at(j, "compression", output.pointer);
  if (compression == nullptr) return;
  output.compression = compression->get<std::string>();
  const auto& known = format.compressions;
  if (std::find(known.begin(), known.end(), output.compression) != known.end()) return;
  if (format.quality && is_quality(output.compression)) return;
  const std::string expected = format.quality  ? "quality:1 to quality:100"
                               : known.empty() ? "no compression"
                                               : fmt::format("one of: {}", fmt::join(known, ", "));
  problem({.code = "unknown_choice",
           .pointer = child_pointer(output.pointer, "compression"),
           .message = fmt::format("'{}' is not a compression of .{} files: these take {}", output.compression,
                                  extension_of(output.file), expected),
           .expected = expected,
           .got = output.compression,
           .suggestions = nearest_names(output.compression, known)});
}

}  // namespace frustum
