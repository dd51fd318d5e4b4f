// One run of a hard case: collects the errors of both methods over many inputs, keeps the worst as witnesses,
// and times the methods against each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum::stability {

// The same numbers for every standard library and machine: its distributions may differ, the engine may not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t bits() { return engine_(); }
  double uniform(double lowest = 0, double highest = 1) {
    return lowest + (highest - lowest) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  // Either sign, magnitude between 2^lowest and 2^highest, evenly on a logarithmic scale up to a binade.
  double magnitude(int lowest, int highest);
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }

 private:
  std::mt19937_64 engine_;
};

// Keeps a result from being optimised away.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "r"(&value) : "memory");
}

// Inputs that gave the largest error, as the numbers they are.
using Witness = std::vector<double>;

// What a method did over all inputs. NaN counts as an infinite error.
struct Errors {
  double worst = 0;
  Witness witness;
  std::size_t samples = 0;

  void take(double error, std::initializer_list<double> input);
};

// How long both methods take for the same work, as the median over interleaved rounds of one run.
struct Price {
  double ratio;     // robust / naive
  double naive_ns;  // for one round of the case's own work
  double robust_ns;
};

class Trial {
 public:
  Trial(std::string_view id, bool full, bool timed);

  Random random;  // seeded by the id

  bool full() const { return full_; }  // asked for many more inputs
  std::size_t samples(std::size_t usual, std::size_t full) const { return full_ ? full : usual; }

  // The errors of both methods at one input, in the case's unit.
  void measure(double naive_error, double robust_error, std::initializer_list<double> input);
  void measure_naive(double error, std::initializer_list<double> input) { naive.take(error, input); }
  void measure_robust(double error, std::initializer_list<double> input) { robust.take(error, input); }
  // For decisions: whether each method got this input wrong. The error is the number of wrong ones.
  void tally(bool naive_wrong, bool robust_wrong, std::initializer_list<double> input);
  // What has to hold besides the bound; the first input where it does not is kept.
  void require(bool holds, std::string_view what, std::initializer_list<double> input = {});

  // Times two functions that do the same work.
  void price(const std::function<void()>& naive_method, const std::function<void()>& robust_method);
  // The same for functions of one input, over all inputs.
  template <class Inputs, class Naive, class Robust>
  void price_over(const Inputs& inputs, Naive&& naive_method, Robust&& robust_method) {
    price(
        [&] {
          for (const auto& x : inputs) keep(naive_method(x));
        },
        [&] {
          for (const auto& x : inputs) keep(robust_method(x));
        });
  }

  Errors naive, robust;
  std::vector<std::pair<std::string, Witness>> broken;  // requirements that did not hold
  std::optional<Price> paid;

 private:
  bool full_, timed_;
};

}  // namespace frustum::stability
