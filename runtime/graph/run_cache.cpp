#include "runtime/graph/run_cache.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

double ms(std::chrono::nanoseconds t) { return std::chrono::duration<double, std::milli>(t).count(); }

// Estimates on the careful side, for files in the page cache: reading, hashing and copying at 1 GB/s.
double load_ms(std::uint64_t bytes) { return 0.2 + static_cast<double>(bytes) * 1e-6; }

bool pays(double cost_ms, std::uint64_t bytes) { return cost_ms >= 1 && cost_ms >= 2 * load_ms(bytes); }

// A picture that is written band by band is held whole for the cache up to this size.
constexpr std::uint64_t most_whole_bytes = std::uint64_t{256} << 20;

Digest notes_key(const NodeKey& k) { return Hasher().text("notes").value(k.key).done(); }

Digest prepared_key(const NodeKey& k, std::uint64_t wanted_outputs) {
  return Hasher().text("prepared").value(k.key).value(wanted_outputs).done();
}

Json to_json(const NodeNotes& n) {
  Json j = {{"warnings", n.warnings}};
  if (n.culprit)
    j["culprit"] = {{"port", n.culprit->port},
                    {"where", n.culprit->where},
                    {"inputs", n.culprit->inputs},
                    {"values", n.culprit->health.values},
                    {"nan", n.culprit->health.nan},
                    {"positive_infinity", n.culprit->health.positive_infinity},
                    {"negative_infinity", n.culprit->health.negative_infinity}};
  return j;
}

NodeNotes notes_of(const std::string& text, const std::string& node) {
  NodeNotes n;
  try {
    const Json j = Json::parse(text);
    n.warnings = j.at("warnings").get<decltype(n.warnings)>();
    if (const auto c = j.find("culprit"); c != j.end())
      n.culprit = {node,
                   c->at("port"),
                   c->at("where"),
                   c->at("inputs"),
                   {.values = c->at("values"),
                    .nan = c->at("nan"),
                    .positive_infinity = c->at("positive_infinity"),
                    .negative_infinity = c->at("negative_infinity"),
                    .first = c->at("where")}};
  } catch (const Json::exception&) {
    return {};
  }
  return n;
}

}  // namespace

RunCache::RunCache(const Graph& graph, const RunOptions& options)
    : graph_(graph), options_(options), disk_(options.disk) {
  if (!any()) return;
  keys_ = explained_keys(graph, options.effects);
  if (disk_ != nullptr) index_.emplace(*disk_, graph);
  cost_ms_.resize(graph.nodes.size());
  caching_.resize(graph.nodes.size());
  looked_at_.resize(graph.nodes.size());
  notes_.resize(graph.nodes.size());
}

// ----- before the run

// With a region, a demanded port is asked for in part; the caches hold only whole ones.
bool RunCache::usable(PortRef p) const {
  if (!options_.region || !graph_.nodes[p.node].type->is_pixel()) return true;
  const auto& ports = options_.demand.ports;
  return std::find(ports.begin(), ports.end(), p) == ports.end();
}

void RunCache::look_up(const std::function<bool(PortRef, const Buffer&)>& publish) {
  if (!any()) return;
  // Feeders stand before their consumers: from the end, every port is asked for before its turn comes.
  std::vector<std::vector<PortRef>> asked(graph_.nodes.size());
  const auto ask = [&](PortRef p) {
    auto& ports = asked[p.node];
    if (std::find(ports.begin(), ports.end(), p) == ports.end()) ports.push_back(p);
  };
  for (const PortRef p : options_.demand.ports) ask(p);
  for (const std::size_t o : options_.demand.outputs)
    for (const OutputLayer& layer : graph_.outputs[o].layers) ask(layer.from);
  std::vector<bool> behind(graph_.nodes.size(), false);
  for (std::size_t n = graph_.nodes.size(); n-- > 0;) {
    if (asked[n].empty() && !behind[n]) continue;
    NodeCaching& c = caching_[n];
    c.node = graph_.nodes[n].id;
    looked_at_[n] = 1;
    bool found = true;
    for (const PortRef p : asked[n]) {
      const Buffer b = find(p, c);
      found &= b && publish(p, b);
    }
    c.verdict = !found ? CacheVerdict::miss : asked[n].empty() ? CacheVerdict::not_needed : CacheVerdict::hit;
    if (!found) explain(n, c);
    for (const auto& sources : graph_.nodes[n].inputs)
      for (const Source& s : sources)
        if (const auto* from = std::get_if<PortRef>(&s)) {
          if (found)
            behind[from->node] = true;
          else
            ask(*from);
        }
  }
}

Buffer RunCache::find(PortRef p, NodeCaching& said) {
  const Digest key = output_key(keys_[p.node].key, p.port);
  if (!usable(p)) return {};
  if (options_.cache != nullptr)
    if (const auto found = options_.cache->find(key); found && !found->buffers.empty()) {
      said.from = "memory";
      return found->buffers.front();
    }
  if (disk_ == nullptr || options_.check_cache) return {};
  const auto start = std::chrono::steady_clock::now();
  Buffer b = disk_->load(disk_key(key), graph_.port(p).types);
  if (!b) return {};
  cost_ms_[p.node] = ms(std::chrono::steady_clock::now() - start);
  said.from = "disk";
  said.bytes += b.bytes();
  if (options_.cache != nullptr) options_.cache->insert(key, {{b}, nullptr});
  return b;
}

void RunCache::explain(std::size_t node, NodeCaching& said) const {
  said.from.clear();
  said.kept = "not_whole";  // until a complete buffer of it is seen
  if (!index_ || options_.check_cache) return;
  const CacheIndex::Reason reason = index_->why_missing(said.node, keys_[node]);
  said.why = reason.code;
  said.detail = reason.detail;
}

// ----- prepared pixel nodes

std::shared_ptr<const void> RunCache::find_prepared(std::size_t node, std::uint64_t wanted) const {
  if (options_.cache == nullptr) return nullptr;
  const auto found = options_.cache->find(prepared_key(keys_[node], wanted));
  return found ? found->prepared : nullptr;
}

void RunCache::keep_prepared(std::size_t node, std::uint64_t wanted, std::shared_ptr<const void> prepared,
                             std::uint64_t bytes) const {
  if (options_.cache != nullptr)
    options_.cache->insert(prepared_key(keys_[node], wanted), {{}, std::move(prepared), bytes});
}

// ----- while running

void RunCache::ran(std::size_t node, std::chrono::nanoseconds time) {
  if (!any()) return;
  const std::lock_guard lock(mutex_);
  double inputs = 0;
  for (const auto& sources : graph_.nodes[node].inputs)
    for (const Source& s : sources)
      if (const auto* from = std::get_if<PortRef>(&s)) inputs = std::max(inputs, cost_ms_[from->node]);
  cost_ms_[node] = ms(time) + inputs;
  if (!graph_.nodes[node].type->is_pixel()) flush_notes(node);
}

void RunCache::ran_pass(const std::vector<std::size_t>& nodes, std::chrono::nanoseconds time) {
  if (!any()) return;
  const std::lock_guard lock(mutex_);
  double prepared = 0;
  for (const std::size_t n : nodes) prepared = std::max(prepared, cost_ms_[n]);
  for (const std::size_t n : nodes) cost_ms_[n] = prepared + ms(time), flush_notes(n);
}

void RunCache::said(std::size_t node, const std::string& code, const std::string& message) {
  if (!any()) return;
  const std::lock_guard lock(mutex_);
  notes_[node].warnings.emplace_back(code, message);
}

void RunCache::said(std::size_t node, const Culprit& culprit) {
  if (!any() || options_.region) return;
  const std::lock_guard lock(mutex_);
  notes_[node].culprit = culprit;
}

// Before the buffers, so that whoever finds those finds the notes as well.
void RunCache::flush_notes(std::size_t node) {
  const NodeNotes& n = notes_[node];
  if (options_.check_cache || (n.warnings.empty() && !n.culprit)) return;
  if (options_.cache != nullptr)
    options_.cache->insert(notes_key(keys_[node]), {{}, std::make_shared<const NodeNotes>(n)});
  if (disk_ != nullptr)
    disk_->store_notes(disk_key(notes_key(keys_[node])),
                       to_json(n).dump(-1, ' ', false, Json::error_handler_t::replace));
}

NodeNotes RunCache::notes(std::size_t node) const {
  if (!any()) return {};
  const Digest key = notes_key(keys_[node]);
  if (options_.cache != nullptr)
    if (const auto found = options_.cache->find(key))
      return *std::static_pointer_cast<const NodeNotes>(found->prepared);
  if (disk_ != nullptr && !options_.check_cache)
    if (const auto text = disk_->load_notes(disk_key(key))) return notes_of(*text, graph_.nodes[node].id);
  return {};
}

void RunCache::keep(PortRef p, const Buffer& b) {
  if (!any() || !b) return;
  const Digest key = output_key(keys_[p.node].key, p.port);
  std::string_view kept = "memory";
  if (disk_ != nullptr) kept = options_.check_cache ? compare(p, b, key) : store(p, b, key);
  if (options_.cache != nullptr && !options_.check_cache) options_.cache->insert(key, {{b}, nullptr});
  const std::lock_guard lock(mutex_);
  NodeCaching& c = caching_[p.node];
  c.bytes += b.bytes();
  if (c.kept != "stored" && c.kept != "differs") c.kept = kept;
}

std::string_view RunCache::store(PortRef p, const Buffer& b, const Digest& key) {
  if (b.type().save == nullptr) return name_of(DiskCache::Store::not_storable);
  if (!pays(cost_ms(p.node), b.bytes())) return "cheap";
  const DiskCache::Store done = disk_->store(disk_key(key), b);
  const std::lock_guard lock(mutex_);
  if (done == DiskCache::Store::stored || done == DiskCache::Store::there_already)
    cost_ms_[p.node] = std::min(cost_ms_[p.node], load_ms(b.bytes()));
  return name_of(done);
}

double RunCache::cost_ms(std::size_t node) {
  const std::lock_guard lock(mutex_);
  return cost_ms_[node];
}

std::string_view RunCache::compare(PortRef p, const Buffer& b, const Digest& key) {
  const Buffer kept = disk_->load(disk_key(key), graph_.port(p).types);
  if (!kept) return "not_there";
  if (kept.digest() == b.digest()) return "same";
  differs_ = true;
  disk_->remove(disk_key(key));
  const SourcePlace& place = graph_.nodes[p.node].place;
  const std::lock_guard lock(mutex_);
  problems_.add({.code = "cache_differs",
                 .pointer = place.pointer,
                 .message = fmt::format(
                     "{}: the cache held other bytes (digest {}) than the node makes now (digest {}); its "
                     "file is removed",
                     graph_.name(p), to_hex(kept.digest()), to_hex(b.digest())),
                 .file = place.file,
                 .line = place.line,
                 .column = place.column});
  return "differs";
}

bool RunCache::wants_whole(PortRef p, std::uint64_t bytes) const {
  if (disk_ == nullptr || options_.region || bytes > most_whole_bytes) return false;
  if (options_.memory != 0 && bytes > options_.memory / 4) return false;
  const bool there = disk_->contains(disk_key(output_key(keys_[p.node].key, p.port)));
  return options_.check_cache == there;
}

// ----- the end

std::vector<NodeCaching> RunCache::finish(bool completed) {
  std::vector<NodeCaching> list;
  for (std::size_t n = 0; n < caching_.size(); ++n) {
    NodeCaching& c = caching_[n];
    if (looked_at_[n] == 0) continue;
    if (options_.check_cache && (c.kept == "same" || c.kept == "differs"))
      c.verdict = CacheVerdict::hit, c.from = "disk";
    if (c.verdict != CacheVerdict::miss && !options_.check_cache) c.kept.clear();
    if (index_ && completed && !options_.check_cache && (c.verdict == CacheVerdict::miss || c.from == "disk"))
      index_->note(c.node, keys_[n], c.verdict == CacheVerdict::hit ? "stored" : c.kept);
    list.push_back(c);
  }
  if (index_ && completed && !options_.check_cache) index_->save();
  return list;
}

Diagnostics RunCache::take_problems() {
  if (disk_ != nullptr)
    for (auto& [code, message] : disk_->take_warnings())
      problems_.add({.code = code, .severity = Severity::warning, .pointer = "", .message = message});
  return std::move(problems_);
}

}  // namespace frustum
