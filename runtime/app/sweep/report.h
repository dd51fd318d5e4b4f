// A finished sweep as files and as text.
#pragma once

#include "runtime/app/sweep/plot.h"
#include "runtime/app/sweep/sweep.h"

#include <string>

namespace frustum {

Json to_json(const Sweep&);
std::string sweep_csv(const Sweep&);  // RFC 4180, one row a point
// One page that needs no other file; pictures are taken from the sweep's folder. The time that making it takes is
// added to the costs that it states.
std::string sweep_html(Sweep&);
std::string sweep_text(const Sweep&, std::size_t steps);  // slopes and the best `steps` buys, for a terminal

// Error against time of all points, both logarithmic: a series a knob, and the Pareto front.
Plot error_plot(const Sweep&);

// sweep.json, sweep.csv and sweep.html below the sweep's folder; their paths. Adds costs.report to the sweep.
std::vector<std::string> write_sweep(Sweep&);

// "41.2 s: 38.9 s in runs (...), measuring overhead 3.1 % (...)".
std::string costs_text(const SweepCosts&);

// "within 0.15 of theory" or "outside"; empty where theory says nothing or nothing could be fitted.
std::string theory_text(const KnobFit&, const SweepKnob&);

// "samples 16 -> 64", or the settings of a point of a grid.
std::string name_of(const Sweep&, const SweepPoint&);

}  // namespace frustum
