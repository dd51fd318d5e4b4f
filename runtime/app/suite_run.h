// Runs the cases of a suite and says what held.
#pragma once

#include "runtime/app/session.h"
#include "runtime/app/suite.h"

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace frustum {

enum class Verdict : std::uint8_t { pass, fail, crash };
std::string_view name_of(Verdict);

struct CaseResult {
  std::string suite, id;
  Verdict verdict = Verdict::pass;
  std::vector<std::string> failures;  // one sentence a check that did not hold
  std::vector<std::string> accepted;  // one sentence a golden that was recorded
  int checks = 0;                     // that were made
  std::chrono::nanoseconds time{0};
  std::string rerun;  // the command that runs this case alone
};

struct SuiteOptions {
  std::vector<std::string> filters;  // a part of the id, or a tag; empty: every case
  bool accept = false;               // record goldens instead of comparing with them
  std::string reason;                // kept with what is accepted
  int threads = 0;
  const CancelFlag* cancel = nullptr;
};

// Runs the chosen cases in order and hands each result to `each` as soon as it is there. Cancelled is
// thrown between cases. Goldens lie in ../golden beside the suite's folder.
std::vector<CaseResult> run_suite(Session&, const Suite&, const SuiteOptions&,
                                  const std::function<void(const CaseResult&)>& each);

Json to_json(const std::vector<CaseResult>&);
std::string to_text(const CaseResult&, bool color);
// JUnit XML, one test suite per suite file.
std::string junit_text(const std::vector<CaseResult>&);

}  // namespace frustum
