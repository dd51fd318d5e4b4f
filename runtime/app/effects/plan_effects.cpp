#include "runtime/app/effects/plan_effects.h"

#include "runtime/app/effects/covered.h"
#include "runtime/core/param.h"
#include "runtime/core/text.h"
#include "runtime/graph/run_effects.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace frustum {
namespace {

using Kind = Verdict::Kind;

std::string_view name_of_verdict(const std::optional<Verdict>& v) {
  if (!v) return "undecided";
  for (const auto& [kind, name] : choices(Kind{}))
    if (kind == v->kind) return name;
  return "";
}

// What a number costs depends on who computes it; here those of rasterize.attributes, of which most unread planes are.
const std::vector<EffectDoc>& effects_of_runs() {
  static const std::vector<EffectDoc> all{
      {.name = std::string(unread_planes),
       .doc = "Planes are filled that nobody reads.",
       .cost = {"number", 2}},  // tests/bench/effects_bench.cpp, one thread: 1.5 to 2.5
      {.name = std::string(blank_pixels),
       .doc = "Pixels are computed that show nothing.",
       .cost = {"blank sample", 1.4}},  // tests/bench/effects_bench.cpp, one thread: 1.3 to 1.5
      {.name = std::string(unused_outputs), .doc = "Outputs are computed that nobody reads."},
      {.name = std::string(unused_nodes), .doc = "Nodes run that feed nothing that is asked for."}};
  return all;
}

// Where nothing is seen, samples are passed over; pixels, faces and vertices are all gone through.
bool may_show_nothing(std::string_view item) {
  return item == "sample" || item == "point" || item == "number";
}

PlannedEffect planned(const std::string& node, const EffectDoc& doc, std::optional<Verdict> verdict,
                      double share = 1) {
  PlannedEffect e{.node = node,
                  .effect = doc.name,
                  .doc = doc.doc,
                  .shortcut = doc.shortcut,
                  .verdict = std::move(verdict)};
  if (e.verdict && e.verdict->items != 0 && !doc.cost.item.empty()) {
    e.item = doc.cost.item;
    if (may_show_nothing(e.item)) e.share = share;
    e.estimate =
        std::chrono::nanoseconds(std::llround(static_cast<double>(e.verdict->items) * e.share * doc.cost.ns));
  }
  return e;
}

const EffectDoc& declared(const NodeType& type, std::string_view effect) {
  if (const EffectDoc* doc = find_effect(type, effect)) return *doc;
  const auto& of_runs = effects_of_runs();
  return *std::find_if(of_runs.begin(), of_runs.end(), [&](const EffectDoc& d) { return d.name == effect; });
}

// The node that a problem of a run is told at; null where it is told at an output, or a setting of the graph around it.
const GraphNode* node_at(const Graph& graph, const Diagnostic& d) {
  const auto holds = [&](const GraphNode& n) {
    const std::string& at = n.place.pointer;
    return n.place.file == d.file && d.pointer.starts_with(at) &&
           (d.pointer.size() == at.size() || d.pointer[at.size()] == '/');
  };
  const auto found = std::find_if(graph.nodes.begin(), graph.nodes.end(), holds);
  return found == graph.nodes.end() ? nullptr : &*found;
}

// Why effects are left undecided: of a run that came to its end, those of pixels are; others end at their first error.
std::string why_undecided(const Graph& graph, const RunResult& facts) {
  if (facts.end == RunResult::End::done) return "the pixels that it depends on do not exist before the run";
  if (facts.end == RunResult::End::cancelled) return "the plan was cancelled";
  for (const Diagnostic& d : facts.problems.list()) {
    if (d.severity != Severity::error) continue;
    if (const GraphNode* n = node_at(graph, d)) return fmt::format("'{}' could not be made", n->id);
  }
  return "a node could not be made";
}

// The effects of one node that runs: those decided, then those that are not.
void add_node(const GraphNode& node, const RunResult& facts, double share, const std::string& undecided,
              std::vector<PlannedEffect>& out) {
  std::set<std::string, std::less<>> decided;
  for (const NodeVerdict& v : facts.verdicts) {
    if (v.node != node.id) continue;
    decided.insert(v.effect);
    out.push_back(planned(node.id, declared(*node.type, v.effect), v.verdict, share));
  }
  for (const EffectDoc& doc : node.type->effects)
    if (!decided.contains(doc.name)) {
      out.push_back(planned(node.id, doc, std::nullopt));
      out.back().undecided = undecided;
    }
}

std::string amount(std::uint64_t n, std::string_view item) {
  if (n != 1 && item.ends_with("ex"))
    return fmt::format("{} {}ices", n, item.substr(0, item.size() - 2));  // vertices
  return fmt::format("{} {}{}", n, item, n == 1 ? "" : "s");
}

std::vector<std::string> row(const PlannedEffect& e) {
  std::string why = e.verdict ? e.verdict->why : e.undecided;
  if (e.estimate.count() > 0)
    why += fmt::format(" (about {}: {}{})", human_time(e.estimate),
                       e.share < 1 ? fmt::format("{:.0f} % of ", 100 * e.share) : "",
                       amount(e.verdict->items, e.item));
  return {std::string(name_of_verdict(e.verdict)), e.effect, e.node, why};
}

}  // namespace

std::size_t EffectPlan::count(Kind kind) const {
  return static_cast<std::size_t>(std::count_if(effects.begin(), effects.end(), [&](const PlannedEffect& e) {
    return e.verdict && e.verdict->kind == kind;
  }));
}

std::chrono::nanoseconds EffectPlan::estimate(Kind kind) const {
  std::chrono::nanoseconds sum{0};
  for (const PlannedEffect& e : effects)
    if (e.verdict && e.verdict->kind == kind) sum += e.estimate;
  return sum;
}

const EffectDoc* find_effect(const NodeType& type, std::string_view effect) {
  for (const EffectDoc& d : type.effects)
    if (d.name == effect) return &d;
  return nullptr;
}

bool is_simulated(std::string_view effect) { return effect != "transparency"; }

EffectPlan plan_effects(Session& session, const Graph& graph, const Demand& demand, const RunOptions& base) {
  RunOptions options = base;
  options.demand = demand;
  options.only_facts = true;
  const Plan plan = make_plan(graph, demand, {.fuse = options.fuse});
  std::set<std::size_t> runs;
  for (const PlannedNode& n : plan.nodes) runs.insert(n.node);
  for (const PortRef mesh : screen_meshes(graph))
    if (runs.contains(mesh.node)) options.demand.ports.push_back(mesh);
  EffectPlan made{.effects = {}, .facts = session.run(graph, options, false)};
  const std::vector<double> shares = covered_shares(graph, made.facts);
  const std::string undecided = why_undecided(graph, made.facts);
  for (const PlannedNode& n : plan.nodes)
    add_node(graph.nodes[n.node], made.facts, shares[n.node], undecided, made.effects);
  for (const std::size_t n : plan.skipped)
    made.effects.push_back(planned(graph.nodes[n].id, effects_of_runs().back(),
                                   off_exact("no path leads from it to anything that is asked for")));
  return made;
}

std::vector<std::string> effect_names(const Registry& registry) {
  std::set<std::string> names{std::string(unread_planes), std::string(unused_outputs),
                              std::string(blank_pixels)};
  for (const auto& [name, type] : registry)
    for (const EffectDoc& e : type.effects)
      if (is_simulated(e.name)) names.insert(e.name);
  return {names.begin(), names.end()};
}

EffectPolicy effect_policy(const Registry& registry, const std::vector<std::string>& forced,
                           const std::vector<std::string>& skipped, Diagnostics& problems) {
  const std::vector<std::string> known = effect_names(registry);
  const auto check = [&](const std::string& name, std::string_view option) {
    if (std::binary_search(known.begin(), known.end(), name)) return true;
    problems.add({.code = "unknown_effect",
                  .pointer = "",
                  .message = fmt::format("{}: '{}' is no effect of any node type", option, name),
                  .expected = "a name that frustum plan lists",
                  .got = name,
                  .suggestions = nearest_names(name, known)});
    return false;
  };
  EffectPolicy policy;
  for (const std::string& name : forced) {
    if (name == "all")
      policy.force_all = true;
    else if (check(name, "--force-effects"))
      policy.forced.insert(name);
  }
  for (const std::string& name : skipped) {
    if (!check(name, "--skip-effects")) continue;
    policy.skipped.insert(name);
    if (!policy.forces(name)) continue;
    problems.add({.code = "contradiction",
                  .pointer = "",
                  .message = fmt::format("'{}' is asked to be forced and to be skipped", name)});
  }
  return policy;
}

Json to_json(const std::vector<PlannedEffect>& effects) {
  Json out = Json::array();
  for (const PlannedEffect& e : effects) {
    Json j = {{"node", e.node}, {"effect", e.effect}, {"verdict", name_of_verdict(e.verdict)}};
    j["why"] = e.verdict ? e.verdict->why : e.undecided;
    if (e.verdict && e.verdict->items != 0) j["items"] = e.verdict->items;
    if (!e.item.empty()) j["item"] = e.item;
    if (e.share < 1) j["share"] = e.share;
    if (e.estimate.count() > 0)
      j["estimate_ms"] = std::chrono::duration<double, std::milli>(e.estimate).count();
    j["shortcut"] = e.shortcut;
    j["doc"] = e.doc;
    out.push_back(std::move(j));
  }
  return out;
}

std::string effects_text(const EffectPlan& plan) {
  if (plan.effects.empty()) return "";
  std::string out = fmt::format("effects: {} on, {} off for what the scene is, {} off by wish, {} absent\n",
                                plan.count(Kind::on), plan.count(Kind::off_exact), plan.count(Kind::off_user),
                                plan.count(Kind::absent));
  std::vector<std::vector<std::string>> rows;
  for (const PlannedEffect& e : plan.effects) rows.push_back(row(e));
  out += aligned(rows, 2);
  if (const auto saved = plan.estimate(Kind::off_exact); saved.count() > 0)
    out +=
        fmt::format("what is off would take about {} in one thread: an estimate, from the time of one item\n",
                    human_time(saved));
  return out;
}

}  // namespace frustum
