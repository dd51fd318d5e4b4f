#include "runtime/app/suite/statements.h"

#include "nodes/kernels/sum.h"
#include "runtime/app/suite/invariants.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace frustum {
namespace {

Judged judged(std::string check, bool held, std::string measured, std::string bound) {
  Judged j{{"", std::move(check), std::move(measured), std::move(bound), held}, ""};
  if (!held)
    j.sentence = fmt::format("{} is {}, expected {}", j.outcome.check, j.outcome.measured, j.outcome.bound);
  return j;
}

std::string near_name(const std::string& name, const std::vector<std::string>& known) {
  const auto near = nearest_names(name, known);
  return near.empty() ? fmt::format("; there are {}", fmt::join(known, ", "))
                      : fmt::format("; did you mean '{}'?", near[0]);
}

const Series& series_of(const Values& v, const std::string& name) {
  const Series* s = v.find(name);
  if (s == nullptr)
    throw NodeError("no_series",
                    fmt::format("it has no plane or column '{}'{}", name, near_name(name, v.names())));
  return *s;
}

// ----- probes

// The numbers that a probe looks at, by index into the series.
std::vector<std::size_t> probed(const Probe& p, const Values& v, const Series& s) {
  std::vector<std::size_t> out;
  if (p.at == Probe::At::row) {
    if (p.row >= s.rows())
      throw NodeError("no_such_place", fmt::format("{} has {} rows and no row {}", s.name, s.rows(), p.row));
    for (std::size_t k = 0; k < static_cast<std::size_t>(s.width); ++k)
      out.push_back(p.row * static_cast<std::size_t>(s.width) + k);
    return out;
  }
  if (!v.window) throw NodeError("no_pixels", "a probe of pixels needs pixels; \"row\" is for columns");
  const Rect& w = *v.window;
  const auto [x, y, width, height] = p.region;
  if (x < w.x0 || y < w.y0 || width > w.x1 - x || height > w.y1 - y)
    throw NodeError(
        "no_such_place",
        fmt::format("the pixels from {},{} on, {} x {}, are not all in the window {} x {} at {},{}", x, y,
                    width, height, w.width(), w.height(), w.x0, w.y0));
  if (p.sample.value_or(0) >= v.samples)
    throw NodeError("no_such_place",
                    fmt::format("there are {} samples and no sample {}", v.samples, *p.sample));
  for (int sample = p.sample.value_or(0); sample < (p.sample ? *p.sample + 1 : v.samples); ++sample)
    for (int row = y; row < y + height; ++row)
      for (int column = x; column < x + width; ++column)
        out.push_back((static_cast<std::size_t>(sample) * static_cast<std::size_t>(w.height()) +
                       static_cast<std::size_t>(row - w.y0)) *
                          static_cast<std::size_t>(w.width()) +
                      static_cast<std::size_t>(column - w.x0));
  return out;
}

// ----- statistics

double statistic(const std::string& name, std::vector<double>& values) {
  if (name == "count") return static_cast<double>(values.size());
  if (values.empty())
    throw NodeError("no_numbers", fmt::format("there are no numbers to take the {} of", name));
  // NaN comes through, wherever it stands: comparisons would step over it.
  if (std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); }))
    return std::numeric_limits<double>::quiet_NaN();
  if (name == "min") return *std::min_element(values.begin(), values.end());
  if (name == "max") return *std::max_element(values.begin(), values.end());
  if (name[0] == 'p') {  // the nearest rank
    const double p = std::stod(name.substr(1)) / 100;
    const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(values.size())));
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  }
  kernels::CompensatedSum<double> sum;
  for (const double v : values) sum.add(v);
  if (name == "sum") return sum.value();
  const double mean = sum.value() / static_cast<double>(values.size());
  if (name == "mean") return mean;
  kernels::CompensatedSum<double> squares;
  for (const double v : values) squares.add((v - mean) * (v - mean));
  return std::sqrt(squares.value() / static_cast<double>(values.size()));
}

}  // namespace

std::vector<Judged> judge_shape(const std::string& expected_json, const Buffer& buffer) {
  const Json summary = buffer.type().summary(buffer.data());
  const Json expected = Json::parse(expected_json);
  std::vector<Judged> out;
  for (const auto& [key, value] : expected.items()) {
    const auto found = summary.find(key);
    if (found == summary.end()) {
      std::vector<std::string> known;
      for (const auto& [name, entry] : summary.items()) known.push_back(name);
      throw NodeError("no_entry", fmt::format("its summary has no '{}'{}", key, near_name(key, known)));
    }
    out.push_back(judged(key, *found == value, found->dump(), value.dump()));
  }
  return out;
}

std::vector<Judged> judge_probe(const Probe& p, const Buffer& buffer) {
  const Values v = values_of(buffer);
  const Series& s = series_of(v, p.series);
  const auto indices = probed(p, v, s);
  if (p.equals.size() > 1 && p.equals.size() != indices.size())
    throw NodeError("wrong_length", fmt::format("{} numbers are expected where there are {}", p.equals.size(),
                                                indices.size()));
  std::size_t wrong = 0;
  std::string first, wanted;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const double x = s.values[indices[k]];
    const double expected = p.between ? 0 : p.equals[p.equals.size() == 1 ? 0 : k];
    const bool held = p.between ? x >= p.between->first && x <= p.between->second
                                : x == expected || close(x, expected, p.close, s.kind);
    const bool tell = held ? k == 0 && wrong == 0 : wrong++ == 0;
    if (!tell) continue;
    first = fmt::format("{:.9g} for {}", x, v.place(s, indices[k]));
    wanted = p.between ? fmt::format("{:.9g} to {:.9g}", p.between->first, p.between->second)
                       : fmt::format("{:.9g}", expected);
  }
  if (wrong > 1) first += fmt::format(" and {} more", wrong - 1);
  return {judged("probe", wrong == 0, first, wanted)};
}

std::vector<Judged> judge_statistics(const std::vector<Statistic>& statistics, const Buffer& buffer) {
  const Values v = values_of(buffer);
  std::vector<Judged> out;
  for (const Statistic& s : statistics) {
    std::vector<double> values;
    if (!s.series.empty())
      values = series_of(v, s.series).values;
    else
      for (const Series& each : v.series) values.insert(values.end(), each.values.begin(), each.values.end());
    const double x = statistic(s.name, values);
    out.push_back(judged(
        s.series.empty() ? s.name : s.series + " " + s.name, x >= s.low && x <= s.high,
        fmt::format("{:.9g}", x),
        s.low == s.high ? fmt::format("{:.9g}", s.low) : fmt::format("{:.9g} to {:.9g}", s.low, s.high)));
  }
  return out;
}

std::vector<Judged> judge_invariant(const Invariant& invariant, const Buffer& buffer, const Buffer* other) {
  const InvariantType& type = *find_invariant(invariant.name);
  const auto broken = type.broken(buffer, other, invariant.tolerance);
  Judged j{{"", std::string(type.name), broken.value_or("holds"), std::string(type.doc), !broken}, ""};
  if (broken) j.sentence = fmt::format("it is not {}: {}", type.name, *broken);
  return {std::move(j)};
}

}  // namespace frustum
