#include "runtime/app/catalog.h"

#include "runtime/app/files.h"
#include "runtime/app/suite/suite.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace frustum {
namespace fs = std::filesystem;
namespace {

Json port_json(const Port& port) {
  Json types = Json::array(), spaces = Json::array();
  for (const BufferType* t : port.types) types.push_back(t->name);
  for (const auto& [space, name] : choices(Space{}))
    if (port.spaces.has(space)) spaces.push_back(name);
  return {{"name", port.name},         {"doc", port.doc},     {"types", types},  {"list", port.list},
          {"optional", port.optional}, {"tiled", port.tiled}, {"spaces", spaces}};
}

Json ports_json(const std::vector<Port>& ports) {
  Json out = Json::array();
  for (const Port& p : ports) out.push_back(port_json(p));
  return out;
}

class Writer {
 public:
  explicit Writer(bool check) : check_(check) {}

  void file(const fs::path& path, const std::string& text) {
    std::error_code none;
    if (check_ ? !fs::is_regular_file(path, none) || read_text(path) != text : write_if_changed(path, text))
      changes.written.push_back(path.generic_string());
  }
  void json(const fs::path& path, const Json& j) { file(path, j.dump(2) + "\n"); }

  // Removes the files of `folder` with this ending whose names are not expected.
  void keep_only(const fs::path& folder, const std::string& ending, const std::set<std::string>& expected) {
    std::error_code none;
    std::vector<fs::path> stale;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
      const std::string name = entry.path().filename().string();
      if (name.ends_with(ending) && !expected.contains(name)) stale.push_back(entry.path());
    }
    std::sort(stale.begin(), stale.end());
    for (const fs::path& path : stale) {
      changes.removed.push_back(path.generic_string());
      if (!check_) fs::remove(path, none);
    }
  }

  CatalogChanges changes;

 private:
  bool check_;
};

Json effects_json(const std::vector<EffectDoc>& effects) {
  Json out = Json::array();
  for (const EffectDoc& e : effects) {
    Json j = {{"name", e.name}, {"doc", e.doc}, {"shortcut", e.shortcut}};
    if (!e.cost.item.empty()) j["cost"] = {{"item", e.cost.item}, {"ns", e.cost.ns}};
    out.push_back(std::move(j));
  }
  return out;
}

}  // namespace

Json node_json(const NodeType& type) {
  const auto defaults = type.default_params();
  return {{"name", type.name},
          {"family", type.name.substr(0, type.name.find('.'))},
          {"kind", type.is_pixel() ? "pixels" : "geometry"},
          {"doc", type.doc},
          {"citations", type.citations},
          {"rows", type.rows},
          {"version", type.version},
          {"foreign", type.foreign},
          {"inputs", ports_json(type.inputs)},
          {"outputs", ports_json(type.outputs)},
          {"effects", effects_json(type.effects)},
          {"params", json_schema(type.params, {}, defaults.get())},
          {"example", example_path(type.name)}};
}

Json knobs_json(const NodeType& type) {
  Json out = Json::array();
  const auto defaults = type.default_params();
  const Json schema = json_schema(type.params, {}, defaults.get());
  for (const ParamField& f : type.params.fields) {
    if (!f.knob) continue;
    Json knob = schema["properties"][f.name]["x-knob"];
    knob["param"] = f.name;
    knob["default"] = f.type->write(static_cast<const char*>(defaults.get()) + f.offset);
    out.push_back(std::move(knob));
  }
  return out;
}

CatalogChanges write_catalog(const Registry& registry, const CatalogFolders& folders, bool check) {
  Writer out(check);
  std::set<std::string> schemas, pages{"index.md"};
  for (const auto& [name, type] : registry) schemas.insert(name + ".json"), pages.insert(name + ".md");
  if (!folders.schemas.empty()) {
    const fs::path root = folders.schemas;
    out.json(root / "graph.schema.json", graph_schema(registry));
    out.json(root / "suite.schema.json", suite_schema());
    for (const auto& [name, type] : registry)
      out.json(root / "nodes" / (name + ".json"), params_schema(type));
    out.keep_only(root / "nodes", ".json", schemas);
  }
  if (!folders.docs.empty()) {
    const fs::path root = folders.docs;
    for (const auto& [name, type] : registry) out.file(root / "nodes" / (name + ".md"), node_page(type));
    out.file(root / "nodes" / "index.md", node_index(registry));
    out.file(root / "coverage.md", coverage_page(registry));
    out.keep_only(root / "nodes", ".md", pages);
  }
  return std::move(out.changes);
}

}  // namespace frustum
