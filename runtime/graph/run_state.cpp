#include "runtime/graph/run_state.h"

#include "runtime/core/memory_limit.h"
#include "runtime/core/text.h"
#include "runtime/core/version.h"
#include "runtime/graph/keys.h"

#include <fmt/format.h>

#include <algorithm>

namespace frustum {
namespace {

Diagnostic not_finite(const Culprit& c, const SourcePlace& place) {
  return {.code = "not_finite_result",
          .severity = Severity::warning,
          .pointer = place.pointer,
          .message = fmt::format("{}.{} made the first NaN or infinity ({}){}{}", c.node, c.port, c.where,
                                 c.inputs.empty() ? "" : "; its inputs: ", c.inputs),
          .expected = "finite numbers",
          .got = fmt::format("{} NaN, {} infinities, of {} values", c.health.nan,
                             c.health.positive_infinity + c.health.negative_infinity, c.health.values),
          .file = place.file,
          .line = place.line,
          .column = place.column};
}

}  // namespace

Buffer cut_to_region(const Buffer& b, const std::optional<Rect>& region) {
  if (!b || !region || !b.type().is_pixels()) return b;
  const Raster& all = b.type().raster(b.data());
  const Rect part = intersection(all.frame().window, *region);
  if (part == all.frame().window) return b;
  Frame f = all.frame();
  f.window = part;
  const Raster cut(std::move(f));
  copy(all.view(part), cut.view());
  return b.type().from_raster(cut);
}

RunState::RunState(const Graph& g, const RunOptions& o)
    : graph(g),
      options(o),
      caches(g, options),
      ready_(g.nodes.size()),
      frames_(g.nodes.size()),
      ready_uses_(g.nodes.size()) {
  buffers_.reserve(g.nodes.size());
  uses_.reserve(g.nodes.size());
  for (const GraphNode& n : g.nodes) {
    buffers_.emplace_back(n.type->outputs.size());
    uses_.emplace_back(n.type->outputs.size());
  }
}

void RunState::publish(PortRef p, Buffer b) {
  if (!b) return;
  ledger.add(b);
  buffers_[p.node][p.port] = std::move(b);
}

void RunState::publish_part(PortRef p, Buffer b) {
  ledger.add(b);
  const std::lock_guard lock(mutex_);
  parts_[p] = std::move(b);
}

void RunState::end_use(PortRef p) {
  if (uses_[p.node][p.port].fetch_sub(1) != 1) return;
  Buffer& b = buffers_[p.node][p.port];
  ledger.remove(b);
  b = {};
}

void RunState::end_ready_use(std::size_t node) {
  if (ready_uses_[node].fetch_sub(1) != 1 || !ready_[node]) return;
  ledger.remove_bytes(ready_[node]->bytes);
  ready_[node].reset();
}

void RunState::problem(Diagnostic d, std::size_t order) {
  const std::lock_guard lock(mutex_);
  problems_.emplace_back(order, std::move(d));
}

Diagnostic RunState::at_node(std::size_t node, const std::string& code, const std::string& message,
                             Severity severity, const std::string& part) const {
  const GraphNode& n = graph.nodes[node];
  const SourcePlace place = n.place_of(part);
  // A graph that is used more than once as a node has one file: the id says which use it was.
  const bool inside_a_graph = n.id.find('/') != std::string::npos;
  Diagnostic d{.code = code,
               .severity = severity,
               .pointer = place.pointer,
               .message = inside_a_graph ? fmt::format("{} (at '{}')", message, n.id) : message,
               .file = place.file,
               .line = place.line,
               .column = place.column};
  if (!place.setting.empty()) d.message += fmt::format(" (from --set {})", place.setting);
  return d;
}

void RunState::warning(std::size_t node, const std::string& code, const std::string& message) {
  problem(at_node(node, code, message, Severity::warning), node);
  observe([&](Observer& listener) { listener.warned(graph.nodes[node].id, code, message); });
}

void RunState::culprit(Culprit c, std::size_t order) {
  const std::lock_guard lock(mutex_);
  culprits_.emplace_back(order, std::move(c));
}

void RunState::output_failed(std::size_t output) {
  const std::lock_guard lock(mutex_);
  failed_outputs_.insert(output);
}

bool RunState::has_failed(std::size_t output) {
  const std::lock_guard lock(mutex_);
  return failed_outputs_.contains(output);
}

void RunState::tell(const MemoryNeed& need) {
  observe([&](Observer& o) {
    if (auto* listener = dynamic_cast<MemoryObserver*>(&o)) listener->needs(need);
  });
}

void RunState::decided(std::size_t node, const std::vector<std::pair<std::string, Verdict>>& verdicts) {
  const std::lock_guard lock(mutex_);
  for (const auto& [effect, verdict] : verdicts)
    verdicts_.push_back({node, {graph.nodes[node].id, effect, verdict}});
}

std::vector<std::pair<std::string, std::string>> RunState::metadata() const {
  std::vector<std::pair<std::string, std::string>> out{{"Software", fmt::format("frustum {}", version)}};
  if (!graph.title.empty()) out.emplace_back("ImageDescription", graph.title);
  out.emplace_back("frustum:graph", to_hex(graph_digest(graph)));
  return out;
}

void RunState::check_memory(std::uint64_t further) const {
  check_memory_limit(ledger.live(), further, options.memory);
}

void RunState::take_results(RunResult& result) {
  const auto earlier = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::stable_sort(problems_.begin(), problems_.end(), earlier);
  for (auto& [order, d] : problems_) result.problems.add(std::move(d));
  result.problems.add(caches.take_problems());
  const auto first = std::min_element(culprits_.begin(), culprits_.end(), earlier);
  if (first != culprits_.end()) {
    result.problems.add(not_finite(first->second, graph.nodes[first->first].place));
    result.culprit = std::move(first->second);
  }
  // A run that ended early has made only some of them.
  for (const PortRef p : options.demand.ports)
    if (Buffer b = parts_.contains(p) ? parts_[p] : cut_to_region(buffer(p), options.region))
      result.buffers[p] = std::move(b);
  std::stable_sort(verdicts_.begin(), verdicts_.end(), earlier);
  for (auto& [order, v] : verdicts_) result.verdicts.push_back(std::move(v));
  result.peak_bytes = ledger.peak();
}

}  // namespace frustum
