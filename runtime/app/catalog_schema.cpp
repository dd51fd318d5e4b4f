// JSON Schemas of graph files, draft 2020-12, for editors: what they accept, `frustum check`
// accepts or explains.
#include "runtime/app/catalog.h"

#include <nlohmann/json.hpp>

namespace frustum {
namespace {

constexpr const char* draft = "https://json-schema.org/draft/2020-12/schema";
constexpr const char* identifier = "^[A-Za-z_][A-Za-z0-9_]*$";

Json text(const char* doc) { return {{"type", "string"}, {"description", doc}}; }

Json object(Json properties, Json required = Json::array()) {
  Json out = {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
  if (!required.empty()) out["required"] = std::move(required);
  return out;
}

Json list(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

Json one_of(std::vector<Json> alternatives) { return {{"oneOf", std::move(alternatives)}}; }

const Json& graph_parameter() {
  static const Json j = {{"type", "string"}, {"pattern", "^\\$[A-Za-z_]"}};
  return j;
}

// Lets "$name" stand for every value inside a parameter's schema.
Json with_references(Json schema) {
  if (schema.contains("properties"))
    for (auto& [key, value] : schema["properties"].items()) value = with_references(value);
  if (schema.contains("items")) schema["items"] = with_references(schema["items"]);
  for (const char* key : {"oneOf", "anyOf"})
    if (schema.contains(key))
      for (auto& alternative : schema[key])
        if (alternative.contains("properties") || alternative.contains("items"))
          alternative = with_references(alternative);
  if (schema.value("type", "") == "string" && !schema.contains("enum")) return schema;  // already any text
  Json out = Json::object();
  for (const char* key : {"description", "default", "x-unit"})
    if (schema.contains(key)) {
      out[key] = schema[key];
      schema.erase(key);
    }
  out["anyOf"] = Json::array({std::move(schema), graph_parameter()});
  return out;
}

// A link "node.port", several of them, or a literal, as the port allows.
Json input_schema(const Port& port) {
  const Json link = {{"type", "string"},
                     {"pattern", "^[$]?[A-Za-z_][A-Za-z0-9_]*([.][A-Za-z_][A-Za-z0-9_]*)?$"}};
  Json one = link;
  bool literal = false;
  for (const BufferType* t : port.types) literal |= t->from_json != nullptr;
  if (literal) one = one_of({link, object({{"value", Json::object()}}, {"value"})});
  if (port.list) one = one_of({one, list(one)});
  Json out = {{"description", port.doc}};
  out.update(one);
  return out;
}

Json precision_schema() {
  return {{"type", "string"},
          {"enum", {"single", "double"}},
          {"description", "The Real in which nodes compute."}};
}

// A node that is another graph.
Json subgraph_schema() {
  const Json links = one_of({Json{{"type", "string"}}, list({{"type", "string"}}), Json{{"type", "object"}}});
  return object(
      {{"type", {{"const", "graph"}}},
       {"file", text("A graph file, or lib:NAME.")},
       {"in", {{"type", "object"}, {"additionalProperties", links}}},
       {"params", {{"type", "object"}, {"description", "Values of that graph's parameters."}}},
       {"precision", precision_schema()},
       {"overrides", {{"type", "object"}, {"description", "NODE:PARAM inside it, and the value."}}}},
      {"type", "file"});
}

Json outputs_schema() {
  const Json source = text("A port: NODE.PORT, or NODE for its first output.");
  Json out = object(
      {{"from", source},
       {"layers",
        {{"type", "object"},
         {"additionalProperties", source},
         {"description", "Layers of one file by name; \"\" is the main one."}}},
       {"file", text("Relative to --out; {frame} is the number of the frame.")},
       {"bits", {{"type", "integer"}, {"enum", {8, 16, 32}}, {"description", "Bits of a channel."}}},
       {"compression", text("A compression of the format: zip or piz for .exr, quality:90 for .jpg.")}});
  return {{"type", "object"},
          {"propertyNames", {{"pattern", identifier}}},
          {"additionalProperties", std::move(out)}};
}

}  // namespace

Json params_schema(const NodeType& type) {
  const auto defaults = type.default_params();
  Json params = json_schema(type.params, {}, defaults.get());
  for (auto& [name, schema] : params["properties"].items()) schema = with_references(schema);
  Json inputs = Json::object(), required = Json::array();
  for (const Port& p : type.inputs) {
    inputs[p.name] = input_schema(p);
    if (!p.optional && !p.list) required.push_back(p.name);
  }
  Json must = Json::array({"type"});
  if (!required.empty()) must.push_back("in");
  Json out = {{"$schema", draft}, {"title", type.name}, {"description", type.doc}};
  out.update(object({{"type", {{"const", type.name}}},
                     {"in", object(std::move(inputs), required)},
                     {"params", std::move(params)},
                     {"precision", precision_schema()}},
                    must));
  return out;
}

Json graph_schema(const Registry& registry) {
  Json node = {{"oneOf", Json::array()}};
  for (const auto& [name, type] : registry) node["oneOf"].push_back({{"$ref", "nodes/" + name + ".json"}});
  node["oneOf"].push_back(subgraph_schema());
  Json out = {{"$schema", draft}, {"title", "frustum graph"}};
  const Json input = object({{"type", text("A kind of buffer.")},
                             {"list", {{"type", "boolean"}}},
                             {"optional", {{"type", "boolean"}}},
                             {"doc", text("What it is for.")}},
                            {"type"});
  const Json inputs = {
      {"type", "object"},
      {"propertyNames", {{"pattern", identifier}}},
      {"additionalProperties", input},
      {"description", "What the graph takes when another uses it as a node; \"$name\" links to it."}};
  out.update(object(
      {{"$schema", {{"type", "string"}}},
       {"format", {{"const", "frustum.graph/1"}}},
       {"title", text("One line for people.")},
       {"params",
        {{"type", "object"},
         {"propertyNames", {{"pattern", identifier}}},
         {"description", "Graph parameters and their values; \"$name\" takes one."}}},
       {"precision", precision_schema()},
       {"seed", {{"type", "integer"}, {"minimum", 0}, {"description", "Of all random numbers."}}},
       {"inputs", inputs},
       {"nodes",
        {{"type", "object"}, {"propertyNames", {{"pattern", identifier}}}, {"additionalProperties", node}}},
       {"outputs", outputs_schema()},
       {"ui", {{"type", "object"}, {"description", "Positions and the like; never part of a hash."}}}},
      {"format", "nodes"}));
  return out;
}

}  // namespace frustum
