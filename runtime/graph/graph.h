// A graph that passed its checks: flattened, typed, in an order in which it can run.
#pragma once

#include "runtime/core/registry.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace frustum {

// One output of one node of a Graph.
struct PortRef {
  std::size_t node = 0, port = 0;
  auto operator<=>(const PortRef&) const = default;
};

// What feeds an input: another node's port, or a literal.
using Source = std::variant<PortRef, Buffer>;

// Where something was written.
struct SourcePlace {
  std::string file;     // as the user would name it
  std::string pointer;  // RFC 6901
  int line = 0, column = 0;
  std::string setting = {};  // "samples=4" where the value comes from --set samples=4
};

struct GraphNode {
  std::string id;  // "cut", or "draw/lit" inside the graph-as-node "draw"
  const NodeType* type = nullptr;
  std::shared_ptr<const void> params;       // the type's Params, with every override resolved
  std::vector<std::vector<Source>> inputs;  // one list an input of the type; empty where left out
  Precision precision = Precision::single;
  SourcePlace place;
  std::vector<std::pair<std::string, SourcePlace>>
      parts;  // of written parameters and inputs: "/params/far", "/in/mesh"

  // Where a part of the node stands, or what holds it, or the node: NodeError::part.
  SourcePlace place_of(std::string_view part) const;
};

struct OutputLayer {
  std::string name;  // "" is the main layer
  PortRef from;
};

// One file that a run writes.
struct GraphOutput {
  std::string name;
  std::string file;         // relative to the output folder; may hold {frame}
  bool whole = false;       // the file holds the whole buffer of its one layer and is no picture
  int bits = 0;             // 0: the format's usual depth
  std::string compression;  // empty: the format's usual one
  std::vector<OutputLayer> layers;
  SourcePlace place;
};

// A name for a port besides "node.port": an output without a file, a port of a graph used as a node ("draw.image").
struct PortName {
  std::string name;
  PortRef port;
};

struct Graph {
  std::string title;
  std::string file;  // empty for a graph that was not read from a file
  std::uint64_t seed = 0;
  std::vector<GraphNode> nodes;      // every node stands after those that feed it
  std::vector<GraphOutput> outputs;  // in the order of the file
  std::vector<PortName> port_names;

  const Port& port(PortRef p) const { return nodes[p.node].type->outputs[p.port]; }
  std::string name(PortRef p) const { return nodes[p.node].id + "." + port(p).name; }

  // "node.port", "node" (its first declared output), "draw/lit.color" or one of port_names; null where there is none.
  std::optional<PortRef> find_port(std::string_view address) const;
  const GraphOutput* find_output(std::string_view name) const;
  // Every address that find_port and find_output know, for suggestions.
  std::vector<std::string> addresses() const;
};

}  // namespace frustum
