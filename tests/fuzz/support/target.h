// What is fuzzed: one reader of bytes that a user may hand us, and what has to hold whatever the bytes are.
//
// tests/fuzz/NAME.cpp holds one target. `./dev fuzz` links each with libFuzzer; the tests link them all and read what
// is kept of their inputs, tests/fuzz/corpus/NAME and tests/fuzz/regressions/NAME.
#pragma once

#include <cstddef>
#include <ostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::fuzz {

// What a reader may hold at once: base + factor * (size of its input), in bytes.
struct MemoryBound {
  std::size_t base, factor;
};

struct Target {
  std::string_view name;
  // Reads any bytes. Throws Finding where something did not hold; whatever else leaves it is a finding too.
  void (*read)(std::string_view input);
  MemoryBound memory;
};
inline std::ostream& operator<<(std::ostream& out, const Target& target) { return out << target.name; }

// A claim about the reader that an input has shown to be wrong.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};
inline void require(bool holds, const std::string& claim) {
  if (!holds) throw Finding(claim);
}

// Those that are linked in, by name.
const std::vector<Target>& targets();

// `const Registered ply({"ply", read, {...}});` at namespace scope links a target in.
class Registered {
 public:
  explicit Registered(const Target& target);
};

}  // namespace frustum::fuzz
