// Runs the cases of suites, each in a process of its own, and says what held.
#pragma once

#include "runtime/app/suite/judge.h"
#include "runtime/app/suite/select.h"

#include <functional>
#include <string>
#include <vector>

namespace frustum {

struct SuiteOptions {
  std::vector<std::string> filters;
  Shard shard;
  int jobs = 0;         // cases at a time; 0: one a processor
  int threads = 0;      // of each case; 0: the processors shared among the jobs
  bool isolate = true;  // false: one after the other in this process, for a debugger; a crash ends everything
  double timeout = 60;  // seconds of a case that says nothing else
  int retry = 0;        // further attempts, of cases that ask for fewer
  Goldens goldens = Goldens::compare;
  std::string staging;  // as JudgeOptions
  std::string evidence;
  bool evidence_of_all = false;
  std::string today;  // "2026-11-22": waivers of earlier days have expired; empty: today
  const CancelFlag* cancel = nullptr;
};

// Runs the chosen cases and hands each result to `each` as soon as it is there. The results are in the order
// of the suites, whatever order the cases ended in. Goldens lie in ../golden beside a suite's folder and are
// read only. Throws Cancelled, all processes being gone first, and WorldError. With `isolate` this process
// must not have started a thread that runs work.
std::vector<CaseResult> run_suites(Session&, const std::vector<Suite>&, const SuiteOptions&,
                                   const std::function<void(const CaseResult&)>& each);

// Records what the results propose, in the books of their suites.
void record_goldens(const std::vector<Suite>&, const std::vector<CaseResult>&, const std::string& reason);

std::string today_utc();  // "2026-11-22"

// Where the goldens of a suite lie.
std::string golden_folder(const Suite&);
// The book there: named after the suite's file, and after its folder too where that is not "suites", since the
// suites of sibling folders keep their books in one place.
std::string golden_book(const Suite&);

}  // namespace frustum
