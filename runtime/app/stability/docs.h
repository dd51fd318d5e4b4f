// docs/stability.md and its pictures.
#pragma once

#include "runtime/app/stability/report.h"

#include <string>
#include <vector>

namespace frustum::stability {

// The page: what the catalogue is, how to read it, and a table a stage. The ids and states in it are those of
// `outcomes`; prices are of the machine that wrote it.
std::string stability_page(const HardCases&, const std::vector<Outcome>& outcomes);

// Writes stability.md and images/stability_*.svg and .png into `folder`; files that already say this are not
// touched. Throws WorldError where it cannot.
void write_docs(const HardCases&, const std::vector<Outcome>& outcomes, const std::string& folder);

}  // namespace frustum::stability
