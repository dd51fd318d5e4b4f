#include "runtime/buffers/point_columns.h"

#include "runtime/buffers/material.h"

namespace frustum {
namespace {

bool is_uv(const Column& c) { return is_uv_column(c.name()) && c.width() == 2; }

// What the names of a column's planes begin with.
std::string prefix_of(const Column& c) {
  return c.name() == "normal" ? "N" : c.name() == "world" ? "P" : c.name();
}

std::vector<std::string> components(const Column& c) {
  if (is_uv(c)) return {"u", "v"};
  std::vector<std::string> out;
  for (int i = 0; i < c.width(); ++i) out.emplace_back(1, "xyzw"[i]);
  return out;
}

}  // namespace

std::optional<kernels::AttributeDomain> domain_of(const Column& c) {
  using kernels::AttributeDomain;
  if (c.kind() != NumberKind::f32 && c.kind() != NumberKind::f64) return std::nullopt;
  if (c.domain() == Domain::vertex) return AttributeDomain::vertex;
  if (c.domain() == Domain::corner) return AttributeDomain::corner;
  if (c.domain() == Domain::face) return AttributeDomain::face;
  return std::nullopt;
}

bool has_slopes(const Column& c) { return is_uv(c) || (c.name() == "world" && c.width() == 3); }

std::vector<std::string> value_names(const Column& c) {
  if (c.width() == 1) return {c.name()};
  std::vector<std::string> names;
  for (const std::string& of : components(c)) names.push_back(prefix_of(c) + "." + of);
  return names;
}

std::vector<std::string> slope_names(const Column& c) {
  std::vector<std::string> names;
  for (const char* along : {"_dx", "_dy"})
    for (const std::string& of : components(c)) names.push_back(prefix_of(c) + ".d" + of + along);
  return names;
}

}  // namespace frustum
