// Whether a buffer counts as the same as another.
#pragma once

#include "runtime/app/suite/result.h"
#include "runtime/app/suite/values.h"

#include <string>
#include <vector>

namespace frustum {

// One bound and how it went.
struct Judged {
  CheckOutcome outcome;  // without its port
  std::string sentence;  // where it was not held: "rmse 0.02 is above 0.01 (R at 3,4: 0.5 and 0.1)"
};

// Judges every bound that is given; pixels of the same kind. NaN on either side fails all of them. Throws
// NodeError("metric_without_picture") where a bound is about colours and there are none.
std::vector<Judged> judge_pixels(const Likeness&, const Raster& mine, const Raster& reference);
// The same for the numbers of anything else; metrics of pictures do not hold.
std::vector<Judged> judge_values(const Likeness&, const Values& mine, const Values& reference);

// {"columns", "rows"}: the numbers as a table, columns of one series beside each other.
Json table_of(const Values&);

// Exact text forms of values, for goldens that are no pixels: {"series": [{"name", "kind", "width",
// "values"}]}.
Json to_json(const Values&);
Values values_from_json(const Json&);

}  // namespace frustum
