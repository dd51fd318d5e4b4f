#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/app/metrics/metrics.h"
#include "runtime/app/read_files.h"
#include "runtime/app/run_failure.h"
#include "runtime/app/sweep/analysis.h"
#include "runtime/app/sweep/journal.h"
#include "runtime/app/sweep/pictures.h"
#include "runtime/app/sweep/sweep.h"
#include "runtime/buffers/numbers.h"
#include "runtime/core/error.h"
#include "runtime/graph/keys.h"
#include "runtime/graph/own_files.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <limits>
#include <set>

namespace frustum {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t most_points = 10'000;

// Adds up what the nodes did. Tiles are no work: the same samples fall into more or fewer of them.
class WorkObserver : public Observer {
 public:
  void done(const WorkDone& w) override {
    if (w.kind == WorkDone::Kind::pixels) return;
    for (const auto& [name, n] : w.counters) counters[w.nodes.front() + " " + name] += n;
  }
  void pixel_times(const std::vector<PixelNodeTime>& times) override {
    for (const PixelNodeTime& t : times) counters[t.node + " samples"] += t.samples;
  }
  WorkCounters counters;
};

// Calls f and adds its time to `spent`, also where it throws.
template <class F>
decltype(auto) timed_into(double& spent, const F& f) {
  struct Timer {
    ~Timer() { spent += std::chrono::duration<double>(Clock::now() - began).count(); }
    double& spent;
    Clock::time_point began = Clock::now();
  } timer{spent};
  return f();
}

// One point on its way: the graph with its settings, files already read.
struct Candidate {
  SweepPoint point;
  Graph graph;
  PortRef want;
};

double json_double(const Json& j) {
  if (j.is_number()) return j.get<double>();
  if (j == "inf") return std::numeric_limits<double>::infinity();
  return j == "-inf" ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "an unknown processor";
}

class SweepRun {
 public:
  SweepRun(Session& session, const SweepOptions& options, Diagnostics& problems)
      : session_(session), o_(options), problems_(problems) {}

  std::optional<Sweep> run() {
    const auto began = Clock::now();
    auto base = load({});
    if (!base) return std::nullopt;
    sweep_.options = o_;
    sweep_.title = base->graph.title.empty() ? o_.graph : base->graph.title;
    sweep_.port = base->graph.name(base->want);
    sweep_.kind = std::string(base->graph.port(base->want).types.front()->name);
    sweep_.knobs = sweep_knobs(session_, base->graph, base->want, o_);
    const auto inputs = own_files(base->graph);
    if (!make_points(std::move(*base))) return std::nullopt;
    if (!make_reference()) return std::nullopt;
    if (writes_over(inputs)) return std::nullopt;
    open_journal();
    first_runs();
    rounds();
    for (Candidate& c : candidates_) sweep_.points.push_back(std::move(c.point));
    analyse(sweep_);
    sweep_.machine = fmt::format("{}, {} threads", processor(), threads());
    costs().total = std::chrono::duration<double>(Clock::now() - began).count();
    return std::move(sweep_);
  }

 private:
  SweepCosts& costs() { return sweep_.costs; }
  int threads() const { return o_.threads > 0 ? o_.threads : tbb::this_task_arena::max_concurrency(); }

  // ----- graphs

  std::optional<Candidate> load(const std::vector<Setting>& settings) {
    return timed_into(costs().loading, [&] { return loaded(settings); });
  }

  std::optional<Candidate> loaded(const std::vector<Setting>& settings) {
    LoadOptions options = o_.load;
    for (const Setting& s : settings) {
      if (s.address == "precision")
        options.precision = s.value == "double" ? Precision::real_double : Precision::single;
      else
        options.settings.push_back(s);
    }
    Loaded loaded = session_.load(o_.graph, std::move(options));
    // The graph is the first one loaded, and every setting of it has the same warnings.
    for (const Diagnostic& d : loaded.problems.list())
      if (settings.empty() || d.severity == Severity::error) problems_.add(d);
    if (!loaded.graph) return std::nullopt;
    const auto want = wanted(*loaded.graph);
    if (!want) return std::nullopt;
    Candidate c{.point = {}, .graph = std::move(*loaded.graph), .want = *want};
    const auto keys = node_keys(c.graph);
    c.point.key = to_hex(output_key(keys[want->node], want->port));
    read_files(c.graph, keys);
    return c;
  }

  std::optional<PortRef> wanted(const Graph& graph) {
    if (!o_.want.empty()) return port_of(graph, o_.want, problems_);
    if (!graph.outputs.empty()) return port_of(graph, graph.outputs.front().name, problems_);
    const auto ends = end_ports(graph);
    return ends.empty() ? std::nullopt : std::optional(ends.front());
  }

  // Makes literals of what io nodes give, once for all points: reading files is no part of what is swept.
  void read_files(Graph& graph, const std::vector<Digest>& keys) {
    for (GraphNode& node : graph.nodes)
      for (auto& list : node.inputs)
        for (Source& source : list) {
          const auto* from = std::get_if<PortRef>(&source);
          if (from == nullptr || !graph.nodes[from->node].type->name.starts_with("io.")) continue;
          const Digest key = output_key(keys[from->node], from->port);
          if (!files_.contains(key)) files_.emplace(key, run_port(graph, *from, nullptr));
          source = files_.at(key);
        }
  }

  // ----- running

  Buffer run_port(const Graph& graph, PortRef port, Observer* observer) {
    RunOptions options;
    options.demand.ports = {port};
    options.threads = o_.threads;
    options.cancel = o_.cancel;
    options.observer = observer;
    return finished(session_.run(graph, options, false)).buffers.at(port);
  }

  std::chrono::nanoseconds timed_run(const Candidate& c) {
    const auto began = Clock::now();
    run_port(c.graph, c.want, nullptr);
    const auto time = Clock::now() - began;
    costs().timed += std::chrono::duration<double>(time).count();
    return time;
  }

  // ----- points

  // Where the point is found afterwards: two ways of saying the same are one point.
  std::optional<std::size_t> add_point(const std::vector<std::string>& values,
                                       std::optional<std::size_t> knob) {
    std::vector<Setting> settings;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (!values[k].empty() && (o_.grid || knob == k))
        settings.push_back({sweep_.knobs[k].address, values[k]});
    auto c = load(settings);
    if (!c) return std::nullopt;
    for (std::size_t i = 0; i < candidates_.size(); ++i)
      if (candidates_[i].point.key == c->point.key) return i;
    c->point.values = values, c->point.knob = knob;
    candidates_.push_back(std::move(*c));
    return candidates_.size() - 1;
  }

  bool make_points(Candidate base) {
    std::vector<std::string> current;
    std::size_t all = 1;
    for (const SweepKnob& k : sweep_.knobs)
      current.push_back(k.current), all *= o_.grid ? k.values.size() : 1;
    if (all > most_points)
      throw NodeError("too_large", fmt::format("the grid has {} points, more than {}", all, most_points));
    if (!o_.grid) {
      base.point.values = current;
      candidates_.push_back(std::move(base));
      for (std::size_t k = 0; k < sweep_.knobs.size(); ++k) {
        exact_.emplace_back();
        for (const std::string& v : sweep_.knobs[k].values) {
          auto values = current;
          values[k] = v;
          const auto at = add_point(values, k);
          if (!at) return false;
          exact_[k] = *at;
        }
      }
      return true;
    }
    for (std::size_t i = 0; i < all; ++i) {
      std::vector<std::string> values;
      for (std::size_t k = 0, rest = i; k < sweep_.knobs.size(); rest /= sweep_.knobs[k].values.size(), ++k)
        values.push_back(sweep_.knobs[k].values[rest % sweep_.knobs[k].values.size()]);
      if (!add_point(values, std::nullopt)) return false;
    }
    return true;
  }

  // ----- the reference

  bool make_reference() {
    if (!o_.reference_file.empty()) {
      reference_ = load_buffer(o_.reference_file);
      reference_key_ = to_hex(reference_.digest());
      sweep_.reference = o_.reference_file;
      return true;
    }
    std::vector<Setting> settings;
    for (const std::string& text : o_.reference) {
      const auto equals = text.find('=');
      if (equals == std::string::npos || equals == 0)
        throw NodeError("bad_knob", fmt::format("--reference {}: expected ADDR=VALUE", text));
      settings.push_back({text.substr(0, equals), text.substr(equals + 1)});
    }
    if (settings.empty())
      for (const SweepKnob& k : sweep_.knobs) settings.push_back({k.address, k.values.back()});
    for (const Setting& s : settings)
      sweep_.reference += fmt::format("{}{} = {}", sweep_.reference.empty() ? "" : ", ", s.address, s.value);
    auto c = load(settings);
    if (!c) return false;
    reference_key_ = c->point.key;
    reference_graph_ = std::move(*c);
    return true;
  }

  const Buffer& reference() {
    if (!reference_) {
      say("the reference");
      reference_ = timed_into(costs().reference, [&] {
        return run_port(reference_graph_->graph, reference_graph_->want, nullptr);
      });
      timed_into(costs().judging, [&] { save_pictures(picture_folder(), "reference", reference_, nullptr); });
    }
    return reference_;
  }

  // ----- files

  // Reports it where a file that the sweep will write is one that it reads, and throws where it cannot be written.
  bool writes_over(std::vector<std::string> inputs) {
    if (!o_.reference_file.empty()) inputs.push_back(o_.reference_file);
    std::vector<std::string> made;
    for (const char* name : {"sweep.json", "sweep.csv", "sweep.html", "points.jsonl"})
      made.push_back((std::filesystem::path(o_.folder) / name).string());
    made.push_back((picture_folder() / "reference.png").string());
    for (const Candidate& c : candidates_)
      for (const char* kind : {".png", ".error.png"})
        made.push_back((picture_folder() / (c.point.key + kind)).string());
    auto d = overwriting_one(inputs, made, "--out");
    for (std::size_t i = 0; i < 5 && !d; ++i) require_writable(made[i]);
    if (!d && !o_.markdown.empty()) {
      d = overwriting_one(inputs, markdown_files(), "--markdown");
      if (!d) require_writable(o_.markdown + ".svg");
    }
    if (d) problems_.add(std::move(*d));
    return d.has_value();
  }

  // What is there of what sweep_markdown may write.
  std::vector<std::string> markdown_files() const {
    const std::filesystem::path target = o_.markdown;
    const std::string name = target.filename().string();
    std::vector<std::string> files{target.string() + ".svg"};
    for (auto& f : matching_files(target.parent_path() / (name + "_*.png"))) files.push_back(f.string());
    return files;
  }

  // ----- what was finished before

  std::filesystem::path picture_folder() const { return std::filesystem::path(o_.folder) / "pictures"; }

  void open_journal() {
    Hasher h;
    h.text(reference_key_).value(o_.repeats).value(threads());
    for (const std::string& m : o_.metrics) h.text(m);
    for (const Candidate& c : candidates_) h.text(c.point.key);
    journal_.emplace(std::filesystem::path(o_.folder) / "points.jsonl", to_hex(h.done()), o_.resume);
    for (const Json& e : journal_->entries())
      for (Candidate& c : candidates_)
        if (e.value("point", "") == c.point.key) recall(c.point, e);
    for (const Candidate& c : candidates_) sweep_.resumed += measured_.contains(c.point.key) ? 1 : 0;
  }

  void recall(SweepPoint& p, const Json& e) {
    if (e.contains("ns")) return p.times.push_back(std::chrono::nanoseconds(e["ns"].get<std::int64_t>()));
    if (e.contains("of_knob"))
      return void(p.own_errors[e["of_knob"].get<std::size_t>()] = json_double(e["own"]));
    for (const auto& [metric, v] : e.at("errors").items()) p.errors[metric] = json_double(v);
    if (e.contains("own") && p.knob) p.own_errors[*p.knob] = json_double(e["own"]);
    for (const auto& [name, n] : e.at("counters").items()) p.counters[name] = n.get<std::uint64_t>();
    p.work = e.at("work").get<std::uint64_t>();
    measured_.insert(p.key);
  }

  // ----- errors and counters: one run of each point

  void first_runs() {
    for (Candidate& c : candidates_)
      if ((o_.grid || !c.point.knob) && !measured_.contains(c.point.key)) {
        Buffer buffer = run_observed(c);
        finish_measure(c, buffer, nullptr);
        if (!c.point.knob && !o_.grid) as_it_is_ = std::move(buffer);
      }
    for (std::size_t k = 0; k < sweep_.knobs.size() && !o_.grid; ++k) measure_knob(k);
    as_it_is_ = {};
  }

  // The most exact value comes first: the others are measured against it.
  void measure_knob(std::size_t k) {
    std::vector<Candidate*> mine;
    for (Candidate& c : candidates_)
      if (c.point.knob == k && !measured_.contains(c.point.key)) mine.push_back(&c);
    SweepPoint& base = candidates_.front().point;
    if (mine.empty() && base.own_error(k)) return;
    Candidate& exact = candidates_[exact_[k]];
    const Buffer own = &exact == &candidates_.front() ? as_it_is() : run_observed(exact);
    for (Candidate* c : mine) finish_measure(*c, c == &exact ? own : run_observed(*c), &own);
    if (base.own_error(k)) return;
    const Buffer& now = as_it_is();
    timed_into(costs().judging, [&] { measure_own(base, k, now, own); });
    if (const auto e = base.own_error(k))
      note({{"point", base.key}, {"of_knob", k}, {"own", json_number(*e)}});
  }

  // The buffer of the graph as it is, which every knob is compared with.
  const Buffer& as_it_is() {
    if (!as_it_is_) as_it_is_ = run_observed(candidates_.front());
    return as_it_is_;
  }

  Buffer run_observed(Candidate& c) {
    say(describe(c.point));
    WorkObserver work;
    Buffer b = timed_into(costs().first, [&] { return run_port(c.graph, c.want, &work); });
    c.point.counters = std::move(work.counters);
    c.point.work = 0;
    for (const auto& [name, n] : c.point.counters) c.point.work += n;
    return b;
  }

  // Errors and pictures side by side: no run is timed meanwhile.
  void finish_measure(Candidate& c, const Buffer& buffer, const Buffer* own) {
    SweepPoint& p = c.point;
    const Buffer& exact = reference();
    Measured m;
    // Where the other knobs are at their most exact values, both errors are one.
    const bool one = own != nullptr && candidates_[exact_[*p.knob]].point.key == reference_key_;
    timed_into(costs().judging, [&] {
      tbb::parallel_invoke([&] { m = measure(buffer, exact, o_.metrics); },
                           [&] {
                             if (own != nullptr && !one) measure_own(p, *p.knob, buffer, *own);
                           },
                           [&] { save_pictures(picture_folder(), p.key, buffer, &exact); });
    });
    if (!m.difference.mismatch.empty())
      throw NodeError("not_comparable", fmt::format("{} is not measured against the reference: {}",
                                                    describe(p), m.difference.mismatch));
    p.errors = m.values;
    if (one) p.own_errors[*p.knob] = m.values.at(o_.metrics.front());
    Json entry = {{"point", p.key}, {"errors", Json::object()}, {"counters", p.counters}, {"work", p.work}};
    for (const auto& [metric, v] : p.errors) entry["errors"][metric] = json_number(v);
    if (p.own_error()) entry["own"] = json_number(*p.own_error());
    note(entry);
    measured_.insert(p.key);
    ++done_;
  }

  void measure_own(SweepPoint& p, std::size_t knob, const Buffer& buffer, const Buffer& exact) {
    const std::vector<std::string> first{o_.metrics.front()};
    const Measured m = measure(buffer, exact, first);
    if (m.difference.mismatch.empty()) p.own_errors[knob] = m.values.at(first.front());
  }

  // ----- times: in turns, so that a slow moment of the machine falls on all points alike

  void rounds() {
    for (int round = 0; round < o_.repeats; ++round)
      for (Candidate& c : candidates_) {
        if (c.point.times.size() > static_cast<std::size_t>(round)) continue;
        if (o_.cancel != nullptr && o_.cancel->cancelled()) throw Cancelled();
        const auto time = timed_run(c);
        c.point.times.push_back(time);
        note({{"point", c.point.key}, {"ns", time.count()}});
        ++done_;
        say(fmt::format("round {} of {}: {}", round + 1, o_.repeats, describe(c.point)));
      }
  }

  void note(const Json& entry) {
    timed_into(costs().journal, [&] { journal_->append(entry); });
  }

  std::string describe(const SweepPoint& p) const {
    if (p.knob) return fmt::format("{} = {}", sweep_.knobs[*p.knob].address, p.values[*p.knob]);
    if (!o_.grid) return "the graph as it is";
    std::string out;
    for (std::size_t k = 0; k < p.values.size(); ++k)
      out += fmt::format("{}{} = {}", k == 0 ? "" : ", ", sweep_.knobs[k].address, p.values[k]);
    return out;
  }

  void say(const std::string& what) const {
    if (o_.progress) o_.progress(done_, candidates_.size() * static_cast<std::size_t>(o_.repeats + 1), what);
  }

  Session& session_;
  const SweepOptions& o_;
  Diagnostics& problems_;
  Sweep sweep_;
  std::vector<Candidate> candidates_;
  std::vector<std::size_t> exact_;  // by knob: the candidate with its most exact value
  std::optional<Candidate> reference_graph_;
  std::string reference_key_;
  Buffer reference_, as_it_is_;
  std::map<Digest, Buffer> files_;  // outputs of io nodes
  std::optional<SweepJournal> journal_;
  std::set<std::string> measured_;  // keys of points whose error is known
  std::size_t done_ = 0;
};

}  // namespace

std::optional<Sweep> run_sweep(Session& session, const SweepOptions& options, Diagnostics& problems) {
  for (const std::string& m : options.metrics)
    if (find_metric(m) == nullptr) parse_metric_bound(m);  // says what is near
  return SweepRun(session, options, problems).run();
}

}  // namespace frustum
