// What a node may ask of the run it is part of.
#pragma once

#include "runtime/core/effect.h"
#include "runtime/core/error.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum {

enum class Precision : std::uint8_t { single, real_double };
constexpr auto choices(Precision) {
  return std::array{std::pair{Precision::single, "single"}, std::pair{Precision::real_double, "double"}};
}

// Set from a signal handler or another thread; everything that takes time polls it.
class CancelFlag {
 public:
  void cancel() { flag_.store(true, std::memory_order_relaxed); }
  bool cancelled() const { return flag_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> flag_{false};
};

class Context {
 public:
  Precision precision = Precision::single;  // the Real in which the node computes and stores new real columns
  std::uint64_t seed = 0;  // for counter-based random numbers, with pixel, sample and dimension
  const CancelFlag* cancel = nullptr;
  std::uint64_t wanted_outputs = ~std::uint64_t{0};  // bit i: somebody reads the i-th declared output

  const EffectPolicy* effects = nullptr;  // null: what the scene calls for, and no more

  // Throws Cancelled. Geometry loops call it about once a millisecond of work.
  void poll() const {
    if (cancel != nullptr && cancel->cancelled()) throw Cancelled();
  }

  // Calls body.operator()<float>() or <double>(): the one place where a node meets the precision.
  template <class Body>
  decltype(auto) real(Body&& body) const {
    return precision == Precision::single ? body.template operator()<float>()
                                          : body.template operator()<double>();
  }

  // Announces memory of run() or prepare() that no buffer counts, before it is taken; of prepare() it is counted as live
  // until the prepared node is no longer needed. Throws NodeError("memory") where it would pass the run's limit.
  void claim(std::uint64_t bytes) {
    claimed_ += bytes;
    if (admit) admit(claimed_);
  }
  std::uint64_t claimed() const { return claimed_; }
  std::function<void(std::uint64_t all)> admit = {};  // by the runtime; empty: nothing is refused

  bool wants(std::size_t output) const { return output >= 64 || ((wanted_outputs >> output) & 1) != 0; }

  // Deterministic work counters, summed over the run and shown in the trace: "triangles_clipped". Not for inner loops.
  void count(std::string_view counter, std::uint64_t n) { counters_.emplace_back(counter, n); }
  // A sentence for the user about this run of the node: "12 faces with NaN positions were dropped".
  void warn(std::string code, std::string message) {
    warnings_.emplace_back(std::move(code), std::move(message));
  }

  // Whether run() or prepare() simulates an effect that its node type declares: where the inputs call for it, or it is
  // forced. An effect that was not decided (a run() called by itself) is simulated.
  bool simulates(std::string_view effect) const {
    if (forces(effect)) return true;
    for (const auto& [name, verdict] : verdicts_)
      if (name == effect) return verdict.kind == Verdict::Kind::on;
    return true;
  }
  bool forces(std::string_view effect) const { return effects != nullptr && effects->forces(effect); }
  // By the runtime, before run() or prepare().
  void decide(std::string_view effect, Verdict verdict) {
    if (effects != nullptr && effects->skips(effect)) verdict = off_user("it was asked to be skipped");
    verdicts_.emplace_back(effect, std::move(verdict));
  }
  const std::vector<std::pair<std::string, Verdict>>& verdicts() const { return verdicts_; }

  const std::vector<std::pair<std::string, std::uint64_t>>& counters() const { return counters_; }
  const std::vector<std::pair<std::string, std::string>>& warnings() const { return warnings_; }

 private:
  std::uint64_t claimed_ = 0;
  std::vector<std::pair<std::string, std::uint64_t>> counters_;
  std::vector<std::pair<std::string, std::string>> warnings_;
  std::vector<std::pair<std::string, Verdict>> verdicts_;
};

}  // namespace frustum
