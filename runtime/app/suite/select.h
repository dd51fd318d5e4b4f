// Which cases of a suite are run.
#pragma once

#include "runtime/app/suite/suite.h"

#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// `*` stands for any characters, `?` for one; everything else for itself. Linear in the product of the
// lengths at worst.
bool glob_matches(std::string_view pattern, std::string_view text);

// A filter is a glob over the whole id or a whole tag; over the id it may also end before a `/` or `[`, so
// that "teapot" takes in "teapot[samples=4]". One that begins with `!` leaves out what it matches. A case is
// chosen where some filter without `!` matches, or there is none, and no filter with `!` does.
bool chosen(const SuiteCase&, const std::vector<std::string>& filters);

// Part `index` of `count`, from 1.
struct Shard {
  int index = 1, count = 1;
};
// The part in which a case lies depends on its id and the suite's name alone, so adding a case moves no
// other. Together the parts hold every case once.
bool in_shard(const Shard&, std::string_view suite, std::string_view id);

}  // namespace frustum
