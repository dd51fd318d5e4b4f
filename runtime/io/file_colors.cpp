#include "runtime/io/file_colors.h"

#include "nodes/kernels/transfer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

namespace frustum {

template <class R>
void decode_srgb(Column& color, int most, const Context& ctx) {
  std::vector<R> linear(static_cast<std::size_t>(most) + 1);
  for (std::size_t i = 0; i < linear.size(); ++i)
    linear[i] = static_cast<R>(kernels::decode(kernels::Curve::srgb, static_cast<double>(i) / most));
  const auto width = static_cast<std::size_t>(color.width());
  const R top = static_cast<R>(most);
  R* values = static_cast<R*>(color.data());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, color.rows(), 1 << 14), [&](const auto& range) {
    for (std::size_t i = range.begin() * width; i < range.end() * width; ++i) {
      const R kept = std::clamp(values[i], R{0}, top);
      values[i] = width == 4 && i % 4 == 3 ? kept / top : linear[static_cast<std::size_t>(kept)];
    }
  });
  ctx.poll();
}
template void decode_srgb<float>(Column&, int, const Context&);
template void decode_srgb<double>(Column&, int, const Context&);

}  // namespace frustum
