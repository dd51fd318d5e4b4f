// The node types as data, schemas and pages: all from the one declaration that each node makes.
#pragma once

#include "runtime/core/registry.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace frustum {

// "mesh", or "mesh or surface".
std::string type_names(const Port& port);
// ", in clip space", ", in world or eye space"; empty where space does not matter.
std::string space_names(const Port& port);
// What a parameter's JSON looks like: "a number", "3 numbers", "list of objects", "flat, gouraud or phong".
std::string value_text(const ParamType& type);
// "at least 1 px", "0 to 180 degrees", "px"; empty for a pure number without bounds.
std::string range_text(const ParamOptions& options);
// "graphs/nodes/clip/homogeneous.json".
std::string example_path(std::string_view node_type);

// "0.8 ns a sample"; empty where the cost was not measured.
std::string cost_text(const EffectCost& cost);

// A node in full: name, family, kind, doc, citations, rows, version, inputs, outputs, effects, and the
// parameters' JSON Schema.
Json node_json(const NodeType& type);

// The knobs of a node: {"param", "values", "basis", "slope", "taste", "default"}, in the order of its parameters.
Json knobs_json(const NodeType& type);

// Draft 2020-12 schemas. Anywhere in a node's parameters the text "$name" may stand for a graph parameter.
Json params_schema(const NodeType& type);
Json graph_schema(const Registry& registry);

// Pages in Markdown.
std::string node_page(const NodeType& type);
std::string node_index(const Registry& registry);
std::string coverage_page(const Registry& registry);

struct CatalogFolders {
  std::string schemas, docs;  // empty: left alone
};
struct CatalogChanges {
  std::vector<std::string> written, removed;
  bool empty() const { return written.empty() && removed.empty(); }
};

// Brings both folders up to date; files that already say the right thing are not touched, pages and
// schemas of nodes that are gone are removed. With `check`, only says what it would do. The text depends
// on nothing but the registry.
CatalogChanges write_catalog(const Registry& registry, const CatalogFolders& folders, bool check);

}  // namespace frustum
