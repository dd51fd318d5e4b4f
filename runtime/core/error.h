// What ends a run. Thrown inside nodes and readers, caught once, at the boundary of a run.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace frustum {

// The part of a node that a NodeError is about, as a JSON pointer below the node: "/params/steps/2", "/in/mesh".
inline std::string at_param(std::string_view path) { return "/params/" + std::string(path); }
inline std::string at_input(std::string_view port) { return "/in/" + std::string(port); }

// A node that cannot go on with the user's data: the run ends with this as a diagnostic at the node, or at a part of it.
struct NodeError : std::runtime_error {
  std::string code, part;
  NodeError(std::string code_, const std::string& message, std::string part_ = {})
      : std::runtime_error(message), code(std::move(code_)), part(std::move(part_)) {}
};

// The world failed (file, memory, engine): exit code 3.
struct WorldError : std::runtime_error {
  std::string code;
  WorldError(std::string code_, const std::string& message)
      : std::runtime_error(message), code(std::move(code_)) {}
};

// The user cancelled: exit code 130.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace frustum
