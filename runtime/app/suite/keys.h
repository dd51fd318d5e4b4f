// The keys of a suite file, declared once: what the reader takes and what the schema says.
#pragma once

#include "runtime/core/context.h"
#include "runtime/core/param.h"

#include <glm/vec2.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace frustum {

// Any JSON, kept as text: what has more forms than one C++ type. The reader looks into it by hand.
struct JsonText {
  std::string text;
  bool given() const { return !text.empty(); }
};
template <>
const ParamType& param_type<JsonText>();

namespace suite_keys {

struct Percentile {
  double p = 100, at_most = 0;
};
struct Probe {
  std::optional<glm::ivec2> pixel;
  std::optional<std::array<int, 4>> region;
  std::optional<std::int64_t> row;
  std::optional<int> sample;
  std::string plane, column;
  JsonText equals;
  std::optional<std::array<double, 2>> between;
  std::optional<double> abs, rel, ulp;
};
struct Invariant {
  std::string name, of;
  double tolerance = 0;
};
struct Analytic {
  std::string value, equals, where;
  std::optional<double> abs, rel, ulp;
};
struct OtherRun {
  std::string graph, port;
  JsonText set;
  std::optional<Precision> precision;
};
struct Metamorphic {
  JsonText set, expect;
  std::optional<Precision> precision;
};
struct Relation {
  std::optional<glm::ivec2> shift;
  std::optional<double> times;
  std::optional<glm::dmat4> matrix;
};
struct Check {
  std::string port, why;
  bool golden = false, trace = false;
  JsonText same_as;
  std::optional<Metamorphic> metamorphic;
  bool exact = false;
  std::optional<double> abs, rel, ulp;
  double fraction = 1;
  std::optional<Percentile> percentile;
  std::optional<double> max, rmse, mrse, psnr, ssim, flip, delta_e_2000, delta_e_2000_max, wrong_ids;
  JsonText shape, statistics, invariant;
  std::optional<Probe> probe;
  std::optional<Analytic> analytic;
};
struct Expect {
  std::string code, pointer, suggestion;
  int line = 0, column = 0;
};
struct Budget {
  JsonText bytes, counters;
  std::optional<double> time;
};
struct Waiver {
  std::string until, why;
};
struct Case {
  std::string id, graph, skip;
  std::vector<std::string> use, tags;
  JsonText set, matrix, checks, expect;
  std::optional<Precision> precision;
  Budget budget;
  std::optional<Waiver> waiver;
  std::optional<double> timeout;
  int retry = 0;
};
struct Preset {
  JsonText set, matrix;
};

void describe(Fields<Percentile>&);
void describe(Fields<Probe>&);
void describe(Fields<Invariant>&);
void describe(Fields<Analytic>&);
void describe(Fields<OtherRun>&);
void describe(Fields<Metamorphic>&);
void describe(Fields<Relation>&);
void describe(Fields<Check>&);
void describe(Fields<Expect>&);
void describe(Fields<Budget>&);
void describe(Fields<Waiver>&);
void describe(Fields<Case>&);
void describe(Fields<Preset>&);

// The metrics that a check may bound, by the names of metrics/metrics.h, and where their bounds lie.
struct MetricKey {
  const char* metric;
  std::optional<double> Check::*bound;
};
extern const std::array<MetricKey, 9> metric_keys;

}  // namespace suite_keys
}  // namespace frustum
