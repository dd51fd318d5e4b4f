#include "runtime/app/suite/likeness.h"

#include "runtime/buffers/numbers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace frustum {
namespace {

std::string shown(const Difference& d) {
  if (!d.worst) return "";
  return fmt::format(" ({}: {:.9g}, expected {:.9g})", d.worst->place(), d.worst->a, d.worst->b);
}

Judged judged(std::string check, bool held, std::string measured, std::string bound,
              const std::string& where = "") {
  Judged j{{"", std::move(check), std::move(measured), std::move(bound), held}, ""};
  if (!held)
    j.sentence =
        fmt::format("{} {}, expected {}{}", j.outcome.check, j.outcome.measured, j.outcome.bound, where);
  return j;
}

void judge_metrics(const Likeness& l, const Measured& m, std::vector<Judged>& out) {
  const auto broken_ones = broken(m, l.metrics);
  for (const MetricBound& b : l.metrics) {
    const bool held = std::none_of(broken_ones.begin(), broken_ones.end(),
                                   [&](const MetricBound& x) { return x.metric == b.metric; });
    const Metric& metric = *find_metric(b.metric);
    std::string measured = fmt::format("{:.6g}", m.values.at(b.metric));
    if (!held && m.difference.wrong_ids != 0 && b.metric != "wrong_ids")
      measured += fmt::format(" with {} wrong ids", m.difference.wrong_ids);
    out.push_back(judged(b.metric, held, measured,
                         fmt::format("{} {:g}", metric.at_least ? "at least" : "at most", b.tolerance),
                         shown(m.difference)));
  }
}

std::vector<std::string> names_of(const std::vector<MetricBound>& bounds) {
  std::vector<std::string> names;
  for (const MetricBound& b : bounds) names.push_back(b.metric);
  return names;
}

std::string shown(const Closeness& c) {
  std::string out;
  const auto add = [&](const char* name, const std::optional<double>& v) {
    if (v) out += fmt::format("{}{} {:g}", out.empty() ? "" : " or ", name, *v);
  };
  add("abs", c.abs), add("rel", c.rel), add("ulp", c.ulp);
  return out;
}

bool same_shape(const Values& a, const Values& b) {
  return std::equal(a.series.begin(), a.series.end(), b.series.begin(), b.series.end(),
                    [](const Series& x, const Series& y) {
                      return x.name == y.name && x.width == y.width && x.values.size() == y.values.size();
                    });
}

// Every number against its counterpart in the series of that name: how many are close, and how far each is
// away.
void judge_numbers(const Likeness& l, const Values& mine, const Values& reference, std::vector<Judged>& out) {
  if (!l.close.given() && !l.percentile) return;
  std::vector<double> distances;
  std::size_t far = 0, all = 0;
  double worst = -1;
  std::string where;
  for (std::size_t k = 0; k < mine.series.size(); ++k) {
    const Series &a = mine.series[k], &b = *reference.find(mine.series[k].name);
    for (std::size_t i = 0; i < a.values.size(); ++i, ++all) {
      const bool nan = std::isnan(a.values[i]) || std::isnan(b.values[i]);
      const double distance = a.values[i] == b.values[i] ? 0
                              : nan                      ? std::numeric_limits<double>::infinity()
                                                         : std::abs(a.values[i] - b.values[i]);
      if (l.percentile) distances.push_back(distance);
      if (nan || (a.values[i] != b.values[i] && !close(a.values[i], b.values[i], l.close, a.kind))) ++far;
      if (distance > worst) {
        worst = distance;
        where = fmt::format(" ({} is {:.9g}, expected {:.9g})", mine.place(a, i), a.values[i], b.values[i]);
      }
    }
  }
  if (l.close.given()) {
    const bool held = static_cast<double>(far) <= (1 - l.fraction) * static_cast<double>(all);
    out.push_back(judged("values", held, fmt::format("{} of {} within", all - far, all),
                         fmt::format("{:g} of them within {}", l.fraction, shown(l.close)), where));
  }
  if (!l.percentile) return;
  const auto [p, most] = *l.percentile;
  double found = 0;
  if (!distances.empty()) {  // the nearest rank
    const auto rank = static_cast<std::size_t>(std::ceil(p / 100 * static_cast<double>(distances.size())));
    const auto nth = distances.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
    std::nth_element(distances.begin(), nth, distances.end());
    found = *nth;
  }
  out.push_back(judged(fmt::format("percentile {:g}", p), found <= most, fmt::format("{:.6g}", found),
                       fmt::format("at most {:g}", most), where));
}

std::vector<Judged> mismatched(const std::string& why) {
  return {{{"", "shape", why, "the same shape", false}, why}};
}

std::vector<Judged> not_finite(std::uint64_t count) {
  const std::string why = fmt::format("{} values are NaN on either side", count);
  return {{{"", "finite", why, "no NaN", false}, why}};
}

}  // namespace

std::vector<Judged> judge_pixels(const Likeness& l, const Raster& mine, const Raster& reference) {
  const auto names = names_of(l.metrics);
  const Measured m = measure(mine, reference, names);
  if (!m.difference.mismatch.empty()) return mismatched(m.difference.mismatch);
  if (m.difference.nan != 0) return not_finite(m.difference.nan);
  std::vector<Judged> out;
  judge_metrics(l, m, out);
  if (l.close.given() || l.percentile) judge_numbers(l, values_of(mine), values_of(reference), out);
  return out;
}

std::vector<Judged> judge_values(const Likeness& l, const Values& mine, const Values& reference) {
  if (!same_shape(mine, reference)) return mismatched("the columns or their lengths differ");
  const Difference d = compare_tables(table_of(mine), table_of(reference));
  if (d.nan != 0) return not_finite(d.nan);
  std::vector<Judged> out;
  judge_metrics(l, measure(d, names_of(l.metrics)), out);
  judge_numbers(l, mine, reference, out);
  return out;
}

Json table_of(const Values& v) {
  Json columns = Json::array(), rows = Json::array();
  std::size_t longest = 0;
  for (const Series& s : v.series) {
    longest = std::max(longest, s.rows());
    for (int k = 0; k < s.width; ++k)
      columns.push_back(s.width == 1 ? s.name : fmt::format("{}.{}", s.name, "xyzw"[k]));
  }
  for (std::size_t row = 0; row < longest; ++row) {
    Json cells = Json::array();
    for (const Series& s : v.series)
      for (std::size_t k = 0; k < static_cast<std::size_t>(s.width); ++k)
        cells.push_back(row < s.rows() ? json_number(s.values[row * static_cast<std::size_t>(s.width) + k])
                                       : Json());
    rows.push_back(std::move(cells));
  }
  return {{"columns", std::move(columns)}, {"rows", std::move(rows)}, {"total", longest}};
}

Json to_json(const Values& v) {
  Json series = Json::array();
  for (const Series& s : v.series) {
    Json values = Json::array();
    for (const double x : s.values)
      values.push_back(s.kind == NumberKind::f32 ? json_number(static_cast<float>(x)) : json_number(x));
    series.push_back(
        {{"name", s.name}, {"kind", name_of(s.kind)}, {"width", s.width}, {"values", std::move(values)}});
  }
  return {{"format", "frustum.values/1"}, {"series", std::move(series)}};
}

Values values_from_json(const Json& json) {
  Values v;
  for (const Json& j : json.at("series")) {
    Series s{j.at("name").get<std::string>(), NumberKind::f64, j.at("width").get<int>(), {}};
    for (const NumberKind kind : {NumberKind::f32, NumberKind::f64, NumberKind::i32, NumberKind::u32})
      if (j.at("kind") == name_of(kind)) s.kind = kind;
    for (const Json& x : j.at("values")) {
      const double value = x.get<double>();
      // The shortest text of a float reads back to it as a float, and to another number as a double.
      s.values.push_back(s.kind == NumberKind::f32 ? static_cast<double>(static_cast<float>(value)) : value);
    }
    v.series.push_back(std::move(s));
  }
  return v;
}

}  // namespace frustum
