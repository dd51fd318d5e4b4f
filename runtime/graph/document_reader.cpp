#include "runtime/graph/document_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

constexpr std::string_view format_prefix = "frustum.graph/", format_version = "1";

bool is_id(std::string_view s) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto inner = [&](char c) { return letter(c) || (c >= '0' && c <= '9'); };
  return !s.empty() && letter(s[0]) && std::all_of(s.begin(), s.end(), inner);
}

// The id nearest to what was written: other characters become '_'.
std::string as_id(std::string_view s) {
  std::string out;
  for (const char c : s.substr(0, 60)) out += is_id(std::string("_") + c) ? c : '_';
  return is_id(out) ? out : "_" + out;
}

}  // namespace

DocumentReader::DocumentReader(Documents& documents, std::shared_ptr<const SourceText> text,
                               std::string folder)
    : documents_(documents), doc_(std::make_shared<Document>()) {
  doc_->text = std::move(text);
  doc_->folder = std::move(folder);
}

std::shared_ptr<const Document> DocumentReader::read() {
  if (!doc_->text->complete()) return nullptr;
  const Json& file = doc_->text->json();
  if (!file.is_object()) return wrong_type("", "an object", file), nullptr;
  if (!read_format(file)) return nullptr;
  unknown_keys(
      file, "",
      {"$schema", "format", "title", "params", "precision", "seed", "inputs", "nodes", "outputs", "ui"},
      "a graph");
  text_at(file, "$schema", "");
  if (const Json* title = text_at(file, "title", "")) doc_->title = title->get<std::string>();
  if (file.contains("precision")) doc_->precision = read_precision(file["precision"], "/precision");
  if (const auto seed = file.find("seed"); seed != file.end()) {
    if (seed->is_number_unsigned())
      doc_->seed = seed->get<std::uint64_t>();
    else
      wrong_type("/seed", fmt::format("an integer from 0 to {}", ~std::uint64_t{0}), *seed);
  }
  object_at(file, "ui", "");
  read_params(file);
  read_inputs(file);
  read_nodes(file);
  read_outputs(file);
  resolve_links();
  return doc_;
}

bool DocumentReader::read_format(const Json& file) {
  const std::string wanted = fmt::format("{}{}", format_prefix, format_version);
  const auto found = file.find("format");
  if (found == file.end()) return missing_key("", "format", fmt::format("a graph, \"{}\"", wanted)), true;
  if (!found->is_string()) return wrong_type("/format", fmt::format("\"{}\"", wanted), *found), true;
  const auto format = found->get<std::string>();
  if (format == wanted) return true;
  const bool version = format.starts_with(format_prefix);
  const std::string what =
      version ? fmt::format("version {} of the graph format is not known here, only version {}",
                            format.substr(format_prefix.size()), format_version)
              : fmt::format("'{}' is not a format of graphs", format);
  problem({.code = "bad_format",
           .pointer = "/format",
           .message = what,
           .expected = wanted,
           .got = format,
           .suggestions = {wanted}});
  return false;
}

void DocumentReader::read_params(const Json& file) {
  const Json* params = object_at(file, "params", "");
  if (params == nullptr) return;
  for (const auto& [name, value] : params->items()) {
    const std::string pointer = child_pointer("/params", name);
    if (!good_id(name, pointer, "a graph parameter")) continue;
    each_dollar(value, pointer, [&, &of = name](const std::string& text, const std::string& at) {
      problem({.code = "unknown_parameter",
               .pointer = at,
               .message = fmt::format("the default of '{}' cannot take another parameter: '{}'", of, text),
               .expected = R"(a value, or a text that begins with "$$")",
               .got = text,
               .suggestions = {"$" + text}});
    });
    doc_->params.push_back({name, pointer, &value});
    dollar_params_.push_back("$" + name);
  }
}

void DocumentReader::read_inputs(const Json& file) {
  const Json* inputs = object_at(file, "inputs", "");
  if (inputs == nullptr) return;
  for (const auto& [name, j] : inputs->items()) {
    const std::string pointer = child_pointer("/inputs", name);
    if (good_id(name, pointer, "a graph input")) read_input(name, j, pointer);
  }
}

void DocumentReader::read_input(const std::string& name, const Json& j, const std::string& pointer) {
  doc_->inputs.push_back({.name = name, .pointer = pointer});
  DocumentInput& input = doc_->inputs.back();
  if (!j.is_object()) return wrong_type(pointer, R"(an object, such as {"type": "mesh"})", j);
  unknown_keys(j, pointer, {"type", "list", "optional", "doc"}, "a graph input");
  input.list = bool_at(j, "list", pointer);
  input.optional = bool_at(j, "optional", pointer);
  text_at(j, "doc", pointer);
  if (!j.contains("type")) return missing_key(pointer, "type", "a graph input, the kind of buffer it takes");
  const Json* type = text_at(j, "type", pointer);
  if (type == nullptr) return;
  const auto kind = documents_.kinds().find(type->get<std::string>());
  if (kind != documents_.kinds().end()) {
    input.kind = kind->second;
    return;
  }
  std::vector<std::string> names;
  for (const auto& [known, k] : documents_.kinds()) names.push_back(known);
  problem({.code = "unknown_kind",
           .pointer = child_pointer(pointer, "type"),
           .message = fmt::format("'{}' is not a kind of buffer", type->get<std::string>()),
           .expected = fmt::format("one of: {}", fmt::join(names, ", ")),
           .got = type->get<std::string>(),
           .suggestions = nearest_names(type->get<std::string>(), names)});
}

// ----- reports

void DocumentReader::wrong_type(const std::string& pointer, std::string expected, const Json& got) {
  const std::string shown = quoted_json(got);
  problem({.code = "wrong_type",
           .pointer = pointer,
           .message = fmt::format("expected {}, got {}", expected, shown),
           .expected = std::move(expected),
           .got = shown});
}

void DocumentReader::missing_key(const std::string& pointer, std::string_view key, std::string_view of) {
  problem({.code = "missing_key",
           .pointer = pointer,
           .message = fmt::format("the key '{}' is missing, required of {}", key, of),
           .expected = std::string(key)});
}

void DocumentReader::unknown_keys(const Json& object, const std::string& pointer,
                                  std::initializer_list<std::string_view> known, std::string_view of) {
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::vector<std::string> names(known.begin(), known.end());
    problem({.code = "unknown_key",
             .pointer = child_pointer(pointer, key),
             .message = fmt::format("'{}' is not a key of {}", key, of),
             .expected = fmt::format("one of: {}", fmt::join(names, ", ")),
             .got = key,
             .suggestions = nearest_names(key, names)},
            true);
  }
}

const Json* DocumentReader::object_at(const Json& object, std::string_view key, const std::string& pointer) {
  const auto found = object.find(key);
  if (found == object.end()) return nullptr;
  if (found->is_object()) return &*found;
  wrong_type(child_pointer(pointer, key), "an object", *found);
  return nullptr;
}

const Json* DocumentReader::text_at(const Json& object, std::string_view key, const std::string& pointer) {
  const auto found = object.find(key);
  if (found == object.end()) return nullptr;
  if (found->is_string()) return &*found;
  wrong_type(child_pointer(pointer, key), "a text", *found);
  return nullptr;
}

bool DocumentReader::bool_at(const Json& object, std::string_view key, const std::string& pointer) {
  const auto found = object.find(key);
  if (found == object.end()) return false;
  if (found->is_boolean()) return found->get<bool>();
  wrong_type(child_pointer(pointer, key), "true or false", *found);
  return false;
}

bool DocumentReader::good_id(const std::string& id, const std::string& pointer, std::string_view what) {
  if (is_id(id)) return true;
  problem({.code = "bad_id",
           .pointer = pointer,
           .message = fmt::format(
               "'{}' cannot name {}: names are letters, digits and '_', and start with no digit", id, what),
           .expected = "[A-Za-z_][A-Za-z0-9_]*",
           .got = id,
           .suggestions = {as_id(id)}},
          true);
  return false;
}

std::optional<Precision> DocumentReader::read_precision(const Json& j, const std::string& pointer) {
  std::vector<std::string> names;
  for (const auto& [value, name] : choices(Precision{})) {
    if (j.is_string() && j.get<std::string>() == name) return value;
    names.emplace_back(name);
  }
  const std::string expected = fmt::format("\"{}\"", fmt::join(names, "\" or \""));
  if (!j.is_string()) return wrong_type(pointer, expected, j), std::nullopt;
  const auto got = j.get<std::string>();
  problem({.code = "unknown_choice",
           .pointer = pointer,
           .message = fmt::format("'{}' is not a precision: {}", got, expected),
           .expected = expected,
           .got = got,
           .suggestions = nearest_names(got, names)});
  return std::nullopt;
}

}  // namespace frustum
