#include "runtime/app/suite_run.h"

#include "runtime/app/golden.h"
#include "runtime/app/metrics/metrics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace frustum {
namespace {

bool chosen(const SuiteCase& c, const std::vector<std::string>& filters) {
  if (filters.empty()) return true;
  return std::any_of(filters.begin(), filters.end(), [&](const std::string& f) {
    return c.id.find(f) != std::string::npos || std::find(c.tags.begin(), c.tags.end(), f) != c.tags.end();
  });
}

std::string shown(const Diagnostic& d) {
  return fmt::format("{} at {}:{}:{} {}: {}", d.code, d.file, d.line, d.column, d.pointer, d.message);
}

// One case on its way: loads, runs, judges.
class CaseRun {
 public:
  CaseRun(Session& session, const SuiteCase& c, const SuiteOptions& options, GoldenBook& book,
          CaseResult& result)
      : session_(session), case_(c), options_(options), book_(book), result_(result) {}

  void run() {
    LoadOptions load;
    load.settings = case_.settings;
    load.precision = case_.precision;
    Loaded loaded = session_.load(case_.graph, std::move(load));
    if (loaded.graph) run_graph_of(*loaded.graph, loaded.problems);
    judge_problems(loaded.problems);
  }

 private:
  void fail(std::string sentence) { result_.failures.push_back(std::move(sentence)); }

  // Every port that a check names; without checks, what the graph gives out.
  std::vector<PortRef> wanted(const Graph& graph, Diagnostics& problems) const {
    std::vector<PortRef> ports;
    for (const SuiteCheck& check : case_.checks)
      for (const std::string& address : {check.port, check.same_as})
        if (!address.empty())
          if (const auto port = port_of(graph, address, problems)) ports.push_back(*port);
    if (!case_.checks.empty()) return ports;
    ports = end_ports(graph);
    for (const GraphOutput& output : graph.outputs)
      for (const OutputLayer& layer : output.layers) ports.push_back(layer.from);
    return ports;
  }

  void run_graph_of(const Graph& graph, Diagnostics& problems) {
    Diagnostics unknown;
    RunOptions options;
    options.demand.ports = wanted(graph, unknown);
    for (const Diagnostic& d : unknown.list()) fail(d.message);
    if (!unknown.empty()) return;
    options.threads = options_.threads;
    options.cancel = options_.cancel;
    const RunResult r = session_.run(graph, options);
    if (r.end == RunResult::End::cancelled) throw Cancelled();
    problems.add(r.problems);
    if (r.end != RunResult::End::done) return;
    for (const auto& [port, buffer] : r.buffers) check_finite(graph.name(port), buffer);
    for (const SuiteCheck& check : case_.checks) {
      ++result_.checks;
      check_port(graph, check, r.buffers);
    }
  }

  // Every error has to be expected, and everything expected has to be there.
  void judge_problems(const Diagnostics& problems) {
    for (const ExpectedProblem& e : case_.expected) {
      ++result_.checks;
      const auto& list = problems.list();
      if (std::none_of(list.begin(), list.end(), [&](const Diagnostic& d) { return e.matches(d); }))
        fail(fmt::format("expected the diagnostic {} at {}, which was not given", e.code,
                         e.pointer.empty() ? "any place" : e.pointer));
    }
    for (const Diagnostic& d : problems.list())
      if (d.severity == Severity::error &&
          std::none_of(case_.expected.begin(), case_.expected.end(),
                       [&](const ExpectedProblem& e) { return e.matches(d); }))
        fail("not expected: " + shown(d));
  }

  void check_finite(const std::string& name, const Buffer& buffer) {
    ++result_.checks;
    const Health h = buffer.health();
    if (!h.finite())
      fail(fmt::format("{}: {} NaN, {} infinite of {} values; the first: {}", name, h.nan,
                       h.positive_infinity + h.negative_infinity, h.values, h.first));
  }

  void check_port(const Graph& graph, const SuiteCheck& check, const std::map<PortRef, Buffer>& buffers) {
    Diagnostics none;
    const Buffer& buffer = buffers.at(*port_of(graph, check.port, none));
    if (!check.shape.empty()) check_shape(check, buffer);
    if (check.probe) check_probe(check, buffer);
    if (check.golden) check_golden(check, buffer);
    if (!check.same_as.empty()) {
      const Buffer& other = buffers.at(*port_of(graph, check.same_as, none));
      if (!check.has_tolerance()) {
        if (buffer.digest() != other.digest())
          fail(fmt::format("{} is not the same as {}", check.port, check.same_as));
      } else if (buffer.type().is_pixels() && other.type().is_pixels()) {
        within(check, buffer.type().raster(buffer.data()), other.type().raster(other.data()), check.same_as);
      } else {
        fail(fmt::format("{}: a tolerance compares pixels", check.port));
      }
    }
  }

  void check_shape(const SuiteCheck& check, const Buffer& buffer) {
    const Json summary = buffer.type().summary(buffer.data());
    const Json expected = Json::parse(check.shape);
    for (const auto& [key, value] : expected.items()) {
      const auto found = summary.find(key);
      if (found == summary.end())
        fail(fmt::format("{}: its summary has no '{}'", check.port, key));
      else if (*found != value)
        fail(fmt::format("{}: {} is {}, expected {}", check.port, key, found->dump(), value.dump()));
    }
  }

  void check_probe(const SuiteCheck& check, const Buffer& buffer) {
    const Probe& p = *check.probe;
    if (!buffer.type().is_pixels()) return fail(fmt::format("{}: a probe needs pixels", check.port));
    const Raster& raster = buffer.type().raster(buffer.data());
    const auto plane = p.plane.empty() ? std::optional<int>(0) : raster.frame().find(p.plane);
    if (!plane || raster.frame().planes.empty())
      return fail(fmt::format("{}: it has no plane '{}'", check.port, p.plane));
    if (!raster.frame().window.contains(p.x, p.y) || p.sample >= raster.frame().samples())
      return fail(fmt::format("{}: there is no sample {} of pixel {},{}", check.port, p.sample, p.x, p.y));
    const double value = raster.value(*plane, p.sample, p.x, p.y);
    if (!(std::abs(value - p.equals) <= p.abs))
      fail(fmt::format("{}: {} at {},{} sample {} is {:.9g}, expected {:.9g} within {:g}", check.port,
                       raster.frame().planes[static_cast<std::size_t>(*plane)].name, p.x, p.y, p.sample,
                       value, p.equals, p.abs));
  }

  void check_golden(const SuiteCheck& check, const Buffer& buffer) {
    const std::string key = case_.id + " " + check.port;
    const Golden* golden = book_.find(key);
    const std::string digest = to_hex(buffer.digest());
    if (golden != nullptr && golden->digest == digest) return;
    if (options_.accept) return accept(key, check, buffer, golden);
    if (golden == nullptr)
      return fail(fmt::format("{}: nothing was accepted yet; {} --accept", check.port, result_.rerun));
    if (!check.has_tolerance())
      return fail(fmt::format("{}: digest {} is not the accepted {}; {} --accept", check.port, digest,
                              golden->digest, result_.rerun));
    if (!buffer.type().is_pixels() || buffer.type().raster(buffer.data()).frame().pattern)
      return fail(fmt::format("{}: a tolerance compares pixels with one value each", check.port));
    within(check, buffer.type().raster(buffer.data()), book_.pixels(*golden), "the accepted one");
  }

  void accept(const std::string& key, const SuiteCheck& check, const Buffer& buffer, const Golden* old) {
    if (!buffer.health().finite())
      return fail(fmt::format("{}: not accepted, since it is not finite", check.port));
    std::string change = old == nullptr ? "new" : "was " + old->digest;
    if (old != nullptr && buffer.type().is_pixels() && !buffer.type().raster(buffer.data()).frame().pattern) {
      const Difference d = compare(buffer.type().raster(buffer.data()), book_.pixels(*old));
      change +=
          d.mismatch.empty() ? fmt::format(", rmse {:.3g}, max {:.3g}", d.rmse, d.max) : ", " + d.mismatch;
    }
    book_.accept(key, buffer, options_.reason);
    result_.accepted.push_back(fmt::format("{}: {} ({})", key, to_hex(buffer.digest()), change));
  }

  void within(const SuiteCheck& check, const Raster& mine, const Raster& other, const std::string& what) {
    const Difference d = compare(mine, other);
    if (!d.mismatch.empty()) return fail(fmt::format("{} against {}: {}", check.port, what, d.mismatch));
    if (d.nan != 0) return fail(fmt::format("{} against {}: {} values are NaN", check.port, what, d.nan));
    const std::string at =
        d.worst ? fmt::format(" ({}: {:.9g} and {:.9g})", d.worst->place(), d.worst->a, d.worst->b) : "";
    const auto bound = [&](const char* metric, double value, const std::optional<double>& limit) {
      if (limit && !(value <= *limit))
        fail(fmt::format("{} against {}: {} {:.6g} is above {:g}{}", check.port, what, metric, value, *limit,
                         at));
    };
    bound("rmse", d.rmse, check.rmse);
    bound("max", d.max, check.max);
    if (!check.abs) {
      if (d.wrong_ids != 0)
        fail(
            fmt::format("{} against {}: {} of {} ids are wrong{}", check.port, what, d.wrong_ids, d.ids, at));
      return;
    }
    const auto beyond = static_cast<double>(count_beyond(mine, other, *check.abs));
    if (beyond > (1 - check.fraction) * static_cast<double>(d.values))
      fail(fmt::format("{} against {}: {} of {} values are more than {:g} away{}", check.port, what, beyond,
                       d.values, *check.abs, at));
  }

  Session& session_;
  const SuiteCase& case_;
  const SuiteOptions& options_;
  GoldenBook& book_;
  CaseResult& result_;
};

}  // namespace

std::string_view name_of(Verdict v) {
  switch (v) {
    case Verdict::pass: return "pass";
    case Verdict::fail: return "fail";
    case Verdict::crash: return "crash";
  }
  return "";
}

std::vector<CaseResult> run_suite(Session& session, const Suite& suite, const SuiteOptions& options,
                                  const std::function<void(const CaseResult&)>& each) {
  const auto folder = std::filesystem::path(suite.file).parent_path() / ".." / "golden";
  GoldenBook book(folder.lexically_normal(), suite.name);
  std::vector<CaseResult> results;
  for (const SuiteCase& c : suite.cases) {
    if (!chosen(c, options.filters)) continue;
    if (options.cancel != nullptr && options.cancel->cancelled()) throw Cancelled();
    CaseResult& r = results.emplace_back();
    r.suite = suite.name, r.id = c.id;
    r.rerun = fmt::format("frustum test {} --filter '{}'", suite.file, c.id);
    const auto began = std::chrono::steady_clock::now();
    try {
      CaseRun(session, c, options, book, r).run();
      r.verdict = r.failures.empty() ? Verdict::pass : Verdict::fail;
    } catch (const Cancelled&) {
      throw;
    } catch (const std::exception& e) {
      r.verdict = Verdict::crash;
      r.failures.emplace_back(e.what());
    }
    r.time = std::chrono::steady_clock::now() - began;
    each(r);
  }
  book.save();
  return results;
}

}  // namespace frustum
