#include "runtime/graph/run.h"

#include "runtime/core/float_environment.h"
#include "runtime/core/new_folders.h"
#include "runtime/graph/own_files.h"
#include "runtime/graph/run_effects.h"
#include "runtime/graph/run_state.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <map>
#include <new>
#include <optional>

namespace frustum {
namespace {

using End = RunResult::End;

// Runs the steps of a plan: each as soon as those it waits for are over, on whichever thread is free.
class Runner {
 public:
  Runner(const Graph& graph, const RunOptions& options) : state_(graph, options) {}

  RunResult run() {
    state_.caches.look_up([this](PortRef p, const Buffer& b) { return take_found(p, b); });
    state_.plan = make_plan(state_.graph, state_.options.demand,
                            {.fuse = state_.options.fuse,
                             .cropped = state_.options.region.has_value(),
                             .given = [this](PortRef p) { return static_cast<bool>(state_.buffer(p)); }});
    wanted_.resize(state_.graph.nodes.size());
    for (const PlannedNode& n : state_.plan.nodes) wanted_[n.node] = n.wanted_outputs;
    announce_uses();
    state_.observe([&](Observer& o) { o.planned(state_.plan.steps.size()); });
    run_steps();
    return result();
  }

 private:
  // ----- what is there already

  // A buffer from a cache is taken where it leaves half of the allowed memory to what is still to be computed.
  bool take_found(PortRef p, const Buffer& b) {
    const std::uint64_t limit = state_.options.memory;
    if (limit != 0 && state_.ledger.live() + b.bytes() > limit / 2) return false;
    state_.publish(p, b);
    return true;
  }

  // What the nodes said whose work the caches saved; they are those that feed the plan and are not in it.
  void replay_notes(const std::vector<NodeCaching>& caching) {
    std::vector<bool> ran(state_.graph.nodes.size(), false);
    for (const PlannedNode& n : state_.plan.nodes) ran[n.node] = true;
    std::size_t at = 0;
    for (const NodeCaching& c : caching) {
      while (state_.graph.nodes[at].id != c.node) ++at;
      if (!ran[at]) replay(at);
    }
  }

  void replay(std::size_t n) {
    const NodeNotes notes = state_.caches.notes(n);
    for (const auto& [code, message] : notes.warnings) state_.warning(n, code, message);
    if (notes.culprit) state_.culprit(*notes.culprit, n);
  }

  // ----- lifetimes

  // The ports that a step reads from memory; its buffers must live until it is over.
  template <class F>
  void for_each_use(const Step& step, F&& f) const {
    if (step.kind == Step::Kind::node) return for_each_link(step.index, f);
    const PixelPass& pass = state_.plan.passes[step.index];
    for (const std::size_t n : pass.nodes) for_each_link(n, f);
    for (const std::size_t o : pass.outputs)
      for (const OutputLayer& l : state_.graph.outputs[o].layers) f(l.from);
  }

  template <class F>
  void for_each_link(std::size_t node, F&& f) const {
    for (const auto& sources : state_.graph.nodes[node].inputs)
      for (const Source& s : sources)
        if (const auto* from = std::get_if<PortRef>(&s)) f(*from);
  }

  void announce_uses() {
    for (const Step& s : state_.plan.steps) {
      for_each_use(s, [&](PortRef p) { state_.announce_use(p); });
      if (s.kind == Step::Kind::pass)
        for (const std::size_t n : state_.plan.passes[s.index].nodes) state_.announce_ready_use(n);
    }
    for (const PortRef p : state_.options.demand.ports) state_.announce_use(p);
  }

  void end_uses(const Step& s) {
    for_each_use(s, [&](PortRef p) { state_.end_use(p); });
    // Where no pixel is filled, nodes that read the pass are prepared from the frames of its nodes still.
    if (s.kind == Step::Kind::pass && !state_.options.only_facts)
      for (const std::size_t n : state_.plan.passes[s.index].nodes) state_.end_ready_use(n);
  }

  // ----- scheduling

  void run_steps() {
    waiting_ = std::vector<std::atomic<std::size_t>>(state_.plan.steps.size());
    std::vector<std::size_t> ready;
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      waiting_[i] = state_.plan.steps[i].waits_for;
      if (waiting_[i] == 0) ready.push_back(i);
    }
    tbb::task_group group;
    for (std::size_t i = 1; i < ready.size(); ++i)
      group.run([this, &group, s = ready[i]] { run_chain(s, group); });
    if (!ready.empty()) run_chain(ready.front(), group);
    group.wait();
  }

  // Runs a step and then the first step that it made ready, so that chains stay on one thread without a hand-over.
  void run_chain(std::size_t step, tbb::task_group& group) {
    constexpr auto none = static_cast<std::size_t>(-1);
    while (step != none && !stopped_) {
      const Step& s = state_.plan.steps[step];
      const bool waits_for_pixels = state_.options.only_facts && s.kind == Step::Kind::pass;
      run_guarded(s);
      end_uses(s);
      if (waits_for_pixels) return;  // nor do its followers run
      std::size_t next = none;
      for (const std::size_t f : s.followers) {
        if (waiting_[f].fetch_sub(1) != 1) continue;
        if (next == none)
          next = f;
        else
          group.run([this, &group, f] { run_chain(f, group); });
      }
      step = next;
    }
  }

  void run_guarded(const Step& s) {
    try {
      if (state_.options.cancel != nullptr && state_.options.cancel->cancelled()) throw Cancelled();
      if (s.kind == Step::Kind::pass && state_.options.only_facts)
        decide_pass(state_, s.index);
      else if (s.kind == Step::Kind::pass)
        run_pass(state_, s.index);
      else if (state_.graph.nodes[s.index].type->is_pixel())
        prepare_node(s.index);
      else
        run_node(s.index);
    } catch (const Cancelled&) {
      stop(End::cancelled);
    } catch (const NodeError& e) {
      fail(s, End::failed, e.code, e.what(), e.part);
    } catch (const WorldError& e) {
      fail(s, End::world_failed, e.code, e.what());
    } catch (const std::bad_alloc&) {
      fail(s, End::world_failed, "out_of_memory", "no memory left");
    } catch (const std::exception& e) {
      spdlog::debug("{}", e.what());  // the text of a library, of no use without the source
      fail(s, End::world_failed, "internal",
           "this is a fault of frustum, which met an error that it does not know");
    }
  }

  void stop(End end) {
    End expected = End::done;
    end_.compare_exchange_strong(expected, end);
    stopped_ = true;
  }

  void fail(const Step& s, End end, const std::string& code, const std::string& message,
            const std::string& part = {}) {
    stop(end);
    // Whoever asks next finds the memory just as full: that is one problem and not two.
    if (code == "memory" && memory_told_.exchange(true)) return;
    if (s.kind == Step::Kind::node) {
      const std::string at = part.empty() ? file_part(s.index, code) : part;
      state_.problem(state_.at_node(s.index, code, message, Severity::error, at), s.index);
    } else {
      const SourcePlace& place = place_of(s);
      state_.problem({.code = code,
                      .pointer = place.pointer,
                      .message = message,
                      .file = place.file,
                      .line = place.line,
                      .column = place.column},
                     state_.graph.nodes.size());
    }
  }

  // Readers know the file and not the parameter that names it: of a node with one such parameter it is that.
  std::string file_part(std::size_t n, const std::string& code) const {
    constexpr std::array<std::string_view, 7> of_files{
        "cannot_read_file",    "malformed_file",        "missing_file", "unsafe_path",
        "unsupported_version", "unsupported_extension", "not_deep"};
    if (std::find(of_files.begin(), of_files.end(), code) == of_files.end()) return {};
    std::string part;
    for (const ParamField& field : state_.graph.nodes[n].type->params.fields) {
      if (!field.type->files) continue;
      if (!part.empty()) return {};
      part = at_param(field.name);
    }
    return part;
  }

  const SourcePlace& place_of(const Step& s) {
    if (s.kind == Step::Kind::node) return state_.graph.nodes[s.index].place;
    const PixelPass& pass = state_.plan.passes[s.index];
    for (const std::size_t o : pass.outputs)
      if (state_.has_failed(o) || state_.graph.outputs[o].whole) return state_.graph.outputs[o].place;
    if (pass.nodes.empty()) return state_.graph.outputs[pass.outputs.front()].place;
    return state_.graph.nodes[pass.nodes.back()].place;
  }

  // ----- nodes

  Context context(std::size_t node) const {
    Context ctx;
    ctx.precision = state_.graph.nodes[node].precision;
    ctx.seed = state_.graph.seed;
    ctx.cancel = state_.options.cancel;
    ctx.wanted_outputs = state_.options.effects.forces(unused_outputs) ? ~std::uint64_t{0} : wanted_[node];
    ctx.effects = &state_.options.effects;
    ctx.admit = [this](std::uint64_t claimed) { state_.check_memory(claimed); };
    return ctx;
  }

  Buffer value(const Source& s) const {
    const auto* from = std::get_if<PortRef>(&s);
    return from != nullptr ? state_.buffer(*from) : std::get<Buffer>(s);
  }

  void run_node(std::size_t n) {
    const GraphNode& node = state_.graph.nodes[n];
    state_.observe([&](Observer& o) { o.started(node.id); });
    const auto start = state_.now();
    std::vector<std::vector<Buffer>> inputs(node.inputs.size());
    for (std::size_t i = 0; i < inputs.size(); ++i)
      for (const Source& s : node.inputs[i]) inputs[i].push_back(value(s));
    Context ctx = context(n);
    const FloatEnvironment environment;
    std::vector<Buffer> outputs = node.type->run(inputs, node.params.get(), ctx);
    std::uint64_t bytes = 0;
    for (std::size_t p = 0; p < outputs.size(); ++p) {
      if (!outputs[p]) continue;
      bytes += outputs[p].bytes();
      check_health(n, p, outputs[p]);
      // A port that was found in a cache is there, and may be being read.
      if (is_wanted({n, p})) state_.publish({n, p}, outputs[p]);
    }
    state_.check_memory(0);
    report(n, ctx, WorkDone::Kind::node, start, bytes);
    decide_unused(n);
    for (std::size_t p = 0; p < outputs.size(); ++p) state_.caches.keep({n, p}, outputs[p]);
  }

  bool is_wanted(PortRef p) const { return p.port >= 64 || ((wanted_[p.node] >> p.port) & 1) != 0; }

  void decide_unused(std::size_t n) {
    std::vector<std::string> unused;
    const auto& outputs = state_.graph.nodes[n].type->outputs;
    for (std::size_t p = 0; p < outputs.size(); ++p)
      if (!is_wanted({n, p})) unused.push_back(outputs[p].name);
    if (unused.empty()) return;
    state_.decided(n, {{std::string(unused_outputs),
                        off_exact(fmt::format("nobody reads {}", fmt::join(unused, ", ")), unused.size())}});
  }

  void check_health(std::size_t n, std::size_t port, const Buffer& b) {
    if (b.type().health == nullptr) return;
    Health h = b.health();
    if (h.finite()) return;
    const GraphNode& node = state_.graph.nodes[n];
    const Culprit culprit{node.id, node.type->outputs[port].name, h.first, {}, h};
    state_.caches.said(n, culprit);
    state_.culprit(culprit, n);
  }

  void prepare_node(std::size_t n) {
    const GraphNode& node = state_.graph.nodes[n];
    state_.observe([&](Observer& o) { o.started(node.id); });
    const auto start = state_.now();
    Context ctx = context(n);
    const auto found = state_.caches.find_prepared(n, ctx.wanted_outputs);
    auto ready = found ? std::static_pointer_cast<const ReadyNode>(found) : prepare(n, ctx);
    if (found)
      replay(n);
    else
      state_.caches.keep_prepared(n, ctx.wanted_outputs, ready, ready->bytes);
    state_.set_ready(n, std::move(ready));
    report(n, ctx, WorkDone::Kind::prepare, start, 0, found ? CacheVerdict::hit : CacheVerdict::miss);
  }

  std::shared_ptr<const ReadyNode> prepare(std::size_t n, Context& ctx) {
    const GraphNode& node = state_.graph.nodes[n];
    std::vector<PreparedInput> inputs(node.inputs.size());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (node.type->inputs[i].tiled && !node.inputs[i].empty())
        inputs[i] = streaming(node.inputs[i].front());
      else
        for (const Source& s : node.inputs[i]) inputs[i].buffers.push_back(value(s));
    }
    auto ready = std::make_shared<ReadyNode>();
    const FloatEnvironment environment;
    ready->node = node.type->prepare(inputs, node.params.get(), ctx);
    ready->bytes = ctx.claimed();
    for (const PreparedInput& in : inputs)
      ready->planes_read.push_back(in.tiled.planes_read ? *in.tiled.planes_read : std::vector<bool>());
    return ready;
  }

  // What a tiled input sees at preparation: the frame of the node that will stream, or of pixels that were whole before
  // the run. What this run makes whole is not looked at: a pass may be publishing it.
  PreparedInput streaming(const Source& source) const {
    PreparedInput in;
    const auto* from = std::get_if<PortRef>(&source);
    if (from != nullptr && state_.graph.nodes[from->node].type->is_pixel() && is_wanted(*from)) {
      in.tiled.frame = state_.frame(*from);
    } else {
      const Buffer whole = value(source);
      in.tiled.frame = std::make_shared<const Frame>(whole.type().raster(whole.data()).frame());
    }
    in.tiled.planes_read = std::make_shared<std::vector<bool>>(in.tiled.frame->planes.size(), false);
    return in;
  }

  void report(std::size_t n, const Context& ctx, WorkDone::Kind kind, std::chrono::nanoseconds start,
              std::uint64_t bytes, CacheVerdict verdict = CacheVerdict::miss) {
    const GraphNode& node = state_.graph.nodes[n];
    for (const auto& [code, message] : ctx.warnings()) {
      state_.caches.said(n, code, message);
      state_.warning(n, code, message);
    }
    state_.decided(n, ctx.verdicts());
    const auto time = state_.now() - start;
    state_.caches.ran(n, time);
    if (state_.options.only_facts) {
      const std::uint64_t live = state_.ledger.live();
      state_.tell({.nodes = {node.id}, .least = live, .most = live});
    }
    state_.observe([&](Observer& o) {
      o.done({kind,
              {node.id},
              start,
              time,
              bytes,
              state_.caches.any() ? verdict : CacheVerdict::off,
              std::max(0, tbb::this_task_arena::current_thread_index()),
              ctx.counters()});
    });
  }

  // ----- the end

  RunResult result() {
    RunResult r;
    r.end = end_;
    r.caching = state_.caches.finish(r.end == End::done);
    r.cache_differs = state_.caches.differs();
    replay_notes(r.caching);
    for (const NodeCaching& c : r.caching) state_.observe([&](Observer& o) { o.cached(c); });
    state_.take_results(r);
    if (r.end == End::done)
      for (const std::size_t o : state_.options.demand.outputs)
        r.files.push_back(output_path(state_.graph.outputs[o], state_.options));
    return r;
  }

  RunState state_;
  std::vector<std::atomic<std::size_t>> waiting_;
  std::vector<std::uint64_t> wanted_;
  std::atomic<End> end_{End::done};
  std::atomic<bool> stopped_{false}, memory_told_{false};
};

// Outputs whose file is one that the graph reads.
Diagnostics overwriting_outputs(const Graph& graph, const RunOptions& options) {
  Diagnostics problems;
  std::optional<std::vector<std::string>> own;  // looked for where there is something to write over
  std::error_code none;
  for (const std::size_t i : options.demand.outputs) {
    const GraphOutput& output = graph.outputs[i];
    const std::string path = output_path(output, options);
    if (!std::filesystem::exists(path, none)) continue;
    if (!own) own = own_files(graph);
    auto d = overwriting(*own, path, fmt::format("output '{}'", output.name));
    if (!d) continue;
    d->pointer = output.place.pointer, d->file = output.place.file;
    d->line = output.place.line, d->column = output.place.column;
    problems.add(std::move(*d));
  }
  return problems;
}

// Outputs that write one file now that {frame} is a number.
Diagnostics outputs_of_one_file(const Graph& graph, const RunOptions& options) {
  Diagnostics problems;
  std::map<std::string, const GraphOutput*> first;
  for (const std::size_t i : options.demand.outputs) {
    const GraphOutput& output = graph.outputs[i];
    const std::string path = output_path(output, options);
    const auto [same, is_new] =
        first.try_emplace(std::filesystem::path(path).lexically_normal().string(), &output);
    if (is_new) continue;
    const SourcePlace &at = output.place, &other = same->second->place;
    problems.add(
        {.code = "duplicate_file",
         .pointer = at.pointer,
         .message = fmt::format("'{}' and '{}' both write {}", same->second->name, output.name, path),
         .expected = "a file for each output",
         .got = output.file,
         .related = {{.pointer = other.pointer,
                      .message = fmt::format("'{}' writes it here", same->second->name),
                      .line = other.line,
                      .column = other.column}},
         .file = at.file,
         .line = at.line,
         .column = at.column});
  }
  return problems;
}

}  // namespace

std::string_view name_of(CacheVerdict v) {
  switch (v) {
    case CacheVerdict::off: return "off";
    case CacheVerdict::miss: return "miss";
    case CacheVerdict::hit: return "hit";
    case CacheVerdict::not_needed: return "not_needed";
  }
  return "";
}

std::string output_path(const GraphOutput& output, const RunOptions& options) {
  std::string name = output.file;
  const std::string mark = "{frame}", number = fmt::format("{:04}", options.frame.value_or(0));
  for (std::size_t at = 0; (at = name.find(mark, at)) != std::string::npos; at += number.size())
    name.replace(at, mark.size(), number);
  return (std::filesystem::path(options.out_folder) / name).string();
}

RunResult run_graph(const Graph& graph, const RunOptions& options) {
  NewFolders folders;
  if (!options.only_facts) {
    RunResult refused;
    refused.problems = overwriting_outputs(graph, options), refused.end = End::failed;
    refused.problems.add(outputs_of_one_file(graph, options));
    if (refused.problems.has_errors()) return refused;
    for (const std::size_t i : options.demand.outputs) folders.above(output_path(graph.outputs[i], options));
  }
  const int threads = options.threads > 0 ? options.threads : tbb::this_task_arena::max_concurrency();
  // More threads than processors are allowed: results do not depend on it, and tests show that.
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
  // Idle pages count with what the process holds, but not with what the run may hold.
  constexpr std::uint64_t idle = std::uint64_t{256} << 20;
  keep_idle_pages(options.memory == 0 ? idle : std::min(idle, options.memory / 32));
  tbb::task_arena arena(threads);
  RunResult result = arena.execute([&] { return Runner(graph, options).run(); });
  if (result.end == End::done) folders.keep();
  return result;
}

}  // namespace frustum
