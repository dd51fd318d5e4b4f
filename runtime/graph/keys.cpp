#include "runtime/graph/keys.h"

#include "runtime/core/error.h"
#include "runtime/core/read_file.h"
#include "runtime/core/version.h"

#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <fstream>
#include <vector>

namespace frustum {
namespace {

// A file that cannot be read hashes as such; the node that opens it says what is wrong.
void hash_file(const std::string& path, Hasher& h) {
  std::uint64_t size = 0;
  try {
    const RegularFile file(path, path);
    h.value(true);
    std::vector<char> block(1 << 20);
    for (ssize_t n = 1; n > 0;) {
      n = ::read(file.descriptor(), block.data(), block.size());
      if (n < 0 && errno == EINTR)
        n = 1;
      else if (n > 0)
        h.bytes(block.data(), static_cast<std::size_t>(n)), size += static_cast<std::uint64_t>(n);
    }
  } catch (const WorldError&) {
    h.value(false);
  }
  h.value(size);
}

// The processor's model and abilities as the system states them. Libraries choose their code by these, so a node that calls
// one for its numbers promises the same bytes on one kind of processor only.
Digest processor() {
  static const Digest digest = [] {
    std::ifstream info("/proc/cpuinfo");
    Hasher h;
    int found = 0;
    for (std::string line; found < 2 && std::getline(info, line);)
      if (line.starts_with("model name") || line.starts_with("flags") || line.starts_with("Features"))
        h.text(line), ++found;
    return h.done();
  }();
  return digest;
}

// Those of a type's effects of which something is asked; nothing where nothing is.
void hash_effects(const NodeType& type, const EffectPolicy& policy, Hasher& h) {
  for (const EffectDoc& e : type.effects)
    if (policy.forces(e.name) || policy.skips(e.name)) h.text(e.name).value(policy.forces(e.name));
}

NodeKey node_key(const Graph& graph, const GraphNode& node, const std::vector<NodeKey>& keys,
                 bool this_machine, const EffectPolicy& effects) {
  const NodeType& type = *node.type;
  NodeKey k;
  k.type = Hasher().text(type.name).value(type.version).done();
  Hasher how;
  how.value(node.precision).value(graph.seed).value(type.foreign && this_machine ? processor() : Digest{});
  hash_effects(type, effects, how);
  k.how = how.done();
  Hasher files;
  if (this_machine && type.params.files)
    type.params.files(node.params.get(), [&](const FilePath& f) { hash_file(f.resolved, files); });
  k.files = files.done();
  const Json params = write_record(type.params, node.params.get());
  for (const auto& [name, value] : params.items())
    k.params.emplace_back(name, Hasher().text(value.dump()).done());
  for (std::size_t i = 0; i < node.inputs.size(); ++i) {
    Hasher h;
    h.value(node.inputs[i].size());
    for (const Source& s : node.inputs[i]) {
      if (const auto* from = std::get_if<PortRef>(&s))
        h.value(output_key(keys[from->node].key, from->port));
      else
        h.value(std::get<Buffer>(s).digest());
    }
    k.inputs.emplace_back(type.inputs[i].name, h.done());
  }
  Hasher h;
  h.value(k.type).value(k.how).value(k.files);
  for (const auto* list : {&k.params, &k.inputs}) {
    h.value(list->size());
    for (const auto& [name, digest] : *list) h.text(name).value(digest);
  }
  k.key = h.done();
  return k;
}

// Without `this_machine`, the content of files and the processor are left out.
std::vector<NodeKey> explained_keys(const Graph& graph, bool this_machine, const EffectPolicy& effects) {
  std::vector<NodeKey> keys;
  keys.reserve(graph.nodes.size());
  for (const GraphNode& n : graph.nodes) keys.push_back(node_key(graph, n, keys, this_machine, effects));
  return keys;
}

}  // namespace

std::vector<NodeKey> explained_keys(const Graph& graph, const EffectPolicy& effects) {
  return explained_keys(graph, true, effects);
}

std::vector<Digest> node_keys(const Graph& graph, const EffectPolicy& effects) {
  std::vector<Digest> keys;
  for (NodeKey& k : explained_keys(graph, effects)) keys.push_back(k.key);
  return keys;
}

Digest graph_digest(const Graph& graph) {
  Hasher h;
  for (const NodeKey& k : explained_keys(graph, false, {})) h.value(k.key);
  return h.done();
}

Digest output_key(const Digest& node, std::size_t port) { return Hasher().value(node).value(port).done(); }

Digest disk_key(const Digest& key) { return Hasher().text("disk").text(build_id()).value(key).done(); }

}  // namespace frustum
