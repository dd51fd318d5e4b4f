// What is stated of one buffer alone: entries of its summary, numbers at a place, statistics, laws, closed
// forms.
#pragma once

#include "runtime/app/suite/likeness.h"

namespace frustum {

// Each gives one outcome per thing stated. Throws NodeError for a buffer that has no such thing.
std::vector<Judged> judge_shape(const std::string& expected_json, const Buffer&);
std::vector<Judged> judge_probe(const Probe&, const Buffer&);
std::vector<Judged> judge_statistics(const std::vector<Statistic>&, const Buffer&);
std::vector<Judged> judge_invariant(const Invariant&, const Buffer&, const Buffer* other);
// The names in the expressions are planes, or columns ("position.x", "height"); besides, x and y are the
// centre of the pixel, u and v its place in the window from 0 to 1, width and height the window's size, row
// the number of the row.
std::vector<Judged> judge_analytic(const Analytic&, const Buffer&);

}  // namespace frustum
