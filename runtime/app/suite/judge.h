// Runs one case in this process and judges it.
#pragma once

#include "runtime/app/golden.h"
#include "runtime/app/session.h"
#include "runtime/app/suite/result.h"
#include "runtime/app/suite/suite.h"

#include <string>

namespace frustum {

enum class Goldens : std::uint8_t { compare, propose };  // proposed ones are then recorded or only shown

struct JudgeOptions {
  Goldens goldens = Goldens::compare;
  std::string staging;           // folder for the numbers of proposed goldens; empty: none are written
  std::string evidence;          // folder for pictures; empty: none are written
  std::string evidence_name;     // that the file names of this case begin with
  bool evidence_of_all = false;  // of checks that held too
  int threads = 1;
  const CancelFlag* cancel = nullptr;
};

// CaseVerdict pass, fail, or crash where the world failed; `result` has its names already. Throws Cancelled.
// Nothing else.
void judge_case(Session&, const SuiteCase&, const GoldenBook&, const JudgeOptions&, CaseResult& result);

}  // namespace frustum
