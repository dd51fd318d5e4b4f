// A finished sweep as files and as text.
#pragma once

#include "runtime/app/sweep/plot.h"
#include "runtime/app/sweep/sweep.h"

#include <string>

namespace frustum {

Json to_json(const Sweep&);
std::string sweep_csv(const Sweep&);  // RFC 4180, one row a point
std::string sweep_html(
    const Sweep&);  // one page that needs no other file; pictures are taken from the sweep's folder
std::string sweep_text(const Sweep&, std::size_t steps);  // slopes and the best `steps` buys, for a terminal

// Error against time of all points, both logarithmic: a series a knob, and the Pareto front.
Plot error_plot(const Sweep&);

// sweep.json, sweep.csv and sweep.html below the sweep's folder; their paths.
std::vector<std::string> write_sweep(const Sweep&);

// "samples 16 -> 64", or the settings of a point of a grid.
std::string name_of(const Sweep&, const SweepPoint&);

}  // namespace frustum
