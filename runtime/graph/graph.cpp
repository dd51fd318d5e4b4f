#include "runtime/graph/graph.h"

#include <algorithm>

namespace frustum {

SourcePlace GraphNode::place_of(std::string_view part) const {
  for (const auto& [name, at] : parts) {
    if (!part.starts_with(name) || (part.size() > name.size() && part[name.size()] != '/')) continue;
    SourcePlace found = at;
    found.pointer += part.substr(name.size());
    return found;
  }
  return place;
}

std::optional<PortRef> Graph::find_port(std::string_view address) const {
  const auto named =
      std::find_if(port_names.begin(), port_names.end(), [&](const auto& n) { return n.name == address; });
  if (named != port_names.end()) return named->port;
  // Ids hold no dot, so the first one ends the id.
  const std::size_t dot = address.find('.');
  const std::string_view id = address.substr(0, dot);
  const auto node = std::find_if(nodes.begin(), nodes.end(), [&](const GraphNode& n) { return n.id == id; });
  if (node == nodes.end() || node->type->outputs.empty()) return std::nullopt;
  const auto index = static_cast<std::size_t>(node - nodes.begin());
  if (dot == std::string_view::npos) return PortRef{index, 0};
  const auto port = node->type->find_output(address.substr(dot + 1));
  return port ? std::optional(PortRef{index, *port}) : std::nullopt;
}

const GraphOutput* Graph::find_output(std::string_view name) const {
  const auto found =
      std::find_if(outputs.begin(), outputs.end(), [&](const GraphOutput& o) { return o.name == name; });
  return found != outputs.end() ? &*found : nullptr;
}

std::vector<std::string> Graph::addresses() const {
  std::vector<std::string> all;
  for (const GraphOutput& o : outputs) all.push_back(o.name);
  for (const PortName& n : port_names) all.push_back(n.name);
  for (const GraphNode& n : nodes) {
    all.push_back(n.id);
    for (const Port& p : n.type->outputs) all.push_back(n.id + "." + p.name);
  }
  return all;
}

}  // namespace frustum
