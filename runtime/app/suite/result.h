// What became of the cases of a suite.
#pragma once

#include "runtime/core/diagnostic.h"

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

enum class CaseVerdict : std::uint8_t { pass, fail, skip, timeout, crash, waived, flaky };
constexpr int verdicts = 7;
std::string_view name_of(CaseVerdict);
// fail, timeout and crash: what makes `frustum test` end with 1.
bool counts_against(CaseVerdict);

// One thing that was asked of one port.
struct CheckOutcome {
  std::string port, check;  // "lit.color", "rmse"
  std::string measured, bound;
  bool held = true;
};

// A golden that --accept records, or --review would.
struct Candidate {
  std::string key, digest;
  std::string change;  // "new", "was 0123..., rmse 0.01, max 0.2"
  std::string staged;  // the file with its numbers, to be moved beside the book; empty: the digest is all
  bool trace = false;  // of a port on the way: not worth a line of its own
};

// Two pictures that were compared, as files in the folder of the evidence.
struct PictureEvidence {
  std::string port, against;
  std::string output, reference;  // file names; reference is empty where there is none yet
  std::string color_space;        // of both; the files do not keep it
};

struct CaseResult {
  std::string suite, suite_file, id;
  std::vector<std::string> tags;
  CaseVerdict verdict = CaseVerdict::pass;
  std::vector<std::string> failures;  // one sentence a check that did not hold
  std::vector<std::string> notes;     // what fails nothing: a budget of time, a waiver that is not needed
  std::vector<CheckOutcome> outcomes;
  std::vector<Candidate> accepted;
  std::vector<PictureEvidence> pictures;
  int checks = 0;  // that were made
  int attempts = 1;
  std::chrono::nanoseconds time{0};
  std::uint64_t peak_bytes = 0;
  std::map<std::string, std::uint64_t> counters;
  std::string said;           // the end of what it wrote to stdout and stderr, where it did not pass
  std::string rerun, accept;  // the commands that run this case alone, and that record its goldens
  bool images_read = false;   // it opened the image module
};

// All of it, and back: how a result leaves the process in which the case ran.
Json case_to_json(const CaseResult&);
CaseResult case_from_json(const Json&);

// {"pass": n, "fail": n, ..., "cases": [...]}, as --json prints it.
Json to_json(const std::vector<CaseResult>&);
std::string to_text(const CaseResult&, bool color);
// "3 pass, 1 fails (of 4), 1.2 s"
std::string summary_text(const std::vector<CaseResult>&);
// JUnit XML, one test suite per suite file: fail is a failure, crash and timeout are errors, skip and waived
// are skipped.
std::string junit_text(const std::vector<CaseResult>&);

}  // namespace frustum
