// The results of suites as one HTML page that needs nothing else.
#pragma once

#include "runtime/app/suite/result.h"

#include <string>
#include <vector>

namespace frustum {

struct PageOptions {
  std::string evidence;                   // folder of the pictures that the results name
  std::string date;                       // "2026-11-22"
  std::uint64_t most_values = 1'000'000;  // numbers of one picture; larger ones are thinned
};

// Every text is data in it and none is markup. Throws WorldError where a picture cannot be read.
std::string suite_page(const std::vector<CaseResult>& results, const PageOptions& options);

}  // namespace frustum
