#include "runtime/app/suite/judge.h"

#include "runtime/app/suite/case_run.h"
#include "runtime/app/suite/relation.h"
#include "runtime/app/suite/statements.h"
#include "runtime/core/missing_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

std::string shown(const Diagnostic& d) {
  const std::string place = d.line == 0 ? d.file : fmt::format("{}:{}:{}", d.file, d.line, d.column);
  return fmt::format("{} at {} {}: {}", d.code, place, d.pointer, d.message);
}

// Runs bypass the session's cache: what they cost must not depend on the cases before.

// Work counters, by name and by node.
class Counters : public Observer {
 public:
  void done(const WorkDone& work) override {
    for (const auto& [name, n] : work.counters) {
      all[name] += n;
      if (work.nodes.size() == 1) of_nodes[work.nodes.front() + ":" + name] += n;
    }
  }
  std::map<std::string, std::uint64_t> all, of_nodes;
};

class Judge {
 public:
  Judge(Session& session, const SuiteCase& c, const GoldenBook& book, const JudgeOptions& options,
        CaseResult& result)
      : session_(session), case_(c), run_(c, book, options, result), options_(options), result_(result) {}

  void judge() {
    LoadOptions load;
    load.settings = case_.settings;
    load.precision = case_.precision;
    Loaded loaded = load_graph_file(case_.graph, std::move(load), case_.pointer + "/graph");
    if (loaded.graph) run_graph_of(*loaded.graph, loaded.problems);
    judge_problems(loaded.problems);
  }

 private:
  // A graph that is not there is a fault of the suite, told where the suite names it, and may be expected.
  Loaded load_graph_file(const std::string& path, LoadOptions options, const std::string& pointer) {
    try {
      return session_.load(path, std::move(options));
    } catch (const WorldError& e) {
      if (e.code != "cannot_read_file") throw;
      const std::string why = why_missing(path, path);
      Loaded none;
      none.problems.add({.code = why.empty() ? e.code : "missing_file",
                         .pointer = pointer,
                         .message = why.empty() ? e.what() : why,
                         .expected = "a graph file",
                         .got = path,
                         .suggestions = near_files(path, path),
                         .file = result_.suite_file});
      return none;
    }
  }

  void fail(std::string sentence) { result_.failures.push_back(std::move(sentence)); }

  // Every port that a check names; of a trace all; without checks, what the graph gives out.
  std::vector<PortRef> wanted(const Graph& graph, Diagnostics& problems) const {
    std::vector<PortRef> ports;
    const auto add = [&](const std::string& address) {
      if (const auto port = port_of(graph, address, problems)) ports.push_back(*port);
    };
    for (const SuiteCheck& check : case_.checks) {
      add(check.port);
      if (check.same_as && is_own_run(*check.same_as)) add(check.same_as->port);
      if (check.invariant && !check.invariant->of.empty()) add(check.invariant->of);
      if (check.trace)
        for (std::size_t n = 0; n < graph.nodes.size(); ++n)
          for (std::size_t p = 0; p < graph.nodes[n].type->outputs.size(); ++p) ports.push_back({n, p});
    }
    if (!case_.checks.empty()) return ports;
    ports = end_ports(graph);
    for (const GraphOutput& output : graph.outputs)
      for (const OutputLayer& layer : output.layers) ports.push_back(layer.from);
    return ports;
  }

  static bool is_own_run(const OtherRun& o) { return o.graph.empty() && o.settings.empty() && !o.precision; }

  void run_graph_of(const Graph& graph, Diagnostics& problems) {
    Diagnostics unknown;
    RunOptions options;
    options.demand.ports = wanted(graph, unknown);
    for (const Diagnostic& d : unknown.list()) fail(to_sentence(d));
    if (!unknown.empty()) return;
    Counters counters;
    options.threads = options_.threads, options.cancel = options_.cancel, options.observer = &counters;
    const RunResult r = session_.run(graph, options, false);
    if (r.end == RunResult::End::cancelled) throw Cancelled();
    problems.add(r.problems);
    if (r.end != RunResult::End::done) return;
    result_.peak_bytes = r.peak_bytes, result_.counters = counters.all;
    for (const auto& [port, buffer] : r.buffers)
      if (buffer) run_.check_finite(graph.name(port), buffer);
    for (const SuiteCheck& check : case_.checks) check_port(graph, check, r.buffers);
    run_.name_first_divergence(graph, r.buffers);
    check_budget(counters, r.peak_bytes);
  }

  static std::string to_sentence(const Diagnostic& d) {
    return d.suggestions.empty() ? d.message
                                 : fmt::format("{}; did you mean '{}'?", d.message, d.suggestions.front());
  }

  // Every error has to be expected, and everything expected has to be there.
  void judge_problems(const Diagnostics& problems) {
    const auto& list = problems.list();
    for (const ExpectedProblem& e : case_.expected) {
      ++result_.checks;
      const bool given =
          std::any_of(list.begin(), list.end(), [&](const Diagnostic& d) { return e.matches(d); });
      result_.outcomes.push_back({"", "diagnostic", given ? "given" : "not given", e.code, given});
      if (!given)
        fail(fmt::format("expected the diagnostic {} at {}, which was not given", e.code,
                         e.pointer.empty() ? "any place" : e.pointer));
    }
    for (const Diagnostic& d : list)
      if (d.severity == Severity::error &&
          std::none_of(case_.expected.begin(), case_.expected.end(),
                       [&](const ExpectedProblem& e) { return e.matches(d); }))
        fail("not expected: " + shown(d));
  }

  void check_port(const Graph& graph, const SuiteCheck& check, const std::map<PortRef, Buffer>& buffers) {
    Diagnostics none;
    const auto buffer_of = [&](const std::string& address) -> const Buffer& {
      return buffers.at(*port_of(graph, address, none));
    };
    const Buffer& buffer = buffer_of(check.port);
    for (const std::string& address :
         {check.port, check.invariant ? check.invariant->of : std::string(),
          check.same_as && is_own_run(*check.same_as) ? check.same_as->port : ""})
      if (!address.empty() && !buffer_of(address))
        return fail(fmt::format("{}: the node did not make this optional output", address));
    const auto judged = [&](const char* what, auto&& outcomes) { run_.take(check.port, what, outcomes); };
    if (!check.shape.empty()) judged("shape", [&] { return judge_shape(check.shape, buffer); });
    if (check.probe) judged("probe", [&] { return judge_probe(*check.probe, buffer); });
    if (!check.statistics.empty())
      judged("statistics", [&] { return judge_statistics(check.statistics, buffer); });
    if (check.analytic) judged("analytic", [&] { return judge_analytic(*check.analytic, buffer); });
    if (check.invariant)
      judged("invariant", [&] {
        const bool two = !check.invariant->of.empty();
        return judge_invariant(*check.invariant, buffer, two ? &buffer_of(check.invariant->of) : nullptr);
      });
    if (check.golden) run_.check_golden(check, *port_of(graph, check.port, none), buffer);
    if (check.same_as && is_own_run(*check.same_as))
      run_.check_alike(check, buffer, buffer_of(check.same_as->port), check.same_as->port);
    else if (check.same_as)
      check_other_run(check, *check.same_as, {}, buffer);
    if (check.metamorphic)
      check_other_run(check, check.metamorphic->run, check.metamorphic->relation, buffer);
  }

  // Runs the other graph, or this one with other settings, for one port.
  void check_other_run(const SuiteCheck& check, const OtherRun& other, const Relation& relation,
                       const Buffer& own) {
    const std::string what = check.metamorphic ? "the changed run" : "the other run";
    LoadOptions load;
    if (other.graph.empty()) load.settings = case_.settings, load.precision = case_.precision;
    load.settings.insert(load.settings.end(), other.settings.begin(), other.settings.end());
    if (other.precision) load.precision = other.precision;
    const Loaded loaded = load_graph_file(other.graph.empty() ? case_.graph : other.graph, std::move(load),
                                          check.pointer + (check.metamorphic ? "/metamorphic" : "/same_as"));
    for (const Diagnostic& d : loaded.problems.list())
      if (d.severity == Severity::error) fail(fmt::format("{}: {}: {}", check.port, what, shown(d)));
    if (!loaded.graph) return;
    Diagnostics unknown;
    const auto port = port_of(*loaded.graph, other.port.empty() ? check.port : other.port, unknown);
    for (const Diagnostic& d : unknown.list()) fail(fmt::format("{}: {}", what, to_sentence(d)));
    if (!port) return;
    RunOptions options;
    options.demand.ports = {*port}, options.threads = options_.threads, options.cancel = options_.cancel;
    const RunResult r = session_.run(*loaded.graph, options, false);
    if (r.end == RunResult::End::cancelled) throw Cancelled();
    if (r.end != RunResult::End::done) {
      for (const Diagnostic& d : r.problems.list())
        if (d.severity == Severity::error) fail(fmt::format("{}: {}: {}", check.port, what, shown(d)));
      return;
    }
    const Buffer& found = r.buffers.at(*port);
    if (!found) return fail(fmt::format("{}: {} did not make this optional output", check.port, what));
    run_.check_finite(fmt::format("{} of {}", loaded.graph->name(*port), what), found);
    run_.check_related(check, own, found, relation, what);
  }

  void check_budget(const Counters& counters, std::uint64_t peak_bytes) {
    const auto within = [&](const std::string& what, std::uint64_t used, std::uint64_t most) {
      ++result_.checks;
      result_.outcomes.push_back(
          {"", what, std::to_string(used), fmt::format("at most {}", most), used <= most});
      if (used > most) fail(fmt::format("{}: {} is above the budget of {}", what, used, most));
    };
    if (case_.budget.bytes) within("bytes", peak_bytes, *case_.budget.bytes);
    for (const auto& [name, most] : case_.budget.counters) {
      const auto& known = name.find(':') != std::string::npos ? counters.of_nodes : counters.all;
      if (const auto found = known.find(name); found != known.end()) {
        within(name, found->second, most);
        continue;
      }
      std::vector<std::string> names;
      for (const auto& [counter, n] : known) names.push_back(counter);
      const auto near = nearest_names(name, names);
      fail(fmt::format("nothing counted '{}'{}", name,
                       near.empty() ? "" : fmt::format("; did you mean '{}'?", near.front())));
    }
  }

  Session& session_;
  const SuiteCase& case_;
  CaseRun run_;
  const JudgeOptions& options_;
  CaseResult& result_;
};

}  // namespace

void judge_case(Session& session, const SuiteCase& c, const GoldenBook& book, const JudgeOptions& options,
                CaseResult& result) {
  const auto began = std::chrono::steady_clock::now();
  try {
    Judge(session, c, book, options, result).judge();
    result.verdict = result.failures.empty() ? CaseVerdict::pass : CaseVerdict::fail;
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception& e) {
    result.verdict = CaseVerdict::crash;
    result.failures.emplace_back(e.what());
  }
  result.time = std::chrono::steady_clock::now() - began;
  if (c.budget.time && result.time > *c.budget.time)
    result.notes.push_back(fmt::format("it took {:.3g} s, above the {:.3g} s that it should take",
                                       std::chrono::duration<double>(result.time).count(),
                                       std::chrono::duration<double>(*c.budget.time).count()));
}

}  // namespace frustum
