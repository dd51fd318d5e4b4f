#include "runtime/graph/plan.h"

#include <algorithm>
#include <map>
#include <set>

namespace frustum {
namespace {

// The planner's notes about one node of the graph.
struct Note {
  bool wanted = false;
  std::uint64_t outputs = 0;
  std::vector<std::string> wanted_by;
  // How many times, on the way here, pixels must have been made whole. A node that streams shares its feeders' level; one
  // that reads a pixel port whole stands a level above it, since it cannot start before that pass has ended.
  std::size_t level = 0;
};

class Planner {
 public:
  Planner(const Graph& graph, const Demand& demand, const PlanOptions& options)
      : graph_(graph), demand_(demand), options_(options), notes_(graph.nodes.size()) {}

  Plan run() {
    demand_ports();
    walk_back();
    find_levels();
    group_passes();
    collect_nodes();
    order_steps();
    return std::move(plan_);
  }

 private:
  using Root = PixelPass::Root;

  bool is_pixel(std::size_t node) const { return graph_.nodes[node].type->is_pixel(); }
  bool given(PortRef p) const { return options_.given && options_.given(p); }

  void want(PortRef p, const std::string& by) {
    if (given(p)) return;
    Note& n = notes_[p.node];
    n.wanted = true;
    n.outputs |= std::uint64_t{1} << std::min<std::size_t>(p.port, 63);
    if (n.wanted_by.empty() || n.wanted_by.back() != by) n.wanted_by.push_back(by);
  }

  void make_whole(PortRef p, Whole why) {
    if (!is_pixel(p.node) || given(p)) return;
    const auto [at, added] = whole_.emplace(p, why);
    if (!added && at->second == Whole::demanded)
      at->second = why;  // the stronger reason: it needs every pixel
  }

  // Whether readers by tiles find the port in memory.
  bool ends_stream(PortRef p) const {
    if (given(p)) return true;
    const auto at = whole_.find(p);
    return at != whole_.end() && !(options_.cropped && at->second == Whole::demanded);
  }

  void demand_ports() {
    for (const PortRef p : demand_.ports) {
      want(p, "demand");
      make_whole(p, Whole::demanded);
    }
    for (const std::size_t o : demand_.outputs)
      for (const OutputLayer& layer : graph_.outputs[o].layers) {
        want(layer.from, graph_.outputs[o].name);
        if (graph_.outputs[o].whole) make_whole(layer.from, Whole::read_whole);
      }
  }

  // Feeders stand before their consumers, so one walk from the end reaches everything.
  void walk_back() {
    for (std::size_t i = graph_.nodes.size(); i-- > 0;) {
      if (!notes_[i].wanted) continue;
      for_each_link(i, [&](PortRef from, bool streams) {
        want(from, graph_.nodes[i].id);
        if (!streams)
          make_whole(from, Whole::read_whole);
        else if (!options_.fuse)
          make_whole(from, Whole::not_fused);
      });
    }
  }

  template <class F>
  void for_each_link(std::size_t node, F&& f) const {
    const GraphNode& n = graph_.nodes[node];
    for (std::size_t i = 0; i < n.inputs.size(); ++i)
      for (const Source& s : n.inputs[i])
        if (const auto* from = std::get_if<PortRef>(&s))
          f(*from, n.type->inputs[i].tiled && is_pixel(from->node));
  }

  void find_levels() {
    for (std::size_t i = 0; i < graph_.nodes.size(); ++i) {
      if (!notes_[i].wanted) continue;
      for_each_link(i, [&](PortRef from, bool) {
        if (given(from)) return;
        notes_[i].level = std::max(notes_[i].level,
                                   notes_[from.node].level + (!whole_.empty() && ends_stream(from) ? 1 : 0));
      });
    }
  }

  // The pixel nodes that stream into `node`, itself included; ports made whole by an earlier pass end the walk.
  void stream_closure(std::size_t node, std::set<std::size_t>& nodes) const {
    if (!nodes.insert(node).second) return;
    for_each_link(node, [&](PortRef from, bool streams) {
      if (streams && !ends_stream(from)) stream_closure(from.node, nodes);
    });
  }

  struct Group {
    std::size_t level = 0;
    std::set<std::size_t> nodes = {};
    std::vector<Root> roots = {};
    std::vector<std::size_t> outputs = {};
  };

  void add_group(Group g) {
    for (std::size_t i = 0; i < groups_.size();) {
      Group& other = groups_[i];
      const bool shared =
          std::any_of(g.nodes.begin(), g.nodes.end(), [&](std::size_t n) { return other.nodes.contains(n); });
      if (other.level != g.level || !shared) {
        ++i;
        continue;
      }
      g.nodes.merge(other.nodes);
      g.roots.insert(g.roots.begin(), other.roots.begin(), other.roots.end());
      g.outputs.insert(g.outputs.begin(), other.outputs.begin(), other.outputs.end());
      groups_.erase(groups_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    groups_.push_back(std::move(g));
  }

  void group_passes() {
    for (const auto& [port, why] : whole_) {
      Group g{.level = notes_[port.node].level, .roots = {{port, why}}};
      stream_closure(port.node, g.nodes);
      add_group(std::move(g));
    }
    for (const std::size_t o : demand_.outputs) {
      Group g{.outputs = {o}};
      for (const OutputLayer& layer : graph_.outputs[o].layers) {
        const bool whole = ends_stream(layer.from);
        g.level = std::max(g.level, notes_[layer.from.node].level + (whole && !given(layer.from) ? 1 : 0));
        if (is_pixel(layer.from.node) && !whole) stream_closure(layer.from.node, g.nodes);
      }
      add_group(std::move(g));
    }
    std::stable_sort(groups_.begin(), groups_.end(),
                     [](const Group& a, const Group& b) { return a.level < b.level; });
    for (Group& g : groups_) {
      std::sort(g.outputs.begin(), g.outputs.end());
      plan_.passes.push_back({{g.nodes.begin(), g.nodes.end()}, std::move(g.roots), std::move(g.outputs)});
    }
  }

  void collect_nodes() {
    for (std::size_t i = 0; i < notes_.size(); ++i) {
      if (notes_[i].wanted)
        plan_.nodes.push_back({i, notes_[i].outputs, std::move(notes_[i].wanted_by)});
      else
        plan_.skipped.push_back(i);
    }
  }

  // ----- steps

  static constexpr auto nowhere = static_cast<std::size_t>(-1);

  // Adds a step that waits for others; `waits` may name one twice.
  std::size_t add_step(Step step, std::vector<std::size_t>& waits) {
    std::sort(waits.begin(), waits.end());
    waits.erase(std::unique(waits.begin(), waits.end()), waits.end());
    for (const std::size_t w : waits) plan_.steps[w].followers.push_back(plan_.steps.size());
    step.waits_for = waits.size();
    plan_.steps.push_back(std::move(step));
    waits.clear();
    return plan_.steps.size() - 1;
  }

  // The step that a reader of the port waits for: the pass that makes it whole, or the node itself.
  void wait_for(PortRef from, bool streams) {
    if (given(from)) return;
    const auto whole = whole_.empty() ? step_of_whole_.end() : step_of_whole_.find(from);
    if (whole != step_of_whole_.end() && !streams && ends_stream(from))
      waits_.push_back(whole->second);
    else
      waits_.push_back(step_of_node_[from.node]);
  }

  void add_node_step(std::size_t node) {
    for_each_link(node, [&](PortRef from, bool streams) { wait_for(from, streams); });
    step_of_node_[node] = add_step({.kind = Step::Kind::node, .index = node}, waits_);
  }

  void add_pass_step(std::size_t pass) {
    const PixelPass& p = plan_.passes[pass];
    for (const std::size_t n : p.nodes) {
      waits_.push_back(step_of_node_[n]);
      for_each_link(n, [&](PortRef from, bool) {
        const auto w = step_of_whole_.find(from);
        if (w != step_of_whole_.end() && ends_stream(from)) waits_.push_back(w->second);
      });
    }
    for (const std::size_t o : p.outputs)
      for (const OutputLayer& layer : graph_.outputs[o].layers) wait_for(layer.from, false);
    const std::size_t step = add_step({.kind = Step::Kind::pass, .index = pass}, waits_);
    for (const auto& root : p.roots) step_of_whole_[root.port] = step;
  }

  // A pass can be placed once all nodes of its level are; nodes of the next level wait for it.
  void order_steps() {
    step_of_node_.assign(graph_.nodes.size(), nowhere);
    plan_.steps.reserve(plan_.nodes.size() + plan_.passes.size());
    std::vector<std::size_t> order;
    order.reserve(plan_.nodes.size());
    for (const PlannedNode& n : plan_.nodes) order.push_back(n.node);
    if (!groups_.empty())
      std::stable_sort(order.begin(), order.end(),
                       [&](std::size_t a, std::size_t b) { return notes_[a].level < notes_[b].level; });
    std::size_t next_pass = 0;
    for (const std::size_t node : order) {
      while (next_pass < groups_.size() && groups_[next_pass].level < notes_[node].level)
        add_pass_step(next_pass++);
      add_node_step(node);
    }
    while (next_pass < groups_.size()) add_pass_step(next_pass++);
  }

  const Graph& graph_;
  const Demand& demand_;
  const PlanOptions& options_;
  std::vector<Note> notes_;
  std::map<PortRef, Whole> whole_;
  std::vector<Group> groups_;
  std::vector<std::size_t> step_of_node_;  // nowhere: not planned
  std::map<PortRef, std::size_t> step_of_whole_;
  std::vector<std::size_t> waits_;  // of the step being added
  Plan plan_;
};

}  // namespace

std::string_view name_of(Whole why) {
  switch (why) {
    case Whole::demanded: return "demanded";
    case Whole::read_whole: return "read whole";
    case Whole::not_fused: return "not fused";
  }
  return "";
}

Plan make_plan(const Graph& graph, const Demand& demand, const PlanOptions& options) {
  return Planner(graph, demand, options).run();
}

}  // namespace frustum
