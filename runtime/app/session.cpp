#include "runtime/app/session.h"

#include "nodes/all_nodes.h"
#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/core/error.h"
#include "runtime/core/missing_file.h"
#include "runtime/io/buffer_files.h"
#include "runtime/io/color.h"
#include "runtime/io/image_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <unordered_set>

namespace frustum {
namespace {

void report_unknown(const Graph& graph, std::string_view address, Diagnostics& problems) {
  std::vector<std::string> known = graph.addresses();
  // Where the node is right its ports are what is meant, however far their names are.
  const auto node = std::find_if(graph.nodes.begin(), graph.nodes.end(), [&](const GraphNode& n) {
    return address.size() > n.id.size() && address.starts_with(n.id) && address[n.id.size()] == '.';
  });
  if (node != graph.nodes.end()) {
    const std::string_view port = address.substr(node->id.size() + 1);
    std::vector<std::string> ports;
    for (const Port& p : node->type->outputs) ports.push_back(fmt::format("{}.{}", node->id, p.name));
    std::vector<std::string> near = nearest_names(address, ports);
    problems.add({.code = "unknown_address",
                  .pointer = node->place.pointer,
                  .message = fmt::format("'{}' ({}) has no output '{}'", node->id, node->type->name, port),
                  .expected = fmt::format("one of: {}", fmt::join(ports, ", ")),
                  .got = std::string(address),
                  .suggestions = near.empty() ? std::move(ports) : std::move(near),
                  .file = node->place.file,
                  .line = node->place.line,
                  .column = node->place.column});
    return;
  }
  problems.add({.code = "unknown_address",
                .pointer = "",
                .message = fmt::format("'{}' is neither an output nor a port of this graph", address),
                .expected = "an output's name, or NODE.PORT",
                .got = std::string(address),
                .suggestions = nearest_names(address, known),
                .file = graph.file});
}

}  // namespace

// Other names are of ports of graphs used as nodes: they have a dot, or are the id that the nodes inside
// begin with.
std::vector<PortRef> named_ports(const Graph& graph) {
  std::unordered_set<std::string> graphs;
  for (const GraphNode& node : graph.nodes)
    if (const auto slash = node.id.find('/'); slash != std::string::npos)
      graphs.insert(node.id.substr(0, slash));
  std::vector<PortRef> ports;
  for (const PortName& n : graph.port_names)
    if (n.name.find_first_of("./") == std::string::npos && !graphs.contains(n.name)) ports.push_back(n.port);
  return ports;
}

Session::Session() : Session(Registry(all_node_types())) {}
Session::Session(Registry registry) : registry_(std::move(registry)) {}

Loaded Session::load(const std::string& path, LoadOptions options) const {
  if (options.library_folders.empty()) options.library_folders = library_folders(path);
  if (!options.to_linear) options.to_linear = to_linear_rec709;
  if (!options.saved_as) options.saved_as = saved_as;
  options.look_for_files = true;
  try {
    return load_graph(path, registry_, options);
  } catch (const WorldError& e) {
    if (why_missing(path, path).empty()) throw;
    const auto near = near_files(path, path);
    if (near.empty()) throw;
    throw WorldError(e.code, fmt::format("{}; did you mean '{}'?", e.what(), near.front()));
  }
}

void Session::use_disk(const std::string& folder, std::uint64_t limit_bytes, bool check) {
  disk_.emplace(folder, limit_bytes);
  check_ = check;
}

RunResult Session::run(const Graph& graph, RunOptions options, bool keep) {
  if (!options.make_sink) options.make_sink = open_image_sink;
  if (!options.save_buffer)
    options.save_buffer = [cancel = options.cancel](const Buffer& buffer, const SaveRequest& request) {
      Context ctx;
      ctx.cancel = cancel, ctx.admit = request.admit;
      save_buffer_file(buffer, request, ctx);
    };
  options.cache = keep && !check_ ? &cache_ : nullptr;
  options.disk = keep && disk_ ? &*disk_ : nullptr;
  options.check_cache = check_;
  return run_graph(graph, options);
}

std::vector<PortRef> end_ports(const Graph& graph) {
  std::vector<bool> feeds(graph.nodes.size(), false);
  for (const GraphNode& node : graph.nodes)
    for (const auto& list : node.inputs)
      for (const Source& source : list)
        if (const auto* from = std::get_if<PortRef>(&source)) feeds[from->node] = true;
  std::vector<PortRef> ends;
  for (std::size_t n = 0; n < graph.nodes.size(); ++n)
    for (std::size_t p = 0; !feeds[n] && p < graph.nodes[n].type->outputs.size(); ++p) ends.push_back({n, p});
  return ends;
}

Demand demand_of(const Graph& graph, std::span<const std::string> wanted, Diagnostics& problems) {
  Demand demand;
  const auto add_output = [&](std::size_t i) {
    if (std::find(demand.outputs.begin(), demand.outputs.end(), i) == demand.outputs.end())
      demand.outputs.push_back(i);
  };
  for (const std::string& name : wanted) {
    if (const GraphOutput* output = graph.find_output(name))
      add_output(static_cast<std::size_t>(output - graph.outputs.data()));
    else if (const auto port = graph.find_port(name))
      demand.ports.push_back(*port);
    else
      report_unknown(graph, name, problems);
  }
  if (!wanted.empty()) return demand;
  for (std::size_t i = 0; i < graph.outputs.size(); ++i) add_output(i);
  demand.ports = named_ports(graph);
  if (demand.ports.empty() && graph.outputs.empty()) demand.ports = end_ports(graph);
  return demand;
}

std::optional<PortRef> port_of(const Graph& graph, std::string_view address, Diagnostics& problems) {
  if (const auto port = graph.find_port(address)) return port;
  if (const GraphOutput* output = graph.find_output(address)) {
    for (const OutputLayer& layer : output->layers)
      if (layer.name.empty()) return layer.from;
    if (!output->layers.empty()) return output->layers.front().from;
  }
  report_unknown(graph, address, problems);
  return std::nullopt;
}

Diagnostic at_port(const Graph& graph, PortRef port, std::string code, std::string message) {
  const SourcePlace& place = graph.nodes[port.node].place;
  return {.code = std::move(code),
          .pointer = place.pointer,
          .message = std::move(message),
          .file = place.file,
          .line = place.line,
          .column = place.column};
}

std::vector<std::string> near_ports(const Graph& graph, PortRef port, bool (*is_meant)(const BufferType&)) {
  const auto may_carry = [&](const Port& p) {
    return std::any_of(p.types.begin(), p.types.end(), [&](const BufferType* t) { return is_meant(*t); });
  };
  std::map<std::string, std::string> ports;  // of each node the first that may
  std::vector<std::string> ids;
  for (const GraphNode& node : graph.nodes) {
    const auto& outputs = node.type->outputs;
    const auto found = std::find_if(outputs.begin(), outputs.end(), may_carry);
    if (found == outputs.end()) continue;
    ids.push_back(node.id);
    ports[node.id] = fmt::format("{}.{}", node.id, found->name);
  }
  std::vector<std::string> near = nearest_names(graph.nodes[port.node].id, ids);
  for (std::string& n : near) n = ports.at(n);
  return near;
}

}  // namespace frustum
