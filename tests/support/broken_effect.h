// A node type whose predicate lies, for tests that must catch it.
#pragma once

#include "runtime/core/node_type.h"
#include "runtime/core/registry.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::test {

// Calls `work` so that it leaves `effect` out unless it is forced, and then says of it that nothing called for it.
template <class Work>
auto lied_to(Context& ctx, const std::string& effect, const Work& work) {
  Context honest = ctx;
  EffectPolicy policy = ctx.effects != nullptr ? *ctx.effects : EffectPolicy{};
  if (!policy.forces(effect)) policy.skipped.insert(effect);
  honest.effects = &policy;
  auto made = work(honest);
  for (const auto& [name, verdict] : honest.verdicts())
    ctx.decide(name, name == effect ? off_exact("a lie") : verdict);
  return made;
}

// The type with one of its predicates replaced by: never.
inline NodeType with_broken_effect(NodeType type, const std::string& effect) {
  if (type.run)
    type.run = [run = type.run, effect](std::span<const std::vector<Buffer>> in, const void* params,
                                        Context& ctx) {
      return lied_to(ctx, effect, [&](Context& c) { return run(in, params, c); });
    };
  if (type.prepare)
    type.prepare = [prepare = type.prepare, effect](std::span<const PreparedInput> in, const void* params,
                                                    Context& ctx) {
      return lied_to(ctx, effect, [&](Context& c) { return prepare(in, params, c); });
    };
  return type;
}

// The registry with that effect broken in every node type that has it.
inline Registry with_broken_effect(const Registry& all, const std::string& effect) {
  std::vector<NodeType> types;
  for (const auto& [name, type] : all) {
    const bool has = std::any_of(type.effects.begin(), type.effects.end(),
                                 [&](const EffectDoc& e) { return e.name == effect; });
    types.push_back(has ? with_broken_effect(type, effect) : type);
  }
  return Registry(std::move(types));
}

}  // namespace frustum::test
