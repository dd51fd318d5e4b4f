// Typed access to the objects of a glTF document, with the place of every fault.
#pragma once

#include "runtime/core/param.h"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::gltf {

// Members sorted by key: reading an object of n members takes n log n, not n^2 as with those that keep their
// order.
using Tree = nlohmann::json;

// Throws NodeError("malformed_file") with "box.gltf: accessors[3]: what"; `element` may be empty.
[[noreturn]] void fail(const FilePath& file, std::string_view element, std::string_view what);

// One object of the document and its way from the root, "meshes[2].primitives[0]". A member that is not there
// is empty or the fallback; one of another type than asked for is a fault, never a silent default. The
// document and the file outlive it.
class Object {
 public:
  Object(const Tree& json, std::string path, const FilePath& file);

  const std::string& path() const { return path_; }
  bool has(std::string_view key) const { return find(key) != nullptr; }
  bool has_object(std::string_view key) const;
  std::vector<std::string> keys() const;

  // Whole numbers from 0 to 2^53, also where they are written as 3.0.
  std::optional<std::uint64_t> integer(std::string_view key) const;
  std::uint64_t integer(std::string_view key, std::uint64_t fallback) const;
  std::uint64_t required(std::string_view key) const;
  // An index into an array of `size` elements called `of`.
  std::optional<std::size_t> index(std::string_view key, std::string_view of, std::size_t size) const;

  std::optional<double> number(std::string_view key) const;  // finite: JSON has no others
  double number(std::string_view key, double fallback) const;
  std::optional<bool> boolean(std::string_view key) const;
  std::optional<std::string> text(std::string_view key) const;
  // A text, or whatever else is there as JSON: where glTF 1 and 2 differ.
  std::string written(std::string_view key) const;
  template <std::size_t n>
  std::optional<std::array<double, n>> numbers(std::string_view key) const {
    std::array<double, n> out{};
    if (!numbers(key, out.data(), n)) return {};
    return out;
  }

  std::optional<Object> object(std::string_view key) const;
  // extensions.NAME
  std::optional<Object> extension(std::string_view name) const;
  std::vector<Object> objects(std::string_view key) const;
  std::vector<std::size_t> indices(std::string_view key, std::string_view of, std::size_t size) const;
  std::vector<std::string> texts(std::string_view key) const;

  [[noreturn]] void fail(std::string_view what) const { gltf::fail(file_, path_, what); }
  [[noreturn]] void fail_at(std::string_view key, std::string_view what) const;

 private:
  const Tree* find(std::string_view key) const;
  const Tree* find_array(std::string_view key) const;
  std::string way_to(std::string_view key) const;
  bool numbers(std::string_view key, double* out, std::size_t n) const;

  const Tree& json_;
  std::string path_;
  const FilePath& file_;
};

}  // namespace frustum::gltf
