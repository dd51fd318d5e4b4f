// What a sweep's numbers say: slopes, the Pareto front, the best buys.
#pragma once

#include "runtime/app/sweep/sweep.h"

#include <span>
#include <utility>

namespace frustum {

// Nothing with fewer than 3 pairs, or where all x are one. Pairs that are not positive and finite are left
// out.
std::optional<SlopeFit> fit_slope(std::span<const std::pair<double, double>> x_and_error);

// Fills fits, steps and the points' pareto.
void analyse(Sweep&);

// A fitted slope agrees with its theory if it is no further from it than this: what the powers left out of the theory
// (the next term of the error, the exact value's own error) bend a line of some five points by.
inline constexpr double slope_tolerance = 0.15;

// Below this share of explained variance a line says nothing: its slope is not shown.
inline constexpr double least_r2 = 0.8;

// Whether the slope over values is the one that theory expects; nothing where there is no theory or no fit.
std::optional<bool> agrees_with_theory(const KnobFit&, const SweepKnob&);

// A setting as a number: JSON numbers; nothing for the rest.
std::optional<double> number_of_setting(const std::string& value);

}  // namespace frustum
