// frustum plan GRAPH: what would run and why, what not, what streams and what is held whole; which effects the scene
// calls for; and whether what is left out would have changed a bit.
#include "runtime/app/effects/plan_effects.h"
#include "runtime/app/effects/prove.h"
#include "runtime/cli/command.h"
#include "runtime/core/text.h"
#include "runtime/graph/memory_need.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace frustum::cli {
namespace {

struct Arguments {
  GraphArguments graph;
  std::vector<std::string> wanted;
  bool no_fuse = false;
  bool prove = false;
  int repeats = 3, threads = 0;
  std::string memory;
};

// Where a run that fills no pixel was when most bytes were live, or would have been.
class PeakMemory : public MemoryObserver {
 public:
  void needs(const MemoryNeed& need) override {
    if (need.most > peak_.most) peak_ = need;
    least_ = std::max(least_, need.least);
    if (need.pass) counted_.insert(need.nodes.begin(), need.nodes.end());
  }

  // The passes that nothing is known of yet: they read pixels that an earlier one makes whole.
  std::vector<std::string> not_counted(const Graph& graph, const Plan& plan) const {
    std::vector<std::string> out;
    for (const PixelPass& pass : plan.passes)
      for (const std::size_t n : pass.nodes)
        if (!counted_.contains(graph.nodes[n].id)) out.push_back(graph.nodes[n].id);
    return out;
  }

  Json json(const Graph& graph, const Plan& plan) const {
    return {
        {"peak_bytes", {least_, peak_.most}}, {"at", peak_.nodes}, {"not_counted", not_counted(graph, plan)}};
  }

  std::string text(const Graph& graph, const Plan& plan) const {
    if (peak_.most == 0) return {};
    const std::string least = human_bytes(least_), most = human_bytes(peak_.most);
    const auto rest = not_counted(graph, plan);
    return fmt::format(
        "memory: {} of buffers at the peak, {} {}{}\n",
        least == most ? "about " + most : fmt::format("{} to {}", least, most),
        peak_.pass ? "in the pass to" : "at", peak_.nodes.back(),
        rest.empty() ? ""
                     : fmt::format("; not counted, since pixels feed them whole: {}", fmt::join(rest, ", ")));
  }

 private:
  std::uint64_t least_ = 0;
  MemoryNeed peak_;
  std::set<std::string, std::less<>> counted_;
};

std::vector<std::string> ids(const Graph& graph, const std::vector<std::size_t>& nodes) {
  std::vector<std::string> out;
  for (const std::size_t n : nodes) out.push_back(graph.nodes[n].id);
  return out;
}

std::vector<std::string> output_names(const Graph& graph, const std::vector<std::size_t>& outputs) {
  std::vector<std::string> out;
  for (const std::size_t o : outputs) out.push_back(graph.outputs[o].name);
  return out;
}

std::vector<std::string> foreign(const Graph& graph, const Plan& plan) {
  std::vector<std::string> out;
  for (const PlannedNode& n : plan.nodes)
    if (graph.nodes[n.node].type->foreign) out.push_back(graph.nodes[n.node].id);
  return out;
}

// What a node's parameters settle for others, in its words; empty for most.
std::string stated(const GraphNode& node) {
  return node.type->states ? node.type->states(node.params.get()) : std::string();
}

Json plan_json(const Graph& graph, const Plan& plan) {
  Json nodes = Json::array(), passes = Json::array(), steps = Json::array();
  for (const PlannedNode& n : plan.nodes) {
    const GraphNode& node = graph.nodes[n.node];
    Json outputs = Json::array();
    for (std::size_t p = 0; p < node.type->outputs.size(); ++p)
      if (p >= 64 || ((n.wanted_outputs >> p) & 1) != 0) outputs.push_back(node.type->outputs[p].name);
    nodes.push_back({{"id", node.id},
                     {"type", node.type->name},
                     {"kind", node.type->is_pixel() ? "pixels" : "geometry"},
                     {"outputs", outputs},
                     {"wanted_by", n.wanted_by}});
    if (const std::string sentence = stated(node); !sentence.empty()) nodes.back()["states"] = sentence;
  }
  for (const PixelPass& pass : plan.passes) {
    Json whole = Json::array();
    for (const auto& root : pass.roots)
      whole.push_back({{"port", graph.name(root.port)}, {"why", name_of(root.why)}});
    passes.push_back({{"nodes", ids(graph, pass.nodes)},
                      {"whole", whole},
                      {"outputs", output_names(graph, pass.outputs)}});
  }
  for (const Step& s : plan.steps) {
    Json step = Json::object();
    if (s.kind == Step::Kind::node)
      step["node"] = graph.nodes[s.index].id;
    else
      step["pass"] = s.index;
    step["followers"] = s.followers;
    steps.push_back(std::move(step));
  }
  return {{"nodes", nodes},
          {"skipped", ids(graph, plan.skipped)},
          {"passes", passes},
          {"steps", steps},
          {"foreign", foreign(graph, plan)}};
}

std::string plan_text(const Graph& graph, const Plan& plan) {
  std::vector<std::vector<std::string>> rows;
  for (const PlannedNode& n : plan.nodes) {
    const GraphNode& node = graph.nodes[n.node];
    rows.push_back({node.id, node.type->name, fmt::format("for {}", fmt::join(n.wanted_by, ", "))});
  }
  std::string out = fmt::format("{} nodes run:\n{}", plan.nodes.size(), aligned(rows, 2));
  for (const PlannedNode& n : plan.nodes)
    if (const std::string sentence = stated(graph.nodes[n.node]); !sentence.empty())
      out += fmt::format("as {} has it: {}\n", graph.nodes[n.node].id, sentence);
  for (const PixelPass& pass : plan.passes) {
    const bool saves = pass.outputs.size() == 1 && graph.outputs[pass.outputs.front()].whole;
    if (saves) {
      out +=
          fmt::format("a whole buffer is saved as output '{}'\n", graph.outputs[pass.outputs.front()].name);
      continue;
    }
    out += fmt::format("one pass over tiles: {}\n", fmt::join(ids(graph, pass.nodes), " > "));
    for (const auto& root : pass.roots)
      out += fmt::format("  {} is held whole: {}\n", graph.name(root.port), name_of(root.why));
    for (const std::string& o : output_names(graph, pass.outputs))
      out += fmt::format("  streams to output '{}'\n", o);
  }
  if (!plan.skipped.empty())
    out +=
        fmt::format("not run, since nobody asks for them: {}\n", fmt::join(ids(graph, plan.skipped), ", "));
  if (const auto f = foreign(graph, plan); !f.empty())
    out += fmt::format("computed by a library, same bytes on one processor only: {}\n", fmt::join(f, ", "));
  return out;
}

int show(Session& session, const Arguments& args, const Graph& graph, const Demand& demand, bool json) {
  const Plan made = make_plan(graph, demand, {.fuse = !args.no_fuse});
  PeakMemory memory;
  const EffectPlan effects = plan_effects(session, graph, demand,
                                          {.threads = args.threads,
                                           .fuse = !args.no_fuse,
                                           .memory = memory_limit(args.memory),
                                           .cancel = &cancel_flag(),
                                           .observer = &memory});
  if (json) {
    Json out = plan_json(graph, made);
    out["memory"] = memory.json(graph, made);
    out["effects"] = to_json(effects.effects);
    print(with_diagnostics(std::move(out), effects.facts.problems));
  } else {
    print(plan_text(graph, made) + memory.text(graph, made) + effects_text(effects));
    report(effects.facts.problems);
  }
  return exit_code(effects.facts);
}

int prove(Session& session, const Arguments& args, const Graph& graph, const Demand& demand, bool json) {
  const Proof proof = prove_effects(
      session, graph, demand, {.repeats = args.repeats, .threads = args.threads, .cancel = &cancel_flag()});
  if (proof.end != RunResult::End::done) {
    RunResult failed;
    failed.end = proof.end;
    return fail(proof.problems, json, static_cast<Exit>(exit_code(failed)));
  }
  if (json)
    print(with_diagnostics(to_json(proof), proof.problems));
  else
    print(proof_text(proof));
  return proof.holds() ? done : check_failed;
}

int plan(const Arguments& args, bool json) {
  Session session;
  const auto graph = load_or_report(session, args.graph, json, load_options(args.graph));
  if (!graph) return bad_input;
  Diagnostics problems;
  const Demand demand = demand_of(*graph, args.wanted, problems);
  if (problems.has_errors()) return fail(problems, json);
  return args.prove ? prove(session, args, *graph, demand, json) : show(session, args, *graph, demand, json);
}

}  // namespace

void add_plan(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c = add_command(app, chosen, "plan", "Says what would run, what not, and why.",
                            "frustum plan graphs/gallery/teapot_stages.json --want hits.depth",
                            [args, &chosen] { return plan(*args, chosen.json); });
  add_graph_arguments(c, args->graph);
  c.add_option("--want", args->wanted, "Only this output or port; repeatable.")
      ->type_name("NODE.PORT|OUTPUT")
      ->allow_extra_args(false);
  c.add_flag("--no-fuse", args->no_fuse, "Every pixel node's outputs become whole.");
  c.add_flag(
      "--prove", args->prove,
      "Runs the graph as planned and with what is off forced, all and one by one, and compares every bit; "
      "exit 1 where one differs.");
  c.add_option("--repeats", args->repeats, "With --prove: timed runs of each, in turns.")
      ->check(quiet(CLI::Range(1, 1000)))
      ->capture_default_str()
      ->type_name("N");
  c.add_option("--threads", args->threads, "Threads; 0 takes every processor.")
      ->check(quiet(CLI::Range(0, 4096)))
      ->type_name("N");
  add_memory_argument(c, args->memory);
  c.get_option("--memory")->excludes("--prove");
}

}  // namespace frustum::cli
