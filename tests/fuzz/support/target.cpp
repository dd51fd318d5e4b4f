#include "tests/fuzz/support/target.h"

#include <algorithm>

namespace frustum::fuzz {
namespace {

std::vector<Target>& list() {
  static std::vector<Target> all;
  return all;
}

}  // namespace

const std::vector<Target>& targets() { return list(); }

Registered::Registered(const Target& target) {
  const auto by_name = [](const Target& a, const Target& b) { return a.name < b.name; };
  list().insert(std::upper_bound(list().begin(), list().end(), target, by_name), target);
}

}  // namespace frustum::fuzz
