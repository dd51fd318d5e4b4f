// Laws that buffers obey whatever the scene: what an invariant check names.
#pragma once

#include "runtime/core/buffer.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace frustum {

struct InvariantType {
  std::string_view name, doc;  // "watertight", one sentence
  bool needs_other = false;    // about two buffers
  // How the law is broken, with numbers and the place, or nothing. `other` is null where none is needed.
  // Throws NodeError for a buffer of a kind that the law says nothing about.
  std::optional<std::string> (*broken)(const Buffer&, const Buffer* other, double tolerance) = nullptr;
};

std::span<const InvariantType> invariant_types();            // sorted by name
const InvariantType* find_invariant(std::string_view name);  // null where there is none

}  // namespace frustum
