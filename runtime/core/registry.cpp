#include "runtime/core/registry.h"

#include <stdexcept>

namespace frustum {

Registry::Registry(std::vector<NodeType> types) {
  for (NodeType& t : types) {
    std::string name = t.name;
    if (!types_.emplace(name, std::move(t)).second)
      throw std::logic_error("two node types are named " + name);
  }
}

const NodeType* Registry::find(std::string_view name) const {
  const auto found = types_.find(name);
  return found != types_.end() ? &found->second : nullptr;
}

std::vector<std::string> Registry::names() const {
  std::vector<std::string> out;
  for (const auto& [name, type] : types_) out.push_back(name);
  return out;
}

}  // namespace frustum
