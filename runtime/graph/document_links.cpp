#include "runtime/graph/document_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

bool takes_list(const DocumentNode& node, std::size_t input) {
  return node.type != nullptr ? node.type->inputs[input].list : node.graph->inputs[input].list;
}

}  // namespace

Link DocumentReader::read_link(const Json& j, const std::string& pointer, bool literals) {
  Link link{.pointer = pointer, .text = {}};
  const std::string expected =
      literals ? R"(a link, such as "node.port", or {"value": ...})" : R"(a link, such as "node.port")";
  if (j.is_string()) {
    link.text = j.get<std::string>();
    if (link.text.empty()) wrong_type(pointer, expected, j);
  } else if (j.is_object() && literals) {
    unknown_keys(j, pointer, {"value"}, "a literal input");
    if (const auto value = j.find("value"); value != j.end()) {
      link.literal = &*value;
      check_dollars(*value, child_pointer(pointer, "value"));
    } else {
      missing_key(pointer, "value", "a literal input");
    }
  } else {
    wrong_type(pointer, expected, j);
  }
  return link;
}

void DocumentReader::mark_used(const Json& links) {
  if (links.is_array())
    for (const Json& link : links) mark_used(link);
  if (links.is_string()) mark_used(links.get_ref<const std::string&>());
}

void DocumentReader::mark_used(const std::string& link) {
  also_used_.push_back(link.substr(0, link.find_first_of("./:")));
}

void DocumentReader::resolve_links() {
  for (DocumentNode& node : doc_->nodes)
    for (Binding& binding : node.inputs)
      for (Link& link : binding.links) resolve(link, takes_list(node, binding.input));
  for (DocumentOutput& output : doc_->outputs)
    for (DocumentLayer& layer : output.layers) resolve(layer.from, false);
  for (const std::string& id : also_used_)
    if (const auto node = doc_->node_index.find(id); node != doc_->node_index.end())
      doc_->nodes[node->second].used = true;
}

void DocumentReader::resolve(Link& link, bool list) {
  if (link.text.empty()) return;
  if (link.text.starts_with('$')) return resolve_input(link, list);
  const std::size_t dot = link.text.find('.');
  const std::string id = link.text.substr(0, dot);
  if (id.find_first_of("/:") != std::string::npos ||
      (dot != std::string::npos && link.text.find('.', dot + 1) != std::string::npos)) {
    const bool inside = id.find('/') != std::string::npos;
    mark_used(link.text);
    problem({.code = "bad_link",
             .pointer = link.pointer,
             .message = inside
                            ? fmt::format("'{}' reaches into a graph: links take what its \"outputs\" name",
                                          link.text)
                            : fmt::format("'{}' is not a link", link.text),
             .expected = "NODE.PORT, NODE or $INPUT",
             .got = link.text});
    return;
  }
  const auto found = doc_->node_index.find(id);
  if (found == doc_->node_index.end()) {
    const std::vector<std::string> near = documents_.suggestions(id, [&] {
      std::vector<std::string> ids;
      for (const DocumentNode& n : doc_->nodes) ids.push_back(n.id);
      return ids;
    });
    for (const std::string& n : near) mark_used(n);
    problem({.code = "unknown_node",
             .pointer = link.pointer,
             .message = fmt::format("there is no node '{}'", id),
             .expected = "a node of this graph",
             .got = id,
             .suggestions = near});
    return;
  }
  link.node = found->second;
  doc_->nodes[found->second].used = true;
  resolve_port(link, doc_->nodes[found->second],
               dot == std::string::npos ? std::string_view() : std::string_view(link.text).substr(dot + 1));
}

void DocumentReader::resolve_input(Link& link, bool list) {
  const std::string name = link.text.substr(1);
  for (std::size_t i = 0; i < doc_->inputs.size(); ++i) {
    if (doc_->inputs[i].name != name) continue;
    doc_->inputs[i].used = true;
    if (doc_->inputs[i].list && !list) return wrong_type(link.pointer, "one link, not a list", link.text);
    link.input = i;
    return;
  }
  std::vector<std::string> names;
  for (const DocumentInput& input : doc_->inputs) names.push_back("$" + input.name);
  const std::vector<std::string> near = documents_.suggestions(link.text, [&] { return names; });
  for (DocumentInput& input : doc_->inputs)
    input.used |= std::find(near.begin(), near.end(), "$" + input.name) != near.end();
  const bool param = doc_->find_param(name) != nullptr;
  problem({.code = "unknown_input",
           .pointer = link.pointer,
           .message = param ? fmt::format("'{}' is a parameter of the graph, not an input", name)
                            : fmt::format("the graph has no input '{}' for '{}'", name, link.text),
           .expected = names.empty() ? "a graph with inputs" : one_of(names),
           .got = link.text,
           .suggestions = near});
}

// Fills link.port, or takes link.node away again where there is no such port.
void DocumentReader::resolve_port(Link& link, const DocumentNode& node, std::string_view port) {
  struct Candidate {
    std::string name;
    std::size_t index;
  };
  std::vector<Candidate> ports;
  if (node.type != nullptr)
    for (std::size_t i = 0; i < node.type->outputs.size(); ++i)
      ports.push_back({node.type->outputs[i].name, i});
  if (node.graph != nullptr)
    for (std::size_t i = 0; i < node.graph->outputs.size(); ++i)
      if (!node.graph->outputs[i].layered) ports.push_back({node.graph->outputs[i].name, i});
  if (node.type == nullptr && node.graph == nullptr) {
    link.node.reset();  // of unknown ports nothing can be said
    return;
  }
  const auto found = port.empty() ? ports.begin()
                                  : std::find_if(ports.begin(), ports.end(),
                                                 [&](const Candidate& c) { return c.name == port; });
  if (found != ports.end()) {
    link.port = found->index;
    return;
  }
  link.node.reset();
  std::vector<std::string> names, suggestions;
  for (const Candidate& c : ports) names.push_back(c.name);
  for (const std::string& near : documents_.suggestions(port, [&] { return names; }))
    suggestions.push_back(fmt::format("{}.{}", node.id, near));
  problem({.code = "unknown_output",
           .pointer = link.pointer,
           .message = port.empty() ? fmt::format("{} has no output", kind_of(node))
                                   : fmt::format("{} has no output '{}'", kind_of(node), port),
           .expected = names.empty() ? "a node with outputs" : one_of(names),
           .got = std::string(port),
           .suggestions = suggestions,
           .related = {{.pointer = node.pointer, .message = fmt::format("'{}' stands here", node.id)}}});
}

}  // namespace frustum
