#include "runtime/core/param.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace frustum {
namespace {

using Kind = ParamType::Kind;

std::string shown(const Json& j) {
  std::string s = j.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (s.size() > 60) s = s.substr(0, 57) + "...";
  return s;
}

std::string shown(const Range& r, std::string_view unit) {
  const std::string u = unit.empty() ? "" : fmt::format(" {}", unit);
  const bool low = std::isfinite(r.low), high = std::isfinite(r.high);
  if (low && high)
    return fmt::format("{}{} {}{}{}{}", r.open_low ? "above " : "", r.low, r.open_low ? "and " : "to ",
                       r.open_high  ? "below "
                       : r.open_low ? "at most "
                                    : "",
                       r.high, u);
  if (low) return fmt::format("{} {}{}", r.open_low ? "above" : "at least", r.low, u);
  return fmt::format("{} {}{}", r.open_high ? "below" : "at most", r.high, u);
}

void wrong_type(ParamReader& reader, const std::string& expected, const Json& got) {
  reader.problem("wrong_type", fmt::format("expected {}, got {}", expected, shown(got)), expected,
                 shown(got));
}

bool in_range(double v, const ParamOptions& options, const Json& j, ParamReader& reader) {
  if (options.range.holds(v)) return true;
  const std::string expected = shown(options.range, options.unit);
  reader.problem("out_of_range", fmt::format("{} is out of range: expected {}", shown(j), expected), expected,
                 shown(j));
  return false;
}

bool read_real(const Json& j, double& out, const ParamOptions& options, ParamReader& reader) {
  if (!j.is_number()) {
    wrong_type(reader, "a number", j);
    return false;
  }
  const double v = j.get<double>();
  if (!in_range(v, options, j, reader)) return false;
  out = v;
  return true;
}

template <class T, class Convert>
ParamType scalar(Kind kind, std::string name, bool (Json::*is)() const noexcept, Convert convert) {
  ParamType t{.kind = kind, .name = name};
  t.read = [=](const Json& j, void* value, const ParamOptions&, ParamReader& reader) {
    if (!(j.*is)()) return wrong_type(reader, name, j);
    convert(j, *static_cast<T*>(value), reader);
  };
  return t;
}

bool read_rgb(const Json& j, glm::dvec3& rgb, const ParamOptions& options, ParamReader& reader) {
  if (!j.is_array() || j.size() != 3) {
    wrong_type(reader, "an array of 3 numbers", j);
    return false;
  }
  bool good = true;
  for (std::size_t i = 0; i < 3; ++i)
    reader.inside(i, [&] { good &= read_real(j[i], rgb[static_cast<glm::length_t>(i)], options, reader); });
  return good;
}

void read_color(const Json& j, Color& out, const ParamOptions& options, ParamReader& reader) {
  glm::dvec3 rgb{0};
  if (j.is_number()) {
    if (read_real(j, rgb.r, options, reader)) out.rgb = glm::dvec3{rgb.r};
    return;
  }
  if (!j.is_object()) {
    if (read_rgb(j, rgb, options, reader)) out.rgb = rgb;
    return;
  }
  for (const auto& [key, value] : j.items())
    if (key != "space" && key != "value")
      reader.inside(key, [&, &key = key] {
        reader.problem("unknown_key", fmt::format("'{}' is not a key of a colour", key), "space, value", key);
      });
  if (!j.contains("space") || !j.contains("value") || !j["space"].is_string())
    return wrong_type(reader, R"({"space": NAME, "value": [r, g, b]})", j);
  bool good = true;
  reader.inside("value", [&] { good = read_rgb(j["value"], rgb, options, reader); });
  if (!good) return;
  const auto space = j["space"].get<std::string>();
  if (!reader.to_linear() || !reader.to_linear()(space, rgb)) {
    reader.inside("space", [&] {
      reader.problem("unknown_color_space",
                     fmt::format("'{}' is not a colour space of the configuration", space), "a colour space",
                     space);
    });
    return;
  }
  out.rgb = rgb;
}

void read_matrix(const Json& j, glm::dmat4& out, const ParamOptions& options, ParamReader& reader) {
  const auto is_row = [](const Json& r) { return r.is_array() && r.size() == 4; };
  if (!j.is_array() || j.size() != 4 || !std::all_of(j.begin(), j.end(), is_row))
    return wrong_type(reader, "four rows of four numbers", j);
  glm::dmat4 m{1};
  bool good = true;
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c)
      reader.inside(r, [&] {
        reader.inside(c, [&] {
          good &= read_real(j[r][c], m[static_cast<int>(c)][static_cast<int>(r)], options, reader);
        });
      });
  if (good) out = m;
}

}  // namespace

ParamReader::ParamReader(Diagnostics& problems, std::string pointer, std::string folder, ToLinear to_linear)
    : problems_(problems),
      pointer_(std::move(pointer)),
      folder_(std::move(folder)),
      to_linear_(std::move(to_linear)) {}

void ParamReader::problem(std::string code, std::string message, std::string expected, std::string got,
                          std::vector<std::string> suggestions) {
  problems_.add({.code = std::move(code),
                 .pointer = pointer_,
                 .message = std::move(message),
                 .expected = std::move(expected),
                 .got = std::move(got),
                 .suggestions = std::move(suggestions)});
}

void ParamReader::inside(std::string_view key, const std::function<void()>& body) {
  const std::size_t length = pointer_.size();
  pointer_ = child_pointer(pointer_, key);
  body();
  pointer_.resize(length);
}

void ParamReader::inside(std::size_t index, const std::function<void()>& body) {
  inside(std::to_string(index), body);
}

namespace detail {

ParamType boolean_type() {
  ParamType t = scalar<bool>(Kind::boolean, "true or false", &Json::is_boolean,
                             [](const Json& j, bool& out, ParamReader&) { out = j.get<bool>(); });
  t.write = [](const void* v) { return Json(*static_cast<const bool*>(v)); };
  return t;
}

ParamType text_type() {
  ParamType t =
      scalar<std::string>(Kind::text, "a text", &Json::is_string,
                          [](const Json& j, std::string& out, ParamReader&) { out = j.get<std::string>(); });
  t.write = [](const void* v) { return Json(*static_cast<const std::string*>(v)); };
  return t;
}

ParamType file_type() {
  ParamType t = scalar<FilePath>(
      Kind::file, "a file path", &Json::is_string, [](const Json& j, FilePath& out, ParamReader& reader) {
        auto written = j.get<std::string>();
        // The system would take the part before it for the whole name.
        if (written.find('\0') != std::string::npos)
          return reader.problem("bad_path", fmt::format("{} does not name a file", shown(j)), "a file name",
                                shown(j));
        out.written = std::move(written);
        out.resolved = (std::filesystem::path(reader.folder()) / out.written).string();
      });
  t.write = [](const void* v) { return Json(static_cast<const FilePath*>(v)->written); };
  t.files = [](const void* v, const auto& visit) { visit(*static_cast<const FilePath*>(v)); };
  return t;
}

ParamType real_type() {
  ParamType t{.kind = Kind::real, .name = "a number"};
  t.read = [](const Json& j, void* value, const ParamOptions& options, ParamReader& reader) {
    read_real(j, *static_cast<double*>(value), options, reader);
  };
  t.write = [](const void* v) { return Json(*static_cast<const double*>(v)); };
  return t;
}

ParamType integer_type(IntegerAccess access) {
  ParamType t{.kind = Kind::integer, .name = "an integer"};
  t.read = [access](const Json& j, void* value, const ParamOptions& options, ParamReader& reader) {
    // 4.0 is an integer that was written as a real; 4.5 is not.
    const bool whole = j.is_number_float() && std::abs(j.get<double>()) < 0x1p53 &&
                       j.get<double>() == std::trunc(j.get<double>());
    if (!j.is_number_integer() && !whole) return wrong_type(reader, "an integer", j);
    const double v = j.get<double>();
    if (!in_range(v, options, j, reader)) return;
    const bool fits = whole ? access.store(value, static_cast<std::int64_t>(v))
                      : j.is_number_unsigned() && j.get<std::uint64_t>() > INT64_MAX
                          ? false
                          : access.store(value, j.get<std::int64_t>());
    if (!fits) {
      const std::string expected = fmt::format("{} to {}", access.low, access.high);
      reader.problem("out_of_range", fmt::format("{} is out of range: expected {}", shown(j), expected),
                     expected, shown(j));
    }
  };
  t.write = [access](const void* v) { return Json(access.load(v)); };
  return t;
}

ParamType color_type() {
  ParamType t{.kind = Kind::color, .name = "a colour, [r, g, b], or a number for grey"};
  t.read = [](const Json& j, void* value, const ParamOptions& options, ParamReader& reader) {
    read_color(j, *static_cast<Color*>(value), options, reader);
  };
  t.write = [](const void* v) {
    const glm::dvec3& c = static_cast<const Color*>(v)->rgb;
    return Json::array({c.r, c.g, c.b});
  };
  return t;
}

ParamType matrix_type() {
  ParamType t{.kind = Kind::matrix, .name = "four rows of four numbers"};
  t.read = [](const Json& j, void* value, const ParamOptions& options, ParamReader& reader) {
    read_matrix(j, *static_cast<glm::dmat4*>(value), options, reader);
  };
  t.write = [](const void* v) {
    const auto& m = *static_cast<const glm::dmat4*>(v);
    Json rows = Json::array();
    for (int r = 0; r < 4; ++r) rows.push_back(Json::array({m[0][r], m[1][r], m[2][r], m[3][r]}));
    return rows;
  };
  return t;
}

ParamType choice_type(std::vector<std::string> names, ChoiceAccess access) {
  std::string listed;
  for (const auto& n : names) listed += fmt::format("{}\"{}\"", listed.empty() ? "" : ", ", n);
  ParamType t{.kind = Kind::choice, .name = "one of " + listed, .choices = names};
  t.read = [=](const Json& j, void* value, const ParamOptions&, ParamReader& reader) {
    if (!j.is_string()) return wrong_type(reader, "one of " + listed, j);
    const auto text = j.get<std::string>();
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end())
      return reader.problem("unknown_choice", fmt::format("'{}' is not one of the choices: {}", text, listed),
                            listed, text, nearest_names(text, names));
    access.store(value, static_cast<std::size_t>(found - names.begin()));
  };
  t.write = [=](const void* v) { return Json(names[access.load(v)]); };
  return t;
}

ParamType array_type(const ParamType& element, std::size_t count, ArrayAccess access) {
  const std::string name = count != 0 ? fmt::format("an array of {}: {} each", count, element.name)
                                      : fmt::format("an array: {} each", element.name);
  ParamType t{.kind = Kind::array, .name = name, .element = &element, .count = count};
  t.read = [=, &element](const Json& j, void* value, const ParamOptions& options, ParamReader& reader) {
    if (!j.is_array() || (count != 0 && j.size() != count)) return wrong_type(reader, name, j);
    if (access.resize != nullptr) access.resize(value, j.size());
    for (std::size_t i = 0; i < j.size(); ++i)
      reader.inside(i, [&] { element.read(j[i], access.at(value, i), options, reader); });
  };
  t.write = [=, &element](const void* v) {
    Json out = Json::array();
    // at() serves reading and writing alike; nothing is written through the pointer here.
    for (std::size_t i = 0; i < access.size(v); ++i)
      out.push_back(element.write(access.at(const_cast<void*>(v), i)));
    return out;
  };
  if (element.files)
    t.files = [=, &element](const void* v, const auto& visit) {
      for (std::size_t i = 0; i < access.size(v); ++i)
        element.files(access.at(const_cast<void*>(v), i), visit);
    };
  return t;
}

ParamType optional_type(const ParamType& element, OptionalAccess access) {
  ParamType t{.kind = Kind::optional, .name = element.name + ", or null", .element = &element};
  t.read = [=, &element](const Json& j, void* value, const ParamOptions& options, ParamReader& reader) {
    if (j.is_null()) return access.reset(value);
    const std::size_t before = reader.problems();
    element.read(j, access.emplace(value), options, reader);
    if (reader.problems() != before) access.reset(value);
  };
  t.write = [=, &element](const void* v) {
    const void* inner = access.get(v);
    return inner != nullptr ? element.write(inner) : Json(nullptr);
  };
  if (element.files)
    t.files = [=, &element](const void* v, const auto& visit) {
      if (const void* inner = access.get(v)) element.files(inner, visit);
    };
  return t;
}

ParamType record_type(ParamType t) {
  t.read = [copy = t](const Json& j, void* value, const ParamOptions&, ParamReader& reader) {
    read_record(copy, j, value, reader);
  };
  t.write = [copy = t](const void* v) { return write_record(copy, v); };
  t.files = [fields = t.fields](const void* v, const auto& visit) {
    for (const ParamField& f : fields)
      if (f.type->files) f.type->files(static_cast<const char*>(v) + f.offset, visit);
  };
  return t;
}

}  // namespace detail

void read_record(const ParamType& type, const Json& j, void* value, ParamReader& reader) {
  if (!j.is_object()) return wrong_type(reader, "an object", j);
  std::vector<std::string> names;
  for (const ParamField& f : type.fields) names.push_back(f.name);
  for (const auto& [key, item] : j.items()) {
    const auto found = std::find(names.begin(), names.end(), key);
    reader.inside(key, [&, &key = key, &item = item] {
      if (found == names.end())
        return reader.problem("unknown_param", fmt::format("'{}' is not a parameter here", key),
                              fmt::format("one of: {}", fmt::join(names, ", ")), key,
                              nearest_names(key, names));
      const ParamField& f = type.fields[static_cast<std::size_t>(found - names.begin())];
      f.type->read(item, static_cast<char*>(value) + f.offset, f.options, reader);
    });
  }
  if (type.exactly_one && j.size() != 1)
    reader.problem("wrong_type", fmt::format("expected exactly one of: {}", fmt::join(names, ", ")),
                   fmt::format("one of: {}", fmt::join(names, ", ")), fmt::format("{} keys", j.size()));
}

Json write_record(const ParamType& type, const void* value) {
  Json out = Json::object();
  for (const ParamField& f : type.fields) {
    Json item = f.type->write(static_cast<const char*>(value) + f.offset);
    if (type.exactly_one && item.is_null()) continue;
    out[f.name] = std::move(item);
  }
  return out;
}

}  // namespace frustum
