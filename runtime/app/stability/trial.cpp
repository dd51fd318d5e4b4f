#include "runtime/app/stability/trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace frustum::stability {
namespace {

std::uint64_t seed_of(std::string_view id) {  // FNV-1a
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : id) hash = (hash ^ static_cast<std::uint8_t>(c)) * 1099511628211ULL;
  return hash;
}

using Clock = std::chrono::steady_clock;

double time_ns(const std::function<void()>& body, int repeats) {
  const auto start = Clock::now();
  for (int i = 0; i < repeats; ++i) body();
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count() / repeats;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double Random::magnitude(int lowest, int highest) {
  const auto exponents = static_cast<std::size_t>(highest - lowest);
  const int exponent = lowest + static_cast<int>(below(exponents > 0 ? exponents : 1));
  const double m = std::ldexp(uniform(1, 2), exponent);
  return (engine_() & 1) != 0 ? m : -m;
}

void Errors::take(double error, std::initializer_list<double> input) {
  if (!(error == error)) error = std::numeric_limits<double>::infinity();
  if (samples++ == 0 || error > worst) worst = error, witness = input;
}

Trial::Trial(std::string_view id, bool full, bool timed) : random(seed_of(id)), full_(full), timed_(timed) {}

void Trial::measure(double naive_error, double robust_error, std::initializer_list<double> input) {
  naive.take(naive_error, input);
  robust.take(robust_error, input);
}

void Trial::tally(bool naive_wrong, bool robust_wrong, std::initializer_list<double> input) {
  const auto count = [&](Errors& errors, bool wrong) {
    if (wrong && errors.worst == 0) errors.witness = input;
    errors.worst += wrong ? 1 : 0;
    ++errors.samples;
  };
  count(naive, naive_wrong);
  count(robust, robust_wrong);
}

void Trial::require(bool holds, std::string_view what, std::initializer_list<double> input) {
  if (holds) return;
  const auto known = [&](const auto& b) { return b.first == what; };
  if (std::none_of(broken.begin(), broken.end(), known)) broken.emplace_back(what, input);
}

// Rounds of at least 100 us each, naive and robust in turn, so that a change of the clock or another process
// meets both.
void Trial::price(const std::function<void()>& naive_method, const std::function<void()>& robust_method) {
  if (!timed_) return;
  constexpr double round_ns = 100e3;
  const int rounds = full_ ? 41 : 11;
  time_ns(naive_method, 1), time_ns(robust_method, 1);
  const double once = std::max(1.0, time_ns(naive_method, 1) + time_ns(robust_method, 1));
  const int repeats = static_cast<int>(std::clamp(round_ns / once, 1.0, 1e4));
  std::vector<double> ratios, of_naive, of_robust;
  for (int i = 0; i < rounds; ++i) {
    of_naive.push_back(time_ns(naive_method, repeats));
    of_robust.push_back(time_ns(robust_method, repeats));
    ratios.push_back(of_robust.back() / of_naive.back());
  }
  paid = Price{median(ratios), median(of_naive), median(of_robust)};
}

}  // namespace frustum::stability
