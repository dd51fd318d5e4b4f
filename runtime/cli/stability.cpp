// frustum stability: the hard cases, each with a naive method that fails and ours that does not.
#include "runtime/app/stability/docs.h"
#include "runtime/app/stability/report.h"
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum::cli {
namespace {

struct Arguments {
  stability::Options options;
  std::string docs;
};

int stability(const Arguments& args, bool json) {
  const auto& all = stability::hard_cases();
  stability::Options options = args.options;
  options.cancel = &cancel_flag();
  const auto outcomes = stability::run_cases(all, options);
  if (outcomes.empty()) throw UsageError("no hard case matches the filters");
  if (!args.docs.empty()) {
    if (!args.options.filters.empty() || args.options.gate_only)
      throw UsageError("--docs describes the whole catalogue: leave out --filter and --quick");
    stability::write_docs(all, outcomes, args.docs);
  }
  if (json)
    print(to_json(outcomes));
  else
    print(to_text(outcomes));
  const bool all_hold = std::none_of(outcomes.begin(), outcomes.end(), [](const auto& o) {
    return o.state == stability::State::broken || o.state == stability::State::naive_survives;
  });
  return all_hold ? done : check_failed;
}

}  // namespace

void add_stability(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c = add_command(
      app, chosen, "stability", "Runs the hard cases: naive and robust error, bound and cost of each.",
      "frustum stability --filter clipping", [args, &chosen] { return stability(*args, chosen.json); });
  c.add_option("--filter", args->options.filters,
               "Only cases with this in their id, stage or title; repeatable.")
      ->type_name("TEXT")
      ->allow_extra_args(false);
  auto* quick =
      c.add_flag("--quick", args->options.gate_only, "Only the gate: the cases that must never break.");
  c.add_flag("--full", args->options.full, "Many more inputs of each case.")->excludes(quick);
  c.add_option("--docs", args->docs, "Also writes stability.md and its pictures into this folder.")
      ->type_name("DIR");
}

}  // namespace frustum::cli
