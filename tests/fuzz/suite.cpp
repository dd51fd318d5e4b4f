// Suite files.
#include "runtime/app/suite/suite.h"
#include "tests/fuzz/support/check.h"
#include "tests/fuzz/support/target.h"
#include "tests/support/temp_file.h"

namespace frustum::fuzz {
namespace {

void read(std::string_view input) {
  static const test::TempFolder folder;
  static const std::string graph = folder.write("a.json", "{}");
  const std::string file = folder.file("input.json");
  Diagnostics problems;
  const auto suite = load_suite_text(std::string(input), file, problems);
  check_problems(problems, file, input);
  require(suite.has_value() != problems.has_errors(), "a suite and its problems contradict each other");
  if (!suite) return;
  for (const SuiteCase& c : suite->cases)
    require(!c.id.empty() && !c.graph.empty(), "a case has no name or no graph");
}
// A suite may have 100,000 cases, each a copy of what its text says.
const Registered suite({"suite", read, {std::size_t{1} << 29, 8192}});

}  // namespace
}  // namespace frustum::fuzz
