// The entry that libFuzzer calls: reads an input with the one target that is linked in, and weighs what it takes.
#include "tests/fuzz/support/target.h"

#include <fmt/format.h>
#include <sanitizer/allocator_interface.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace {

using frustum::fuzz::Target;

// Bytes that are allocated, and the most there were since the input began.
std::atomic<std::int64_t> live{0}, most{0};

void on_allocation(const volatile void*, std::size_t bytes) {
  const std::int64_t now = live += static_cast<std::int64_t>(bytes);
  if (now > most) most = now;  // one thread allocates at a time: see the limit below
}
void on_release(const volatile void* p) {
  live -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(const_cast<void*>(p)));
}

// Of processor time: a machine that does other things besides makes no findings. libFuzzer's own limit, on the
// clock, is far above and ends what hangs.
constexpr std::clock_t longest = 2 * CLOCKS_PER_SEC;

const Target& target() {
  if (frustum::fuzz::targets().size() != 1) std::abort();
  return frustum::fuzz::targets()[0];
}

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): the names that libFuzzer calls
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  // On one thread an input takes the same path each time, and small ones do not wait for workers.
  static const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  target().read({});  // what is made once is nobody's cost
  __sanitizer_install_malloc_and_free_hooks(on_allocation, on_release);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::int64_t before = live;
  const std::clock_t start = std::clock();
  most = before;
  target().read({reinterpret_cast<const char*>(data), size});
  const auto [base, factor] = target().memory;
  const std::int64_t bytes = most - before, bound = static_cast<std::int64_t>(base + factor * size);
  const std::clock_t time = std::clock() - start;
  if (bytes <= bound && time <= longest) return 0;
  fmt::print(stderr, "an input of {} bytes took {} bytes at once, of {}, and {} s\n", size, bytes, bound,
             static_cast<double>(time) / CLOCKS_PER_SEC);
  std::abort();
}
// NOLINTEND(readability-identifier-naming)
