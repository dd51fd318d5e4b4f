#include "runtime/graph/document_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

struct InputShape {
  std::string name;
  bool list, optional;
};

std::vector<InputShape> inputs_of(const DocumentNode& node) {
  std::vector<InputShape> out;
  if (node.type != nullptr)
    for (const Port& p : node.type->inputs) out.push_back({p.name, p.list, p.optional});
  if (node.graph != nullptr)
    for (const DocumentInput& i : node.graph->inputs) out.push_back({i.name, i.list, i.optional});
  return out;
}

std::vector<std::string> params_of(const DocumentNode& node) {
  std::vector<std::string> out;
  if (node.type != nullptr)
    for (const ParamField& f : node.type->params.fields) out.push_back(f.name);
  if (node.graph != nullptr)
    for (const WrittenParam& p : node.graph->params) out.push_back(p.name);
  return out;
}

}  // namespace

std::string one_of(std::span<const std::string> names) {
  constexpr std::size_t most = 100;  // a message costs no more than what can be read
  if (names.empty()) return "none";
  const std::string more = names.size() > most ? fmt::format(" and {} more", names.size() - most) : "";
  return fmt::format("one of: {}{}", fmt::join(names.first(std::min(most, names.size())), ", "), more);
}

std::string kind_of(const DocumentNode& node) {
  return node.type != nullptr ? fmt::format("'{}'", node.type->name)
                              : fmt::format("'{}'", node.graph->file());
}

void DocumentReader::read_nodes(const Json& file) {
  if (!file.contains("nodes")) return missing_key("", "nodes", "a graph");
  const Json* nodes = object_at(file, "nodes", "");
  if (nodes == nullptr) return;
  doc_->nodes.reserve(nodes->size());
  for (const auto& [id, j] : nodes->items()) {
    const std::string pointer = child_pointer("/nodes", id);
    if (!good_id(id, pointer, "a node")) continue;
    doc_->node_index.emplace(id, doc_->nodes.size());
    doc_->nodes.push_back({.id = id, .pointer = pointer});
    read_node(doc_->nodes.back(), j);
  }
}

void DocumentReader::read_node(DocumentNode& node, const Json& j) {
  if (!j.is_object()) return wrong_type(node.pointer, R"(an object, such as {"type": "..."})", j);
  read_node_type(node, j);
  if (j.contains("precision"))
    node.precision = read_precision(j["precision"], child_pointer(node.pointer, "precision"));
  read_node_params(node, j);
  read_overrides(node, j);
  read_bindings(node, j);
}

void DocumentReader::read_node_type(DocumentNode& node, const Json& j) {
  const Json* type = text_at(j, "type", node.pointer);
  if (!j.contains("type")) missing_key(node.pointer, "type", "a node");
  const std::string name = type != nullptr ? type->get<std::string>() : "";
  if (name == "graph") {
    unknown_keys(j, node.pointer, {"type", "file", "in", "params", "precision", "overrides"},
                 "a graph used as a node");
    const Json* file = text_at(j, "file", node.pointer);
    if (!j.contains("file")) missing_key(node.pointer, "file", "a graph used as a node");
    if (file != nullptr)
      node.graph = documents_.open(file->get<std::string>(), doc_->folder, *doc_->text,
                                   child_pointer(node.pointer, "file"));
    if (node.graph != nullptr) doc_->levels = std::max(doc_->levels, node.graph->levels + 1);
    return;
  }
  unknown_keys(j, node.pointer, {"type", "in", "params", "precision"}, "a node");
  node.type = documents_.registry().find(name);
  if (node.type != nullptr || type == nullptr) return;
  std::vector<std::string> names = documents_.registry().names();
  names.emplace_back("graph");
  problem({.code = "unknown_type",
           .pointer = child_pointer(node.pointer, "type"),
           .message = fmt::format("'{}' is not a node type", name),
           .expected = "a node type",
           .got = name,
           .suggestions = documents_.suggestions(name, [&] { return names; })});
}

void DocumentReader::read_node_params(DocumentNode& node, const Json& j) {
  const Json* params = object_at(j, "params", node.pointer);
  if (params == nullptr) return;
  const std::string pointer = child_pointer(node.pointer, "params");
  const bool known_type = node.type != nullptr || node.graph != nullptr;
  const std::vector<std::string> names = params_of(node);
  for (const auto& [name, value] : params->items()) {
    const std::string at = child_pointer(pointer, name);
    check_dollars(value, at);
    if (!known_type) continue;
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      node.params.push_back({name, at, &value});
      continue;
    }
    problem({.code = "unknown_param",
             .pointer = at,
             .message = fmt::format("{} has no parameter '{}'", kind_of(node), name),
             .expected = one_of(names),
             .got = name,
             .suggestions = documents_.suggestions(name, [&] { return names; })},
            true);
  }
}

void DocumentReader::read_overrides(DocumentNode& node, const Json& j) {
  if (!j.contains("overrides") || (node.type != nullptr)) return;
  const Json* overrides = object_at(j, "overrides", node.pointer);
  if (overrides == nullptr) return;
  const std::string pointer = child_pointer(node.pointer, "overrides");
  for (const auto& [address, value] : overrides->items()) {
    const std::string at = child_pointer(pointer, address);
    check_dollars(value, at);
    if (node.graph == nullptr) continue;
    if (address.find(':') != std::string::npos && has_param_address(*node.graph, address)) {
      node.overrides.push_back({address, at, &value});
      continue;
    }
    const bool own = node.graph->find_param(address) != nullptr;
    problem(
        {.code = "unknown_address",
         .pointer = at,
         .message = own ? fmt::format("'{}' is a parameter of {} itself and stands in \"params\"", address,
                                      kind_of(node))
                        : fmt::format("there is no parameter '{}' in {}", address, kind_of(node)),
         .expected = "NODE:PARAMETER",
         .got = address,
         .suggestions = own ? std::vector<std::string>{}
                            : documents_.suggestions(address, [&] { return param_addresses(*node.graph); })},
        true);
  }
}

void each_dollar(const Json& value, const std::string& pointer, const VisitDollar& visit) {
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      if (value[i].is_structured() || value[i].is_string())
        each_dollar(value[i], child_pointer(pointer, i), visit);
  } else if (value.is_object()) {
    for (const auto& [key, item] : value.items()) each_dollar(item, child_pointer(pointer, key), visit);
  } else if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    if (text.starts_with('$') && !text.starts_with("$$")) visit(text, pointer);
  }
}

// Every "$name" in a value must be a parameter of this graph.
void DocumentReader::check_dollars(const Json& value, const std::string& whole) {
  each_dollar(value, whole, [&](const std::string& text, const std::string& pointer) {
    const std::string name = text.substr(1);
    doc_->params_used.insert(name);
    if (doc_->find_param(name) != nullptr) return;
    const std::vector<std::string> near = documents_.suggestions(text, [&] { return dollar_params_; });
    for (const std::string& n : near) doc_->params_used.insert(n.substr(1));  // probably meant
    problem({.code = "unknown_parameter",
             .pointer = pointer,
             .message = fmt::format("the graph has no parameter '{}' for '{}'", name, text),
             .expected = one_of(dollar_params_),
             .got = text,
             .suggestions = near});
  });
}

void DocumentReader::read_bindings(DocumentNode& node, const Json& j) {
  const Json* in = object_at(j, "in", node.pointer);
  if (in != nullptr && node.type == nullptr && node.graph == nullptr)
    for (const auto& [name, value] : in->items()) mark_used(value);
  if (node.type == nullptr && node.graph == nullptr) return;
  const std::vector<InputShape> inputs = inputs_of(node);
  std::vector<std::string> names;
  for (const InputShape& i : inputs) names.push_back(i.name);
  const std::string pointer = child_pointer(node.pointer, "in");
  std::set<std::string> given;
  if (in != nullptr) {
    for (const auto& [name, value] : in->items()) {
      const std::string at = child_pointer(pointer, name);
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end()) {
        const std::vector<std::string> near = unknown_input(node, name, at, names);
        given.insert(near.begin(), near.end());  // probably meant
        mark_used(value);
        continue;
      }
      given.insert(name);
      const auto index = static_cast<std::size_t>(found - names.begin());
      read_binding(node, {.input = index, .pointer = at, .links = {}}, value, inputs[index].list);
    }
  }
  if (in == nullptr && j.contains("in")) return;
  for (const InputShape& input : inputs)
    if (!input.optional && !given.contains(input.name))
      problem({.code = "missing_input",
               .pointer = in != nullptr ? pointer : node.pointer,
               .message = fmt::format("the input '{}' of '{}' is fed by nothing", input.name, node.id),
               .expected = input.name});
}

// Its suggestions.
std::vector<std::string> DocumentReader::unknown_input(const DocumentNode& node, const std::string& name,
                                                       const std::string& at,
                                                       const std::vector<std::string>& names) {
  std::vector<std::string> near = documents_.suggestions(name, [&] { return names; });
  problem({.code = "unknown_input",
           .pointer = at,
           .message = fmt::format("{} has no input '{}'", kind_of(node), name),
           .expected = one_of(names),
           .got = name,
           .suggestions = near},
          true);
  return near;
}

void DocumentReader::read_binding(DocumentNode& node, Binding binding, const Json& j, bool list) {
  if (j.is_array() && !list) {
    mark_used(j);
    return wrong_type(binding.pointer, "one link, not a list", j);
  }
  if (j.is_array()) {
    for (std::size_t i = 0; i < j.size(); ++i)
      binding.links.push_back(read_link(j[i], child_pointer(binding.pointer, i), true));
  } else {
    binding.links.push_back(read_link(j, binding.pointer, true));
  }
  node.inputs.push_back(std::move(binding));
}

}  // namespace frustum
