// Colours as CIE L*a*b*, and how different two of them look: CIEDE2000.
#pragma once

#include <glm/vec3.hpp>

namespace frustum {

// CIE XYZ of linear Rec.709 light; (1, 1, 1) is the D65 white (0.95047, 1, 1.08883).
glm::dvec3 xyz_of_rec709(const glm::dvec3& linear);
glm::dvec3 rec709_of_xyz(const glm::dvec3& xyz);

// (L*, a*, b*) relative to the D65 white: L* in [0, 100] for Y in [0, 1]. CIE 15:2004.
glm::dvec3 lab_of_xyz(const glm::dvec3& xyz);

// The CIEDE2000 difference of two L*a*b* colours with kL = kC = kH = 1: 0 for the same colour, about 1 where
// a trained eye just sees it. Symmetric, except for hues exactly opposite each other. Accurate to 1e-4 of the
// 34 pairs of Sharma, Wu and Dalal, "The CIEDE2000 color-difference formula: implementation notes,
// supplementary test data, and mathematical observations", Color Res. Appl. 30 (2005), whose equations 2 to
// 22 it follows.
double delta_e_2000(const glm::dvec3& lab1, const glm::dvec3& lab2);

}  // namespace frustum
