#include "runtime/core/param.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace frustum {
namespace {

using Kind = ParamType::Kind;

void put_range(Json& out, const ParamOptions& options) {
  const Range& r = options.range;
  if (std::isfinite(r.low)) out[r.open_low ? "exclusiveMinimum" : "minimum"] = r.low;
  if (std::isfinite(r.high)) out[r.open_high ? "exclusiveMaximum" : "maximum"] = r.high;
  if (!options.unit.empty()) out["x-unit"] = options.unit;
}

Json numbers(std::size_t count, const ParamOptions& options) {
  Json item = {{"type", "number"}};
  put_range(item, options);
  return {{"type", "array"}, {"items", item}, {"minItems", count}, {"maxItems", count}};
}

Json color_schema(const ParamOptions& options) {
  const Json rgb = numbers(3, options);
  Json grey = {{"type", "number"}};
  put_range(grey, options);
  return {{"oneOf", Json::array({rgb,
                                 grey,
                                 {{"type", "object"},
                                  {"properties", {{"space", {{"type", "string"}}}, {"value", rgb}}},
                                  {"required", Json::array({"space", "value"})},
                                  {"additionalProperties", false}}})}};
}

Json knob_json(const Knob& knob) {
  Json values = Json::array();
  for (const std::string& v : knob.values) {
    Json value = Json::parse(v, nullptr, false);
    values.push_back(value.is_discarded() ? Json(v) : std::move(value));
  }
  Json out = {{"values", std::move(values)}, {"basis", knob.basis}};
  if (knob.slope) out["slope"] = *knob.slope;
  if (knob.taste) out["taste"] = true;
  return out;
}

Json record_schema(const ParamType& type, const void* defaults) {
  Json properties = Json::object();
  for (const ParamField& f : type.fields) {
    const void* member = defaults != nullptr ? static_cast<const char*>(defaults) + f.offset : nullptr;
    Json p = {{"description", f.doc}};
    p.update(json_schema(*f.type, f.options, member));
    if (f.knob) p["x-knob"] = knob_json(*f.knob);
    properties[f.name] = std::move(p);
  }
  Json out = {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
  if (type.exactly_one) out["minProperties"] = out["maxProperties"] = 1;
  return out;
}

Json shape(const ParamType& type, const ParamOptions& options, const void* defaults) {
  Json out;
  switch (type.kind) {
    case Kind::boolean: return {{"type", "boolean"}};
    case Kind::integer: out = {{"type", "integer"}}; break;
    case Kind::real: out = {{"type", "number"}}; break;
    case Kind::text: return {{"type", "string"}};
    case Kind::file: return {{"type", "string"}, {"format", "path"}};
    case Kind::color: return color_schema(options);
    case Kind::choice: return {{"type", "string"}, {"enum", type.choices}};
    case Kind::matrix:
      return {{"type", "array"}, {"items", numbers(4, options)}, {"minItems", 4}, {"maxItems", 4}};
    case Kind::optional:
      return {{"anyOf", Json::array({shape(*type.element, options, nullptr), {{"type", "null"}}})}};
    case Kind::record: return record_schema(type, defaults);
    case Kind::array:
      out = {{"type", "array"}, {"items", json_schema(*type.element, options, nullptr)}};
      if (type.count != 0) out["minItems"] = out["maxItems"] = type.count;
      return out;
  }
  put_range(out, options);
  return out;
}

}  // namespace

Json json_schema(const ParamType& type, const ParamOptions& options, const void* defaults) {
  Json out = shape(type, options, defaults);
  if (defaults != nullptr && type.kind != Kind::record) out["default"] = type.write(defaults);
  return out;
}

}  // namespace frustum
