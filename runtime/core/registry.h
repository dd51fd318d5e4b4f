// All node types by name.
#pragma once

#include "runtime/core/node_type.h"

#include <map>

namespace frustum {

class Registry {
 public:
  explicit Registry(std::vector<NodeType> types);
  const NodeType* find(std::string_view name) const;  // null where there is none
  std::vector<std::string> names() const;             // sorted
  auto begin() const { return types_.begin(); }
  auto end() const { return types_.end(); }

 private:
  std::map<std::string, NodeType, std::less<>> types_;
};

}  // namespace frustum
