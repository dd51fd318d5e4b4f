// What ends a run. Thrown inside nodes and readers, caught once, at the boundary of a run.
#pragma once

#include <stdexcept>
#include <string>

namespace frustum {

// A node that cannot go on with the user's data: the run ends with this as a diagnostic at the node.
struct NodeError : std::runtime_error {
  std::string code;
  NodeError(std::string code_, const std::string& message) : std::runtime_error(message), code(std::move(code_)) {}
};

// The world failed (file, memory, engine): exit code 3.
struct WorldError : std::runtime_error {
  std::string code;
  WorldError(std::string code_, const std::string& message) : std::runtime_error(message), code(std::move(code_)) {}
};

// The user cancelled: exit code 130.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace frustum
