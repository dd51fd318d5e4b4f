// Suites over nodes made for testing the judge: pictures and meshes with known numbers, and nodes that
// crash, hang or fail only the first time.
#pragma once

#include "runtime/app/suite/run.h"
#include "tests/support/temp_file.h"

#include <string>
#include <vector>

namespace frustum::test {

//   test.image  size, planes ("RGB"), add, times, shift, nan: plane p at x,y is
//               (x + 2 y) / 64 + p / 8, moved, scaled and added to; plane "I" is the id x + 2 y
//   test.copy   its image
//   test.mesh   a tetrahedron that looks outward; open, inside_out, flipped (one face), doubled (one face twice), normal
//               (the length of normals; 0: none), scale
//   test.matrix the identity, its first column times `scale`
//   test.table  columns "n" 0 1 2 ... and "square", of `rows`
//   test.act    image of one pixel, after it did `what`: "nothing", "crash", "exit", "hang", "throw", "say",
//               or "flaky": throws unless `file` exists, and makes it
Registry suite_nodes();

// A folder with suites/, golden/ and graphs in it.
class SuiteFolder {
 public:
  SuiteFolder();
  const TempFolder& files() const { return folder_; }
  std::string suites() const { return folder_.file("suites"); }

  // suites/NAME: a graph with one node "made" whose output is "out".
  void graph(const std::string& name, const std::string& type, const std::string& params = "{}") const;
  // Writes suites/s.json; `cases` is the list without brackets. Throws std::runtime_error with its
  // diagnostics.
  Suite suite(const std::string& cases) const;
  std::vector<CaseResult> run(const std::string& cases, const SuiteOptions& options) const;
  std::vector<CaseResult> run(const std::string& cases) const;  // in this process
  // One case over graph `params` of test.image with the checks given.
  CaseResult check(const std::string& params, const std::string& checks) const;
  // Proposes and records the goldens of `cases`.
  std::vector<CaseResult> accept(const std::string& cases, const std::string& reason = "a test") const;

 private:
  TempFolder folder_;
};

// Where this process has threads already (other tests ran in it), runs the current test in a fresh one,
// reports how that ended and gives true: there is nothing more to do here.
bool done_in_a_fresh_process();

}  // namespace frustum::test
