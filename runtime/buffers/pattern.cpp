#include "runtime/buffers/pattern.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"

#include <nlohmann/json.hpp>

namespace frustum {
namespace {

struct Ops {
  static std::size_t bytes(const SamplePattern& p) {
    return sizeof p + (p.x.size() + p.y.size()) * sizeof p.x[0];
  }
  static void hash(const SamplePattern& p, Hasher& h) {
    h.value(p.samples).value(p.period).span<std::uint16_t>(p.x).span<std::uint16_t>(p.y);
  }
  static void save(const SamplePattern& p, ArchiveWriter& w) {
    w.value(p.samples).value(p.period).span<std::uint16_t>(p.x).span<std::uint16_t>(p.y);
  }
  static SamplePattern load(ArchiveReader& r) {
    SamplePattern p;
    p.samples = r.value<int>();
    p.period = r.value<int>();
    p.x = r.vector<std::uint16_t>();
    p.y = r.vector<std::uint16_t>();
    const bool sane = p.samples > 0 && p.period > 0 && p.period <= 4096 && (p.period & (p.period - 1)) == 0;
    const std::size_t n = sane ? p.index(p.samples - 1, p.period - 1, p.period - 1) + 1 : 0;
    if (!sane || p.x.size() != n || p.y.size() != n) throw ArchiveError("no such pattern");
    return p;
  }
  static Health health(const SamplePattern& p) { return {.values = p.x.size() + p.y.size()}; }
  static Json summary(const SamplePattern& p) { return {{"samples", p.samples}, {"period_px", p.period}}; }
  // One row a sample of the repeating block, in pixels.
  static Json table(const SamplePattern& p, std::size_t first, std::size_t count) {
    const auto period = static_cast<std::size_t>(p.period);
    return json_table(
        {"sample", "pixel x", "pixel y", "offset x", "offset y"}, p.x.size(), first, count,
        [&](std::size_t i) {
          return Json{i / period / period, i % period, i / period % period, p.x[i] / 4096.0, p.y[i] / 4096.0};
        });
  }
};

}  // namespace

template <>
const BufferType& buffer_type<SamplePattern>() {
  static const BufferType type = make_buffer_type<SamplePattern, Ops>(
      "sample_pattern", "Where the samples of each pixel lie.", "#b58bb0");
  return type;
}

}  // namespace frustum
