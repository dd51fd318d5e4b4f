// The JSON Schema of suite files, draft 2020-12: the keys come from their declarations, what has several
// forms from here.
#include "runtime/app/suite/invariants.h"
#include "runtime/app/suite/keys.h"
#include "runtime/app/suite/suite.h"

#include <nlohmann/json.hpp>

namespace frustum {
namespace {

constexpr const char* draft = "https://json-schema.org/draft/2020-12/schema";

Json described(const Json& from, Json schema) {
  Json out = Json::object();
  if (from.contains("description")) out["description"] = from["description"];
  out.update(schema);
  return out;
}

// Absent is absent here: no null, and no default that says nothing.
Json plain(Json schema) {
  if (schema.contains("anyOf") && schema["anyOf"].size() == 2 &&
      schema["anyOf"][1] == Json{{"type", "null"}}) {
    const Json inner = schema["anyOf"][0];
    schema.erase("anyOf");
    schema.update(inner);
  }
  if (schema.contains("default") &&
      (schema["default"].is_null() || schema["default"] == "" || schema["default"].empty()))
    schema.erase("default");
  if (schema.contains("properties"))
    for (auto& [key, value] : schema["properties"].items()) value = plain(value);
  return schema;
}

template <class Keys>
Json keys_schema(const Json& required, const std::map<std::string, Json>& forms) {
  static const Keys defaults;
  Json out = plain(json_schema(param_type<Keys>(), {}, &defaults));
  for (const auto& [key, form] : forms) out["properties"][key] = described(out["properties"].at(key), form);
  if (!required.empty()) out["required"] = required;
  return out;
}

Json one_of(std::vector<Json> forms) { return {{"oneOf", std::move(forms)}}; }
Json list_of(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

const Json& values() {
  static const Json j = {{"type", "object"}};
  return j;
}
const Json& matrix() {
  static const Json j = {{"type", "object"}, {"additionalProperties", {{"type", "array"}, {"minItems", 1}}}};
  return j;
}

Json statistics_schema() {
  const Json number = {{"type", "number"}};
  const Json interval =
      one_of({number, Json{{"type", "array"}, {"items", number}, {"minItems", 2}, {"maxItems", 2}}});
  Json properties = {{"plane", {{"type", "string"}}}, {"column", {{"type", "string"}}}};
  for (const char* name : {"min", "max", "mean", "deviation", "sum", "count"}) properties[name] = interval;
  return {{"type", "object"},
          {"properties", std::move(properties)},
          {"patternProperties", {{"^p([0-9]|[1-9][0-9]|100)$", interval}}},
          {"additionalProperties", false}};
}

Json invariant_schema() {
  std::vector<std::string> names;
  for (const InvariantType& t : invariant_types()) names.emplace_back(t.name);
  const Json name = {{"type", "string"}, {"enum", names}};
  return one_of({name, keys_schema<suite_keys::Invariant>({"name"}, {{"name", name}})});
}

Json check_schema() {
  const Json number = {{"type", "number"}};
  const Json text = {{"type", "string"}};
  const Json probe = keys_schema<suite_keys::Probe>({}, {{"equals", one_of({number, list_of(number)})}});
  const Json relation = one_of({Json{{"enum", {"same", "mirror_x", "mirror_y", "rotate_180"}}},
                                keys_schema<suite_keys::Relation>({}, {})});
  return keys_schema<suite_keys::Check>(
      {"port"}, {{"same_as", one_of({text, keys_schema<suite_keys::OtherRun>({}, {{"set", values()}})})},
                 {"metamorphic", keys_schema<suite_keys::Metamorphic>(
                                     {"expect"}, {{"set", values()}, {"expect", relation}})},
                 {"shape", Json{{"type", "object"}}},
                 {"statistics", statistics_schema()},
                 {"invariant", invariant_schema()},
                 {"probe", probe},
                 {"analytic", keys_schema<suite_keys::Analytic>({"value", "equals"}, {})}});
}

Json case_schema() {
  const Json count = {{"type", "integer"}, {"minimum", 0}};
  const Json expect = keys_schema<suite_keys::Expect>({"code"}, {});
  const Json budget = keys_schema<suite_keys::Budget>(
      {}, {{"bytes", one_of({count, Json{{"type", "string"}}})},
           {"counters", Json{{"type", "object"}, {"additionalProperties", count}}}});
  return keys_schema<suite_keys::Case>(
      {"id", "graph"},
      {{"set", values()},
       {"matrix", matrix()},
       {"checks", list_of(check_schema())},
       {"expect", one_of({expect, list_of(expect)})},
       {"budget", budget},
       {"waiver", keys_schema<suite_keys::Waiver>(
                      {"until", "why"}, {{"until", Json{{"type", "string"}, {"format", "date"}}}})}});
}

}  // namespace

Json suite_schema() {
  const Json text = {{"type", "string"}};
  Json out = {{"$schema", draft}, {"title", "frustum suite"}};
  out.update(Json{{"type", "object"},
                  {"properties",
                   {{"$schema", text},
                    {"format", {{"const", "frustum.suite/1"}}},
                    {"title", {{"type", "string"}, {"description", "One line for people."}}},
                    {"presets",
                     {{"type", "object"},
                      {"additionalProperties",
                       keys_schema<suite_keys::Preset>({}, {{"set", values()}, {"matrix", matrix()}})}}},
                    {"cases", list_of(case_schema())}}},
                  {"additionalProperties", false},
                  {"required", {"format", "cases"}}});
  return out;
}

}  // namespace frustum
