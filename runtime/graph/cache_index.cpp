#include "runtime/graph/cache_index.h"

#include "runtime/core/version.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace frustum {
namespace {

constexpr std::string_view format_name = "frustum.cache_index/1";

using Texts = std::map<std::string, std::string>;

Texts texts_of(const std::vector<std::pair<std::string, Digest>>& digests) {
  Texts texts;
  for (const auto& [name, digest] : digests) texts[name] = to_hex(digest);
  return texts;
}

// Names whose text differs, or that only one of both has.
std::vector<std::string> differing(const Texts& a, const Texts& b) {
  std::vector<std::string> names;
  for (const auto& [name, text] : a)
    if (const auto other = b.find(name); other == b.end() || other->second != text) names.push_back(name);
  for (const auto& [name, text] : b)
    if (!a.contains(name)) names.push_back(name);
  return names;
}

}  // namespace

CacheIndex::CacheIndex(DiskCache& disk, const Graph& graph) : disk_(disk) {
  if (graph.file.empty()) return;
  std::error_code error;
  graph_ = std::filesystem::weakly_canonical(graph.file, error).string();
  if (error) graph_ = graph.file;
  if (const auto text = disk_.load_index(graph_)) read(*text);
}

// A file that says anything else than this program writes explains nothing.
void CacheIndex::read(const std::string& text) {
  const Json j = Json::parse(text, nullptr, false);
  try {
    if (j.at("format") != format_name) return;
    for (const auto& [id, n] : j.at("nodes").items()) {
      const auto get = [&n = n](const char* name) { return n.at(name).get<std::string>(); };
      nodes_[id] = {get("build"),
                    get("key"),
                    get("type"),
                    get("how"),
                    get("files"),
                    get("kept"),
                    n.at("params").get<Texts>(),
                    n.at("inputs").get<Texts>()};
    }
  } catch (const Json::exception&) {
    nodes_.clear();
  }
}

CacheIndex::Reason CacheIndex::why_missing(const std::string& node, const NodeKey& key) const {
  const auto found = nodes_.find(node);
  if (found == nodes_.end()) return {"never_seen", {}};
  const Entry& last = found->second;
  if (last.build != build_id()) return {"build_changed", {}};
  if (last.type != to_hex(key.type)) return {"type_changed", {}};
  if (last.how != to_hex(key.how)) return {"settings_changed", "precision, seed or processor"};
  if (const auto names = differing(texts_of(key.params), last.params); !names.empty())
    return {"params_changed", fmt::format("{}", fmt::join(names, ", "))};
  if (last.files != to_hex(key.files)) return {"file_changed", {}};
  if (const auto names = differing(texts_of(key.inputs), last.inputs); !names.empty())
    return {"input_changed", fmt::format("{}", fmt::join(names, ", "))};
  if (last.kept == "stored" || last.kept == "there_already") return {"removed", "evicted, or found damaged"};
  return {"not_stored_before", last.kept};
}

void CacheIndex::note(const std::string& node, const NodeKey& key, std::string_view kept) {
  nodes_[node] = {std::string(build_id()), to_hex(key.key),   to_hex(key.type),     to_hex(key.how),
                  to_hex(key.files),       std::string(kept), texts_of(key.params), texts_of(key.inputs)};
}

void CacheIndex::save() {
  if (graph_.empty()) return;
  Json nodes = Json::object();
  for (const auto& [id, e] : nodes_)
    nodes[id] = {{"build", e.build}, {"key", e.key},   {"type", e.type},     {"how", e.how},
                 {"files", e.files}, {"kept", e.kept}, {"params", e.params}, {"inputs", e.inputs}};
  disk_.store_index(graph_,
                    Json{{"format", format_name}, {"graph", graph_}, {"nodes", std::move(nodes)}}.dump(
                        -1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace frustum
