#include "nodes/kernels/parallel.h"

#include <tbb/parallel_for.h>

namespace frustum::kernels {

void parallel_calls(std::size_t n, void (*call)(const void* body, std::size_t k), const void* body) {
  tbb::parallel_for(std::size_t{0}, n, [=](std::size_t k) { call(body, k); });
}

}  // namespace frustum::kernels
