// A run that is part of a longer task, such as one setting of a sweep, and did not come to its end.
#pragma once

#include "runtime/core/error.h"
#include "runtime/graph/run.h"

#include <stdexcept>
#include <utility>

namespace frustum {

// Holds what the run said, warnings too, each at its place.
struct RunFailure : std::runtime_error {
  RunResult result;  // without its buffers
  explicit RunFailure(RunResult r) : std::runtime_error("the run failed"), result(std::move(r)) {
    result.buffers.clear();
  }
};

// The result of a run that is done. Throws Cancelled and RunFailure for one that is not.
inline RunResult finished(RunResult r) {
  if (r.end == RunResult::End::cancelled) throw Cancelled();
  if (r.end != RunResult::End::done) throw RunFailure(std::move(r));
  return r;
}

}  // namespace frustum
