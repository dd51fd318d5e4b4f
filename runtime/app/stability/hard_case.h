// A hard case of numerics as a value: what is fed, the textbook method that fails on it, the kernel or node
// of this repository that does not, an exact oracle, and a criterion fixed before anything was measured.
// The cases themselves stand in tests/hard, one file a stage; adding one there edits nothing here.
#pragma once

#include "runtime/app/stability/trial.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::stability {

struct HardCase {
  std::string_view id;         // of the catalogue
  std::string_view input;      // what both methods are given
  std::string_view naive;      // the textbook method
  std::string_view robust;     // the kernel or node that is judged
  std::string_view oracle;     // what is exact, and shares no code with either
  std::string_view criterion;  // in words; `bound` and the requirements of run() are what is checked
  std::string_view unit;       // of both errors and the bound
  double bound = 0;            // the robust error stays at or below it, the naive error does not
  void (*run)(Trial&) = nullptr;
};

// A case whose criterion cannot be met as it was fixed. It may still have a run, which shows by how much; the
// argument in full has a section of its id in docs/decisions/0003-hard-cases.md.
struct ArguedCase {
  std::string_view id, why;
};

// One row of the catalogue: every hard case that is known, whether or not its stage is built.
struct CatalogueRow {
  std::string_view id, stage, title;
  bool gate;                    // belongs to the quick gate
  std::string_view needs = {};  // not built yet: what it waits for; empty where a case or an argument exists
};

// A picture of the page: what it shows, and how it is drawn into a file of that name.
struct Illustration {
  std::string_view file;  // .png or .svg
  std::string_view caption;
  void (*draw)(const std::string& path) = nullptr;
};

struct HardCases {
  std::span<const CatalogueRow> catalogue;
  std::vector<HardCase> cases;
  std::vector<ArguedCase> argued;
  std::vector<Illustration> pictures;
};

// All of them, in the catalogue's order. Defined by tests/hard, which both the program and the tests link.
const HardCases& hard_cases();

}  // namespace frustum::stability
