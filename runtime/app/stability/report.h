// Runs hard cases and says what came of them.
#pragma once

#include "runtime/app/stability/hard_case.h"

#include "runtime/core/context.h"
#include "runtime/core/diagnostic.h"

#include <functional>
#include <string>
#include <vector>

namespace frustum::stability {

enum class State {
  holds,           // the naive method breaks the bound, ours keeps it
  broken,          // ours does not
  naive_survives,  // the naive method keeps the bound too: the case shows nothing
  argued,
  not_built,
};
std::string_view name_of(State);

struct Outcome {
  const CatalogueRow* row;
  const HardCase* hard_case = nullptr;  // none: argued or not built
  State state = State::not_built;
  std::string why = {};  // argued: why; not built: what it waits for; broken: what did not hold
  Errors naive = {}, robust = {};
  std::optional<Price> paid = {};
  double seconds = 0;
};

struct Options {
  std::vector<std::string> filters = {};  // parts of ids, titles or stages; none: all
  bool gate_only = false;
  bool full = false;                   // more samples
  bool timed = true;                   // measure the price
  const CancelFlag* cancel = nullptr;  // looked at between cases
};

// Runs one case of the catalogue.
Outcome run_case(const HardCases&, const CatalogueRow&, const Options&);
// Runs what the options choose, in the catalogue's order; `done` sees each outcome as it comes. Throws Cancelled.
std::vector<Outcome> run_cases(const HardCases&, const Options&,
                               const std::function<void(const Outcome&)>& done = {});

// Median of robust / naive time over the cases that have a price; 0 without any.
double median_price(const std::vector<Outcome>&);

// "1.2e-05", "inf", "0": two digits, the same on every machine.
std::string error_text(double error);
// Numbers as hexadecimal floats: they reproduce the case bit for bit.
std::string witness_text(const Witness&);

std::string to_text(const std::vector<Outcome>&);  // the table of the command
Json to_json(const std::vector<Outcome>&);

}  // namespace frustum::stability
