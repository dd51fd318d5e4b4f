#include "runtime/buffers/surface.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

std::span<const double> numbers(const Surface& s) {
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double));
  return {s.points.empty() ? nullptr : &s.points[0].x, 3 * s.points.size()};
}

struct Ops {
  static std::size_t bytes(const Surface& s) {
    return sizeof s + s.points.size() * sizeof s.points[0] + s.patches.size() * sizeof s.patches[0];
  }
  static void hash(const Surface& s, Hasher& h) {
    h.value(s.space).span(numbers(s)).span(std::span<const std::array<std::uint32_t, 16>>(s.patches));
  }
  static void save(const Surface& s, ArchiveWriter& w) {
    w.value(s.space).span<glm::dvec3>(s.points).span<std::array<std::uint32_t, 16>>(s.patches);
  }
  static Surface load(ArchiveReader& r) {
    Surface s;
    s.space = r.choice(Space::screen);
    s.points = r.vector<glm::dvec3>();
    s.patches = r.vector<std::array<std::uint32_t, 16>>();
    return s;
  }
  static Health health(const Surface& s) {
    return to_health(scan(numbers(s)), numbers(s).size(),
                     [](std::size_t i) { return fmt::format("control point {}", i / 3); });
  }
  static Json summary(const Surface& s) {
    Json out = {
        {"patches", s.patches.size()}, {"control_points", s.points.size()}, {"space", name_of(s.space)}};
    Json parts = Json::array();
    for (int k = 0; k < 3; ++k) {
      std::vector<double> values;
      for (const glm::dvec3& p : s.points) values.push_back(p[k]);
      Json part = {{"name", std::string(1, "xyz"[k])}};
      part.update(to_json(measure(std::move(values))));
      parts.push_back(std::move(part));
    }
    out["components"] = std::move(parts);
    return out;
  }
  static Json table(const Surface& s, std::size_t first, std::size_t count) {
    return json_table({"x", "y", "z"}, s.points.size(), first, count, [&](std::size_t i) {
      return Json{json_number(s.points[i].x), json_number(s.points[i].y), json_number(s.points[i].z)};
    });
  }
};

}  // namespace

template <>
const BufferType& buffer_type<Surface>() {
  static const BufferType type = make_buffer_type<Surface, Ops>(
      "surface", "Bicubic Bezier patches over shared control points.", "#5a8fc7");
  return type;
}

}  // namespace frustum
