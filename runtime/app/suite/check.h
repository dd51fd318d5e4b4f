// What has to hold of one port of a run, as a suite states it.
#pragma once

#include "runtime/app/metrics/metrics.h"
#include "runtime/core/context.h"
#include "runtime/graph/load.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace frustum {

// How far two numbers may be apart: close enough by any one of those given. None given: equal.
struct Closeness {
  std::optional<double> abs;  // |a - b|
  std::optional<double> rel;  // |a - b| / |b|, b being what is expected
  std::optional<double>
      ulp;  // representable numbers from one to the other, in the kind in which they are stored
  bool given() const { return abs || rel || ulp; }
  bool above_zero() const { return abs.value_or(0) > 0 || rel.value_or(0) > 0 || ulp.value_or(0) > 0; }
};

// When a buffer counts as the same as another. None given: bit for bit.
struct Likeness {
  bool exact = false;
  Closeness close;
  double fraction = 1;                                  // share of the values for which `close` has to hold
  std::optional<std::pair<double, double>> percentile;  // of |a - b|: which (0 to 100), and what it may be
  std::vector<MetricBound> metrics;
  bool bounded() const { return close.given() || percentile || !metrics.empty(); }
};

// Another run to compare with.
struct OtherRun {
  std::string graph;  // path; empty: the case's own, with the case's settings before these
  std::string port;   // empty: the check's own
  std::vector<Setting> settings;
  std::optional<Precision> precision;
};

// What the other run's buffer has to be, made from this run's.
struct Relation {
  enum class Kind : std::uint8_t { same, mirror_x, mirror_y, rotate_180, shift, times, matrix };
  Kind kind = Kind::same;
  glm::ivec2 shift{0};   // pixels to the right and down; compared where both have pixels
  double times = 1;      // every real number but alpha
  glm::dmat4 matrix{1};  // of positions in object or world space
};

struct Metamorphic {
  OtherRun run;
  Relation relation;
};

// Numbers at one place of a buffer, or at all of a region.
struct Probe {
  enum class At : std::uint8_t { pixel, region, row };
  At at = At::pixel;
  std::array<int, 4> region{};                       // x, y, width, height; a pixel is 1 x 1
  std::optional<int> sample;                         // all, if left out
  std::size_t row = 0;                               // of a column or of a table
  std::string series;                                // plane or column; empty: the first
  std::vector<double> equals;                        // one number for all, or one for each of a row's
  std::optional<std::pair<double, double>> between;  // instead of `equals`
  Closeness close;
};

// A statistic of a plane or column and the interval in which it has to lie, ends included.
struct Statistic {
  std::string series;  // empty: all together
  std::string name;    // min max mean deviation sum count, or p0 to p100
  double low = 0, high = 0;
};

// A law that a kind of buffer obeys, by name.
struct Invariant {
  std::string name;
  std::string of;  // the other port, where the law is about two
  double tolerance = 0;
};

// `value` is `equals` wherever `where` holds, both expressions over a pixel's planes or a row's columns.
struct Analytic {
  std::string value, equals, where;
  Closeness close;
};

struct SuiteCheck {
  std::string port;
  std::string pointer;  // of the check in its suite, for messages

  bool golden = false;  // like what was accepted
  bool trace = false;   // and the digests of all ports on the way are kept, to name the first that differs
  std::optional<OtherRun> same_as;
  std::optional<Metamorphic> metamorphic;
  Likeness likeness;

  std::string shape;  // JSON object: entries of the summary; empty: not asked
  std::optional<Probe> probe;
  std::vector<Statistic> statistics;
  std::optional<Invariant> invariant;
  std::optional<Analytic> analytic;
  std::string why;  // of a tolerance above zero
};

}  // namespace frustum
