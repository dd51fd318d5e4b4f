// The same work on another number of threads, more than there are processors if need be.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace frustum::hard {

template <class Body>
void on_threads(int threads, const Body& body) {
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
  tbb::task_arena(threads).execute(body);
}

}  // namespace frustum::hard
