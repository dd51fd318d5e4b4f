#include "runtime/graph/keys.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <vector>

namespace frustum {
namespace {

// A file that cannot be read hashes as such; the node that opens it says what is wrong.
void hash_file(const std::string& path, Hasher& h) {
  std::ifstream file(path, std::ios::binary);
  h.value(static_cast<bool>(file));
  std::vector<char> block(1 << 20);
  std::uint64_t size = 0;
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    h.bytes(block.data(), static_cast<std::size_t>(file.gcount()));
    size += static_cast<std::uint64_t>(file.gcount());
  }
  h.value(size);
}

Digest node_key(const Graph& graph, const GraphNode& node, const std::vector<Digest>& keys, bool files) {
  const NodeType& type = *node.type;
  Hasher h;
  h.text(type.name).value(type.version).value(node.precision).value(graph.seed);
  h.text(write_record(type.params, node.params.get()).dump());
  if (files && type.params.files) type.params.files(node.params.get(), [&](const FilePath& f) { hash_file(f.resolved, h); });
  for (const auto& sources : node.inputs) {
    h.value(sources.size());
    for (const Source& s : sources) {
      if (const auto* from = std::get_if<PortRef>(&s)) h.value(output_key(keys[from->node], from->port));
      else h.value(std::get<Buffer>(s).digest());
    }
  }
  return h.done();
}

std::vector<Digest> node_keys(const Graph& graph, bool files) {
  std::vector<Digest> keys;
  keys.reserve(graph.nodes.size());
  for (const GraphNode& n : graph.nodes) keys.push_back(node_key(graph, n, keys, files));
  return keys;
}

}  // namespace

std::vector<Digest> node_keys(const Graph& graph) { return node_keys(graph, true); }

Digest graph_digest(const Graph& graph) {
  Hasher h;
  for (const Digest& key : node_keys(graph, false)) h.value(key);
  return h.done();
}

Digest output_key(const Digest& node, std::size_t port) { return Hasher().value(node).value(port).done(); }

}  // namespace frustum
