// One check: from its keys to what it means, and what of it makes no sense together.
#include "runtime/app/suite/expression.h"
#include "runtime/app/suite/invariants.h"
#include "runtime/app/suite/read.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

std::vector<Setting> settings_of(const std::map<std::string, std::string>& map) {
  std::vector<Setting> out;
  for (const auto& [address, value] : map) out.push_back({address, value});
  return out;
}

std::optional<std::pair<double, double>> interval(SuiteParser& p, const std::array<double, 2>& ends) {
  if (ends[0] <= ends[1]) return std::pair{ends[0], ends[1]};
  p.at.problem("out_of_range", fmt::format("the interval from {} to {} is empty", ends[0], ends[1]));
  return std::nullopt;
}

class CheckReader {
 public:
  CheckReader(SuiteParser& parser, const Json& json)
      : p_(parser), json_(json), k_(parser.keys<suite_keys::Check>(json)) {}

  SuiteCheck read() {
    c_.port = k_.port, c_.why = k_.why, c_.golden = k_.golden, c_.trace = k_.trace;
    if (json_.is_object() && c_.port.empty()) p_.missing("a check needs a \"port\"");
    read_likeness();
    p_.inside("same_as", k_.same_as, [&](const Json& j) { c_.same_as = read_other(j); });
    if (k_.metamorphic) read_metamorphic(*k_.metamorphic);
    p_.inside("shape", k_.shape, [&](const Json& j) {
      if (!j.is_object()) return p_.wrong("an object: entries of the summary");
      c_.shape = j.dump();
    });
    if (k_.probe) p_.at.inside("probe", [&] { read_probe(*k_.probe); });
    p_.inside("statistics", k_.statistics, [&](const Json& j) { read_statistics(j); });
    p_.inside("invariant", k_.invariant, [&](const Json& j) { read_invariant(j); });
    if (k_.analytic) p_.at.inside("analytic", [&] { read_analytic(*k_.analytic); });
    judge_together();
    return std::move(c_);
  }

 private:
  void read_likeness() {
    Likeness& l = c_.likeness;
    l.exact = k_.exact, l.close = {k_.abs, k_.rel, k_.ulp}, l.fraction = k_.fraction;
    if (k_.percentile) l.percentile = {k_.percentile->p, k_.percentile->at_most};
    for (const auto& m : suite_keys::metric_keys)
      if (const auto& bound = k_.*m.bound) l.metrics.push_back({m.metric, *bound});
  }

  OtherRun read_other(const Json& j) {
    OtherRun run;
    if (j.is_string()) {
      run.port = j.get<std::string>();
      return run;
    }
    if (!j.is_object()) {
      p_.wrong("a port, or an object with \"graph\", \"port\" and \"set\"");
      return run;
    }
    const auto k = p_.keys<suite_keys::OtherRun>(j);
    if (!k.graph.empty()) run.graph = p_.path(k.graph);
    run.port = k.port, run.precision = k.precision, run.settings = settings_of(p_.settings("set", k.set));
    if (k.graph.empty() && k.port.empty() && !k.precision && run.settings.empty())
      p_.missing("another run differs in something: \"graph\", \"port\", \"set\" or \"precision\"");
    return run;
  }

  void read_metamorphic(const suite_keys::Metamorphic& k) {
    p_.at.inside("metamorphic", [&] {
      Metamorphic m;
      m.run.settings = settings_of(p_.settings("set", k.set)), m.run.precision = k.precision;
      if (m.run.settings.empty() && !m.run.precision)
        p_.missing("a metamorphic check changes the input: \"set\" or \"precision\"");
      if (!k.expect.given()) p_.missing("a metamorphic check needs \"expect\": what the output becomes");
      p_.inside("expect", k.expect, [&](const Json& j) { m.relation = read_relation(j); });
      c_.metamorphic = m;
    });
  }

  Relation read_relation(const Json& j) {
    using Kind = Relation::Kind;
    static const std::vector<std::pair<std::string, Kind>> known{{"same", Kind::same},
                                                                 {"mirror_x", Kind::mirror_x},
                                                                 {"mirror_y", Kind::mirror_y},
                                                                 {"rotate_180", Kind::rotate_180}};
    Relation r;
    if (j.is_string()) {
      for (const auto& [name, kind] : known)
        if (j == name) return {.kind = kind};
      std::vector<std::string> names;
      for (const auto& [name, kind] : known) names.push_back(name);
      const auto got = j.get<std::string>();
      p_.at.problem("unknown_choice", fmt::format("'{}' is not one of: {}", got, fmt::join(names, ", ")),
                    fmt::format("{}", fmt::join(names, ", ")), got, nearest_names(got, names));
      return r;
    }
    const auto k = p_.keys<suite_keys::Relation>(j);
    if (k.shift) r = {.kind = Kind::shift, .shift = *k.shift};
    if (k.times) r = {.kind = Kind::times, .times = *k.times};
    if (k.matrix) r = {.kind = Kind::matrix, .matrix = *k.matrix};
    return r;
  }

  void read_probe(const suite_keys::Probe& k) {
    Probe probe;
    const int places = (k.pixel ? 1 : 0) + (k.region ? 1 : 0) + (k.row ? 1 : 0);
    if (places != 1) p_.conflict("a probe has one place: \"pixel\", \"region\" or \"row\"");
    if (k.pixel) probe.region = {k.pixel->x, k.pixel->y, 1, 1};
    if (k.region) {
      probe.at = Probe::At::region, probe.region = *k.region;
      if (probe.region[2] < 1 || probe.region[3] < 1)
        p_.at.inside("region", [&] { p_.at.problem("out_of_range", "a region has at least one pixel"); });
    }
    if (k.row)
      probe.at = Probe::At::row, probe.row = static_cast<std::size_t>(std::max<std::int64_t>(*k.row, 0));
    if (k.row ? !k.plane.empty() || k.sample.has_value() : !k.column.empty())
      p_.conflict("pixels have \"plane\" and \"sample\", rows have \"column\"");
    probe.series = k.row ? k.column : k.plane, probe.sample = k.sample, probe.close = {k.abs, k.rel, k.ulp};
    p_.inside("equals", k.equals, [&](const Json& j) { read_numbers(j, probe.equals); });
    if (k.between) p_.at.inside("between", [&] { probe.between = interval(p_, *k.between); });
    if (k.equals.given() == k.between.has_value())
      p_.conflict("a probe needs \"equals\" or \"between\", one of them");
    if (k.between && probe.close.given()) p_.conflict("\"abs\", \"rel\" and \"ulp\" are about \"equals\"");
    c_.probe = probe;
  }

  void read_numbers(const Json& j, std::vector<double>& out) {
    const Json list = j.is_array() ? j : Json::array({j});
    for (const Json& item : list)
      if (item.is_number())
        out.push_back(item.get<double>());
      else
        return p_.wrong("a number, or a list of numbers");
    if (out.empty()) p_.wrong("a number, or a list of numbers");
  }

  void read_statistics(const Json& j) {
    if (!j.is_object()) return p_.wrong("an object of statistics and their intervals");
    const std::string series = j.contains("plane") ? "plane" : "column";
    std::string of;
    if (j.contains(series) && j[series].is_string()) of = j[series].get<std::string>();
    for (const auto& [name, value] : j.items())
      if (name != series)
        p_.at.inside(name, [&, &name = name, &value = value] { read_statistic(of, name, value); });
    if (j.size() == j.count(series)) p_.missing("statistics need one, such as \"mean\": [0.4, 0.6]");
  }

  void read_statistic(const std::string& of, const std::string& name, const Json& value) {
    static const std::vector<std::string> known{"min",   "max",   "mean",   "deviation", "sum",
                                                "count", "plane", "column", "p50"};
    const bool percentile =
        name.size() > 1 && name[0] == 'p' &&
        std::all_of(name.begin() + 1, name.end(), [](char c) { return c >= '0' && c <= '9'; }) &&
        name.size() <= 4 && std::stoi(name.substr(1)) <= 100;
    if (!percentile && std::find(known.begin(), known.end() - 3, name) == known.end() - 3)
      return p_.at.problem("unknown_key", fmt::format("'{}' is no statistic", name),
                           "min, max, mean, deviation, sum, count, or p0 to p100", name,
                           nearest_names(name, known));
    std::array<double, 2> ends{};
    const bool one = value.is_number();
    const bool two = value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
    if (!one && !two) return p_.wrong("a number, or the two ends of an interval");
    ends = one ? std::array{value.get<double>(), value.get<double>()}
               : std::array{value[0].get<double>(), value[1].get<double>()};
    if (const auto i = interval(p_, ends)) c_.statistics.push_back({of, name, i->first, i->second});
  }

  void read_invariant(const Json& j) {
    suite_keys::Invariant k;
    if (j.is_string())
      k.name = j.get<std::string>();
    else
      k = p_.keys<suite_keys::Invariant>(j);
    const InvariantType* type = find_invariant(k.name);
    if (type == nullptr) {
      std::vector<std::string> names;
      for (const InvariantType& t : invariant_types()) names.emplace_back(t.name);
      return p_.at.problem("unknown_choice", fmt::format("there is no invariant '{}'", k.name),
                           fmt::format("{}", fmt::join(names, ", ")), k.name, nearest_names(k.name, names));
    }
    if (type->needs_other == k.of.empty())
      p_.conflict(type->needs_other ? fmt::format("'{}' is about two ports: it needs \"of\"", k.name)
                                    : fmt::format("'{}' is about one port: it takes no \"of\"", k.name));
    c_.invariant = Invariant{k.name, k.of, k.tolerance};
  }

  void read_analytic(const suite_keys::Analytic& k) {
    if (k.value.empty() || k.equals.empty()) p_.missing("an analytic check needs \"value\" and \"equals\"");
    for (const auto& [key, text] :
         {std::pair{"value", &k.value}, {"equals", &k.equals}, {"where", &k.where}}) {
      std::string problem;
      if (!text->empty() && !Expression::parse(*text, problem))
        p_.at.inside(key, [&] { p_.at.problem("bad_expression", problem); });
    }
    c_.analytic = Analytic{k.value, k.equals, k.where, {k.abs, k.rel, k.ulp}};
  }

  // ----- what makes no sense together

  void judge_together() {
    const Likeness& l = c_.likeness;
    const int against = (c_.golden ? 1 : 0) + (c_.same_as ? 1 : 0) + (c_.metamorphic ? 1 : 0);
    if (against > 1)
      p_.conflict("a check compares with one thing: \"golden\", \"same_as\" or \"metamorphic\"");
    if (against == 0 && (l.bounded() || l.exact))
      p_.missing("a tolerance compares with something: \"golden\": true, \"same_as\" or \"metamorphic\"");
    if (l.exact && l.bounded()) p_.conflict("\"exact\" leaves no tolerance");
    if (l.fraction < 1 && !l.close.given())
      p_.conflict(
          "\"fraction\" says for how many values \"abs\", \"rel\" or \"ulp\" holds: one of them is missing");
    if (c_.trace && !c_.golden) p_.conflict("\"trace\" goes with \"golden\": true");
    if (above_zero() && c_.why.empty()) p_.missing("a tolerance above zero needs a \"why\"");
  }

  bool above_zero() const {
    const Likeness& l = c_.likeness;
    return l.close.above_zero() || l.fraction < 1 ||
           (l.percentile && (l.percentile->second > 0 || l.percentile->first < 100)) || lossy_metric() ||
           (c_.probe && c_.probe->close.above_zero()) || (c_.analytic && c_.analytic->close.above_zero()) ||
           (c_.invariant && c_.invariant->tolerance > 0);
  }

  // A noise ratio is finite and a similarity may be below 1: both let something through.
  bool lossy_metric() const {
    return std::any_of(c_.likeness.metrics.begin(), c_.likeness.metrics.end(), [](const MetricBound& m) {
      return m.metric == "psnr" || (m.metric == "ssim" ? m.tolerance < 1 : m.tolerance > 0);
    });
  }

  SuiteParser& p_;
  const Json& json_;
  suite_keys::Check k_;
  SuiteCheck c_;
};

}  // namespace

SuiteCheck read_check(SuiteParser& parser, const Json& json) { return CheckReader(parser, json).read(); }

}  // namespace frustum
