#include "runtime/io/gltf_json.h"

#include "runtime/core/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace frustum::gltf {
namespace {

std::optional<std::uint64_t> whole_number(const Tree& j) {
  constexpr double most = 0x1p53;
  if (j.is_number_unsigned() && j.get<std::uint64_t>() <= std::uint64_t{1} << 53)
    return j.get<std::uint64_t>();
  if (!j.is_number_float()) return {};
  const double v = j.get<double>();
  if (!(v >= 0 && v <= most) || v != std::floor(v)) return {};
  return static_cast<std::uint64_t>(v);
}

}  // namespace

void fail(const FilePath& file, std::string_view element, std::string_view what) {
  throw NodeError("malformed_file", element.empty() ? fmt::format("{}: {}", file.written, what)
                                                    : fmt::format("{}: {}: {}", file.written, element, what));
}

Object::Object(const Tree& json, std::string path, const FilePath& file)
    : json_(json), path_(std::move(path)), file_(file) {
  if (!json.is_object()) fail("this must be an object");
}

const Tree* Object::find(std::string_view key) const {
  const auto it = json_.find(key);
  return it == json_.end() ? nullptr : &*it;
}

std::string Object::way_to(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

void Object::fail_at(std::string_view key, std::string_view what) const {
  gltf::fail(file_, way_to(key), what);
}

std::vector<std::string> Object::keys() const {
  std::vector<std::string> out;
  for (const auto& [key, value] : json_.items()) out.push_back(key);
  return out;
}

std::optional<std::uint64_t> Object::integer(std::string_view key) const {
  const Tree* j = find(key);
  if (j == nullptr) return {};
  const auto value = whole_number(*j);
  if (!value) fail_at(key, "this must be a whole number that is not negative");
  return value;
}

std::uint64_t Object::integer(std::string_view key, std::uint64_t fallback) const {
  return integer(key).value_or(fallback);
}

std::uint64_t Object::required(std::string_view key) const {
  const auto value = integer(key);
  if (!value) fail(fmt::format("there is no \"{}\"", key));
  return *value;
}

std::optional<std::size_t> Object::index(std::string_view key, std::string_view of, std::size_t size) const {
  const auto value = integer(key);
  if (value && *value >= size) fail_at(key, fmt::format("{} is none of the {} {}", *value, size, of));
  return value;
}

std::optional<double> Object::number(std::string_view key) const {
  const Tree* j = find(key);
  if (j == nullptr) return {};
  if (!j->is_number()) fail_at(key, "this must be a number");
  return j->get<double>();
}

double Object::number(std::string_view key, double fallback) const { return number(key).value_or(fallback); }

std::optional<bool> Object::boolean(std::string_view key) const {
  const Tree* j = find(key);
  if (j == nullptr) return {};
  if (!j->is_boolean()) fail_at(key, "this must be true or false");
  return j->get<bool>();
}

std::optional<std::string> Object::text(std::string_view key) const {
  const Tree* j = find(key);
  if (j == nullptr) return {};
  if (!j->is_string()) fail_at(key, "this must be a text");
  return j->get<std::string>();
}

std::string Object::written(std::string_view key) const {
  const Tree* j = find(key);
  if (j == nullptr || j->is_structured()) return {};
  return j->is_string() ? j->get<std::string>() : j->dump();
}

const Tree* Object::find_array(std::string_view key) const {
  const Tree* j = find(key);
  if (j != nullptr && !j->is_array()) fail_at(key, "this must be an array");
  return j;
}

bool Object::numbers(std::string_view key, double* out, std::size_t n) const {
  const Tree* j = find_array(key);
  if (j == nullptr) return false;
  if (j->size() != n) fail_at(key, fmt::format("this must be an array of {} numbers", n));
  for (std::size_t i = 0; i < n; ++i) {
    if (!(*j)[i].is_number()) fail_at(key, fmt::format("this must be an array of {} numbers", n));
    out[i] = (*j)[i].get<double>();
  }
  return true;
}

bool Object::has_object(std::string_view key) const {
  const Tree* j = find(key);
  return j != nullptr && j->is_object();
}

std::optional<Object> Object::object(std::string_view key) const {
  const Tree* j = find(key);
  if (j == nullptr) return {};
  return Object(*j, way_to(key), file_);
}

std::optional<Object> Object::extension(std::string_view name) const {
  const auto all = object("extensions");
  return all ? all->object(name) : std::nullopt;
}

std::vector<Object> Object::objects(std::string_view key) const {
  std::vector<Object> out;
  const Tree* j = find_array(key);
  if (j == nullptr) return out;
  out.reserve(j->size());
  for (std::size_t i = 0; i < j->size(); ++i)
    out.emplace_back((*j)[i], fmt::format("{}[{}]", way_to(key), i), file_);
  return out;
}

std::vector<std::size_t> Object::indices(std::string_view key, std::string_view of, std::size_t size) const {
  std::vector<std::size_t> out;
  const Tree* j = find_array(key);
  if (j == nullptr) return out;
  for (std::size_t i = 0; i < j->size(); ++i) {
    const auto value = whole_number((*j)[i]);
    if (!value || *value >= size)
      fail_at(fmt::format("{}[{}]", key, i), fmt::format("this is none of the {} {}", size, of));
    out.push_back(*value);
  }
  return out;
}

std::vector<std::string> Object::texts(std::string_view key) const {
  std::vector<std::string> out;
  const Tree* j = find_array(key);
  if (j == nullptr) return out;
  for (const Tree& entry : *j) {
    if (!entry.is_string()) fail_at(key, "this must be an array of texts");
    out.push_back(entry.get<std::string>());
  }
  return out;
}

}  // namespace frustum::gltf
