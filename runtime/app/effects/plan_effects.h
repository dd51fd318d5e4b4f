// What a plan says of effects: which of them the scene calls for and which not, why, and what that is worth.
#pragma once

#include "runtime/app/session.h"

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// What of the graph nobody asks for stands beside the effects of nodes under this name (and those of run_effects.h).
inline constexpr std::string_view unused_nodes = "unused_nodes";

// One effect of one node.
struct PlannedEffect {
  std::string node, effect;
  std::string doc;                       // what is not done where it is off
  bool shortcut = false;                 // EffectDoc
  std::optional<Verdict> verdict;        // none: not decided
  std::string item = {};                 // what verdict->items counts; empty: not measured
  double share = 1;                      // how many of them show something, at most (covered.h)
  std::chrono::nanoseconds estimate{0};  // items times share times what one took in one thread; 0: not known
  std::string undecided = {};            // why there is no verdict
};

struct EffectPlan {
  std::vector<PlannedEffect> effects;  // in the graph's order, nodes that do not run last
  RunResult facts;                     // of the run that found them out: its problems and its end

  std::size_t count(Verdict::Kind) const;
  std::chrono::nanoseconds estimate(Verdict::Kind) const;  // summed
};

// Runs geometry and preparation, no pixel, and writes nothing. Where that fails, the effects decided until then.
EffectPlan plan_effects(Session&, const Graph&, const Demand&, const RunOptions& = {});

// How the effects of a graph's nodes, and of runs, are declared; null where there is none of that name.
const EffectDoc* find_effect(const NodeType&, std::string_view effect);

// Whether some node simulates the effect where it is called for: scenes can call for transparency, and no node that
// declares the effect simulates it.
bool is_simulated(std::string_view effect);

// Every name that --force-effects and --skip-effects take, sorted.
std::vector<std::string> effect_names(const Registry&);

// The policy that two lists of names ask for. An unknown name, or one in both lists, is reported.
EffectPolicy effect_policy(const Registry&, const std::vector<std::string>& forced,
                           const std::vector<std::string>& skipped, Diagnostics& problems);

// [{"node", "effect", "verdict", "why", "items", "item", "estimate_ms", "shortcut", "doc"}]; verdict "undecided", with its "why" too.
Json to_json(const std::vector<PlannedEffect>&);
std::string effects_text(const EffectPlan&);

}  // namespace frustum
