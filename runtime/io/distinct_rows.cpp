#include "runtime/io/distinct_rows.h"

#include <tbb/parallel_sort.h>

#include <cstring>
#include <numeric>
#include <utility>

namespace frustum {

DistinctRows distinct_rows(const Column& column, Context& ctx) {
  const auto* data = static_cast<const char*>(column.data());
  const std::size_t width = static_cast<std::size_t>(column.width()) * bytes_of(column.kind()),
                    count = column.rows();
  const auto order = [&](std::uint32_t a, std::uint32_t b) {
    return std::memcmp(data + width * a, data + width * b, width);
  };
  ctx.claim(3 * sizeof(std::uint32_t) * count);
  std::vector<std::uint32_t> sorted(count), first(count);
  std::iota(sorted.begin(), sorted.end(), 0u);
  tbb::parallel_sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    const int d = order(a, b);
    return d != 0 ? d < 0 : a < b;
  });
  ctx.poll();
  for (std::size_t i = 0; i < count; ++i)
    first[sorted[i]] = i > 0 && order(sorted[i - 1], sorted[i]) == 0 ? first[sorted[i - 1]] : sorted[i];
  DistinctRows out;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (first[i] == i) {
      first[i] = static_cast<std::uint32_t>(out.rows.size());
      out.rows.push_back(i);
    } else {
      first[i] = first[first[i]];  // stands before this row, and is an index by now
    }
  }
  out.index = std::move(first);
  return out;
}

}  // namespace frustum
