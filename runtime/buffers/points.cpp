#include "runtime/buffers/points.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"
#include "runtime/core/param.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

// Both kinds are rows of three numbers; they differ in their homogeneous coordinate.
template <class T, std::vector<glm::dvec3> T::*rows, int w>
struct RowOps {
  static std::span<const double> numbers(const T& t) {
    return {reinterpret_cast<const double*>((t.*rows).data()), 3 * (t.*rows).size()};
  }
  static std::size_t bytes(const T& t) { return sizeof t + (t.*rows).size() * sizeof(glm::dvec3); }
  static void hash(const T& t, Hasher& h) { h.span<double>(numbers(t)); }
  static void save(const T& t, ArchiveWriter& out) { out.span<double>(numbers(t)); }
  static T load(ArchiveReader& r) {
    const std::vector<double> flat = r.vector<double>();
    if (flat.size() % 3 != 0) throw ArchiveError("rows of points that are not whole");
    T t;
    for (std::size_t i = 0; i < flat.size(); i += 3)
      (t.*rows).emplace_back(flat[i], flat[i + 1], flat[i + 2]);
    return t;
  }
  static Health health(const T& t) {
    return to_health(scan(numbers(t)), numbers(t).size(),
                     [](std::size_t i) { return fmt::format("row {}, {}", i / 3, "xyz"[i % 3]); });
  }
  static Json summary(const T& t) {
    Json out = {{"count", (t.*rows).size()}};
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (const glm::dvec3& p : t.*rows) values.push_back(p[axis]);
      out[std::string(1, "xyz"[axis])] = to_json(measure(std::move(values)));
    }
    return out;
  }
  static Json table(const T& t, std::size_t first, std::size_t count) {
    return json_table({"x", "y", "z", "w"}, (t.*rows).size(), first, count, [&](std::size_t i) {
      const glm::dvec3& p = (t.*rows)[i];
      return Json::array({json_number(p.x), json_number(p.y), json_number(p.z), w});
    });
  }
  // Rows of three numbers; a row of two has z = 0.
  static Buffer from_json(const Json& json, ParamReader& reader) {
    const bool flat = json.is_array() && std::all_of(json.begin(), json.end(), [](const Json& row) {
                        return row.is_array() && row.size() == 2;
                      });
    auto t = std::make_shared<T>();
    const std::size_t before = reader.problems();
    if (flat) {
      std::vector<glm::dvec2> plane;
      param_type<std::vector<glm::dvec2>>().read(json, &plane, ParamOptions{}, reader);
      for (const glm::dvec2& p : plane) (t.get()->*rows).emplace_back(p, 0.0);
    } else {
      param_type<std::vector<glm::dvec3>>().read(json, &(t.get()->*rows), ParamOptions{}, reader);
    }
    return reader.problems() == before ? Buffer(Ref<T>(std::move(t))) : Buffer();
  }
};

static_assert(sizeof(glm::dvec3) == 3 * sizeof(double));

}  // namespace

template <>
const BufferType& buffer_type<Points>() {
  static const BufferType type = make_buffer_type<Points, RowOps<Points, &Points::at, 1>>(
      "points", "Places: rows of x, y and z, with w = 1.", "#c9a66b");
  return type;
}
template <>
const BufferType& buffer_type<Vectors>() {
  static const BufferType type = make_buffer_type<Vectors, RowOps<Vectors, &Vectors::along, 0>>(
      "vectors", "Directions with a length: rows of x, y and z, with w = 0.", "#6fa3a6");
  return type;
}

}  // namespace frustum
