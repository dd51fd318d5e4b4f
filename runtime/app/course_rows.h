// What the course names: 143 systems, algorithms and formulas, numbered through its eight sections.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace frustum {

struct CourseSection {
  std::string_view number, title;      // "1.2", "Affine transformations, ..."
  int first = 0;                       // number of its first row
  std::vector<std::string_view> rows;  // row `first + i` is rows[i]
};

const std::vector<CourseSection>& course_sections();

}  // namespace frustum
