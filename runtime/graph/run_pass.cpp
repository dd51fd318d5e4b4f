#include "runtime/graph/pass_output.h"
#include "runtime/graph/pixel_run.h"
#include "runtime/graph/run_effects.h"
#include "runtime/graph/run_state.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>

namespace frustum {
namespace {

// One pass being run: the operations, what is read from memory, and who wants the pixels.
class Pass {
 public:
  Pass(RunState& state, const PixelPass& pass) : state_(state), graph_(state.graph), pass_(pass) {}

  void run() {
    build_ops();
    find_roots();
    decide_unread();
    decide_blank();
    cut_where_margins_are_wide();
    open_sinks();
    const int edge = fit_memory();
    const auto start = state_.now();
    const PixelOutcome outcome = walk(edge);
    for (auto& sink : sinks_) sink->finish();
    count_tiles(outcome.worker_bytes);
    report(outcome, start);
    state_.caches.ran_pass(pass_.nodes, state_.now() - start);
    publish();
    keep_streamed();
  }

  void decide() {
    build_ops();
    for (const PixelPass::Root& root : pass_.roots) add_root(root.port);
    for (const std::size_t o : pass_.outputs)
      for (const OutputLayer& layer : graph_.outputs[o].layers)
        if (!state_.buffer(layer.from)) add_root(layer.from);
    decide_unread();
    decide_blank();
    tell_need();
  }

 private:
  // ----- building

  void build_ops() {
    for (const std::size_t n : pass_.nodes) {
      const GraphNode& node = graph_.nodes[n];
      const auto ready = state_.ready(n);
      TileOp op{.type = node.type, .prepared = {ready, &ready->node}, .inputs = {}, .planes_read = {}};
      for (const auto& frame : ready->node.frames) op.planes_read.emplace_back(frame->planes.size(), false);
      for (std::size_t i = 0; i < node.inputs.size(); ++i)
        op.inputs.push_back(input(node, i, ready->planes_read[i]));
      op_of_[n] = ops_.size();
      ops_.push_back(std::move(op));
    }
  }

  TileInput input(const GraphNode& node, std::size_t i, const std::vector<bool>& planes_read) {
    TileInput in;
    if (!node.type->inputs[i].tiled || node.inputs[i].empty()) return in;
    const Source& source = node.inputs[i].front();
    const auto* from = std::get_if<PortRef>(&source);
    const Buffer whole = from != nullptr ? state_.buffer(*from) : std::get<Buffer>(source);
    if (whole) {
      in.whole = whole.type().raster(whole.data());
    } else {
      in.op = op_of_.at(from->node);
      in.port = from->port;
      auto& read = ops_[*in.op].planes_read[in.port];
      for (std::size_t p = 0; p < read.size(); ++p)
        if (planes_read[p]) read[p] = true;
    }
    return in;
  }

  // Planes that nobody reads are not filled, unless a run is asked to fill them all the same.
  void decide_unread() {
    for (std::size_t i = 0; i < ops_.size(); ++i) {
      TileOp& op = ops_[i];
      std::vector<std::string> unread;
      std::uint64_t numbers = 0;
      for (std::size_t port = 0; port < op.planes_read.size(); ++port) {
        const Frame& f = *op.prepared->frames[port];
        const auto samples = static_cast<std::uint64_t>(f.window.area() * f.samples());
        for (std::size_t p = 0; p < f.planes.size(); ++p) {
          if (op.planes_read[port][p]) continue;
          const auto& ports = op.type->outputs;
          unread.push_back(ports.size() == 1 ? f.planes[p].name : ports[port].name + "." + f.planes[p].name);
          numbers += samples;
          op.planes_read[port][p] = state_.options.effects.forces(unread_planes);
        }
      }
      if (unread.empty()) continue;
      state_.decided(pass_.nodes[i],
                     {{std::string(unread_planes),
                       off_exact(fmt::format("nobody reads {}", fmt::join(unread, ", ")), numbers)}});
    }
  }

  // Where nothing is seen, nodes that are blank there do not run, unless a run is asked to compute it all the same.
  void decide_blank() {
    if (std::none_of(ops_.begin(), ops_.end(), [](const TileOp& op) { return op.type->blank_where; })) return;
    const std::vector<TileProgram::Pixels> pixels = TileProgram(ops_, roots_).count_blank();
    for (std::size_t i = 0; i < ops_.size(); ++i) {
      ops_[i].everywhere = state_.options.effects.forces(blank_pixels);
      if (pixels[i].blank == 0) continue;
      const auto samples = static_cast<std::uint64_t>(ops_[i].prepared->frames.front()->samples());
      state_.decided(pass_.nodes[i],
                     {{std::string(blank_pixels), off_exact(fmt::format("nothing is seen in {} of {} pixels",
                                                                        pixels[i].blank, pixels[i].all),
                                                            pixels[i].blank * samples)}});
    }
  }

  std::size_t add_root(PortRef port) {
    const std::size_t op = op_of_.at(port.node);
    ops_[op].planes_read[port.port].assign(ops_[op].planes_read[port.port].size(), true);
    roots_.push_back({op, port.port});
    return roots_.size() - 1;
  }

  const Frame& frame(const TileRoot& r) const { return *ops_[r.op].prepared->frames[r.port]; }

  Rect cut_to_region(Rect r) const {
    return state_.options.region ? intersection(r, *state_.options.region) : r;
  }

  void find_roots() {
    for (const PixelPass::Root& root : pass_.roots) {
      add_root(root.port);
      Frame f = frame(roots_.back());
      if (root.why == Whole::demanded) f.window = cut_to_region(f.window);
      area_ = hull(area_, f.window);
      state_.check_memory(raster_bytes(f));
      whole_.emplace_back(Raster(std::move(f), Contents::anything));
    }
    for (const std::size_t o : pass_.outputs) {
      SinkJob job;
      for (const OutputLayer& layer : graph_.outputs[o].layers) {
        const Buffer whole = state_.buffer(layer.from);
        if (whole) {
          if (!whole.type().is_pixels())
            throw NodeError("not_pixels", fmt::format("output '{}': {} is no picture", graph_.outputs[o].name,
                                                      graph_.name(layer.from)));
          job.layers.push_back({whole.type().raster(whole.data())});
        } else {
          job.layers.push_back({add_root(layer.from)});
          whole_.push_back(whole_for_cache(layer.from));
        }
        area_ = hull(area_, cut_to_region(layer_frame(job.layers.back()).window));
      }
      jobs_.push_back(std::move(job));
    }
  }

  // A picture that only streams into a file, made whole besides where the cache wants to keep it.
  std::optional<Raster> whole_for_cache(PortRef port) {
    const Frame& f = frame(roots_.back());
    const bool again =
        std::any_of(streamed_.begin(), streamed_.end(), [&](const auto& s) { return s.first == port; });
    if (again || !state_.caches.wants_whole(port, raster_bytes(f))) return std::nullopt;
    streamed_.emplace_back(port, roots_.size() - 1);
    return Raster(f);
  }

  const Frame& layer_frame(const SinkSource& s) const {
    const auto* root = std::get_if<std::size_t>(&s.from);
    return root != nullptr ? frame(roots_[*root]) : std::get<Raster>(s.from).frame();
  }

  static std::uint64_t raster_bytes(const Frame& f) {
    return f.bytes_per_pixel() * static_cast<std::uint64_t>(padded_row(f.window.width())) *
           static_cast<std::uint64_t>(f.window.height());
  }

  // A wide filter would make every tile recompute more than half again of what feeds it: that is made whole first.
  void cut_where_margins_are_wide() {
    if (state_.options.tile_edge != 0) return;
    for (;;) {
      const TileProgram program(ops_, roots_);
      const int edge = program.choose_edge();
      const auto estimate = program.estimate(edge);
      if (!estimate.worst || estimate.area_ratio <= 1.5 || small_picture(edge)) return;
      make_whole_early(*estimate.worst);
    }
  }

  // A picture that is hardly more than one tile recomputes nothing.
  bool small_picture(int edge) const { return area_.width() <= 2 * edge && area_.height() <= 2 * edge; }

  void make_whole_early(std::size_t op) {
    std::vector<TileRoot> roots;
    PixelJob job;
    for (std::size_t port = 0; port < ops_[op].planes_read.size(); ++port) {
      auto& read = ops_[op].planes_read[port];
      if (std::find(read.begin(), read.end(), true) == read.end()) continue;
      read.assign(read.size(), true);
      roots.push_back({op, port});
      Frame f = frame(roots.back());
      job.region = hull(job.region, f.window);
      state_.check_memory(raster_bytes(f));
      job.whole.emplace_back(Raster(std::move(f), Contents::anything));
      early_bytes_ += job.whole.back()->bytes();
      state_.ledger.add_bytes(job.whole.back()->bytes());
    }
    // The operations up to this one; those that feed others only fill nothing, since nobody asks them.
    const std::vector<TileOp> upto(ops_.begin(), ops_.begin() + static_cast<std::ptrdiff_t>(op) + 1);
    const TileProgram program(upto, roots);
    job.program = &program;
    job.cancel = state_.options.cancel;
    early_.push_back(run_pixels(job).costs);
    for (TileOp& later : ops_)
      for (TileInput& in : later.inputs)
        for (std::size_t r = 0; r < roots.size(); ++r)
          if (in.op == op && in.port == roots[r].port) {
            in.op.reset();
            in.whole = job.whole[r];
          }
  }

  // What the pass would hold at once if it ran now: what is made whole and the tiles of every thread, and, where files are
  // slower than pixels, the bands on their way to them.
  void tell_need() {
    if (roots_.empty()) return;
    std::uint64_t need = 0, bands = 0;
    for (std::size_t i = 0; i < roots_.size(); ++i) {
      const Frame& f = frame(roots_[i]);
      area_ = hull(area_, f.window);
      if (i < pass_.roots.size()) need += raster_bytes(f);
    }
    const TileProgram program(ops_, roots_);
    const int edge = state_.options.tile_edge > 0 ? state_.options.tile_edge : program.choose_edge();
    const TileProgram::Estimate estimate = program.estimate(edge);
    if (estimate.worst && estimate.area_ratio > 1.5 &&
        !small_picture(edge))  // as cut_where_margins_are_wide()
      for (const auto& made : ops_[*estimate.worst].prepared->frames) need += raster_bytes(*made);
    const std::uint64_t tile = state_.options.tile_edge > 0 ? estimate.live_bytes : tile_bytes(estimate);
    need += static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency()) * tile;
    for (std::size_t i = pass_.roots.size(); i < roots_.size(); ++i) bands += band_bytes(roots_[i], edge);
    const std::uint64_t live = state_.ledger.live() + need;
    MemoryNeed told{.nodes = {}, .pass = true, .least = live, .most = live + bands};
    for (const std::size_t n : pass_.nodes) told.nodes.push_back(graph_.nodes[n].id);
    state_.tell(told);
  }

  // Rows of tiles wait for those before them: four are on their way at most.
  std::uint64_t band_bytes(const TileRoot& root, int edge) const {
    return 4 * frame(root).bytes_per_pixel() * static_cast<std::uint64_t>(area_.width()) *
           static_cast<std::uint64_t>(edge);
  }

  // ----- sinks

  void open_sinks() {
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      const std::size_t index = pass_.outputs[i];
      const GraphOutput& output = graph_.outputs[index];
      SinkRequest request;
      for (std::size_t l = 0; l < output.layers.size(); ++l) {
        const Frame& f = layer_frame(jobs_[i].layers[l]);
        request.display_window = hull(request.display_window, f.window);
        request.layers.push_back({output.layers[l].name, sink_frame(f, {})});
        if (f.samples() > 1 && f.find("R"))
          warn_of_output(state_, output, "sampled_output",
                         fmt::format("{} has {} samples a pixel; the file gets the most central one: "
                                     "supersample.resolve would filter them",
                                     graph_.name(output.layers[l].from), f.samples()));
      }
      request.region = cut_to_region(request.display_window);
      for (SinkLayer& l : request.layers) l.frame.window = request.region;
      request.path = output_path(output, state_.options);
      request.bits = output.bits;
      request.compression = output.compression;
      request.metadata = state_.metadata();
      request.warn = [this, &output](std::string_view code, const std::string& message) {
        warn_of_output(state_, output, std::string(code), message);
      };
      if (request.region.empty()) {
        state_.output_failed(index);
        throw empty_region(output);
      }
      sinks_.push_back(std::make_unique<NamedSink>(state_, index, request));
      jobs_[i].sink = sinks_.back().get();
      jobs_[i].region = request.region;
    }
  }

  // ----- running

  // What the tiles hold that run_pixels() chooses for itself: twice as wide as high where no node reads beyond its own.
  static std::uint64_t tile_bytes(const TileProgram::Estimate& e) {
    return e.area_ratio <= 1 ? 2 * e.live_bytes : e.live_bytes;
  }

  // The edge of tiles that memory has room for; 0: those that run_pixels() chooses.
  int fit_memory() {
    if (state_.options.tile_edge != 0 || ops_.empty()) return state_.options.tile_edge;
    const TileProgram program(ops_, roots_);
    const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
    const auto fits = [&](int edge, std::uint64_t tile, bool or_throw) {
      std::uint64_t bands = 0;
      for (std::size_t r = 0; r < roots_.size(); ++r)
        if (!whole_[r]) bands += band_bytes(roots_[r], edge);
      try {
        state_.check_memory(tile * threads + bands + whole_bytes());
        return true;
      } catch (const NodeError&) {
        if (or_throw) throw;
        return false;
      }
    };
    const int usual = program.choose_edge();
    if (fits(usual, tile_bytes(program.estimate(usual)), false)) return 0;
    int edge = usual;
    while (!fits(edge, program.estimate(edge).live_bytes, edge <= 16)) edge /= 2;
    return edge;
  }

  std::uint64_t whole_bytes() const {
    std::uint64_t sum = 0;
    for (const auto& raster : whole_)
      if (raster) sum += raster->bytes();
    return sum;
  }

  PixelOutcome walk(int edge) {
    const TileProgram program(ops_, roots_);
    PixelJob job{.program = &program,
                 .whole = whole_,
                 .sinks = jobs_,
                 .region = area_,
                 .tile_edge = edge,
                 .cancel = state_.options.cancel,
                 .progress = {}};
    if (state_.options.observer != nullptr)
      job.progress = [this](double done) {
        state_.observe([&](Observer& o) { o.progress(last_node(), done); });
      };
    if (ops_.empty() && edge == 0) job.tile_edge = 64;
    return run_pixels(job);
  }

  std::string last_node() const {
    return pass_.nodes.empty() ? std::string() : graph_.nodes[pass_.nodes.back()].id;
  }

  void publish() {
    for (std::size_t i = 0; i < pass_.roots.size(); ++i) {
      const PortRef port = pass_.roots[i].port;
      const bool complete = whole_[i]->frame().window == frame(roots_[i]).window;
      // In a run of a region nodes stream what is only demanded, and may be looking at it now.
      const bool for_nodes = pass_.roots[i].why != Whole::demanded || !state_.options.region;
      const Buffer b = graph_.port(port).types.front()->from_raster(*whole_[i]);
      if (complete) state_.caches.keep(port, b);
      if (for_nodes)
        state_.publish(port, b);
      else
        state_.publish_part(port, b);
    }
    state_.ledger.remove_bytes(early_bytes_);
  }

  void keep_streamed() {
    for (const auto& [port, root] : streamed_)
      state_.caches.keep(port, graph_.port(port).types.front()->from_raster(*whole_[root]));
  }

  // ----- reporting

  // What the tiles and scratch memory of all threads were is known afterwards.
  void count_tiles(std::uint64_t bytes) {
    state_.ledger.add_bytes(bytes);
    state_.ledger.remove_bytes(bytes);
  }

  void report(const PixelOutcome& outcome, std::chrono::nanoseconds start) {
    std::vector<PixelNodeTime> times;
    WorkDone done{.kind = WorkDone::Kind::pixels,
                  .nodes = {},
                  .start = start,
                  .time = state_.now() - start,
                  .bytes = whole_bytes(),
                  .cache = CacheVerdict::off,
                  .thread = std::max(0, tbb::this_task_arena::current_thread_index()),
                  .counters = {}};
    for (std::size_t i = 0; i < ops_.size(); ++i) {
      const std::string& id = graph_.nodes[pass_.nodes[i]].id;
      PixelNodeTime t{id, outcome.costs.time[i], outcome.costs.pixels[i], 0};
      for (const TileCosts& c : early_)
        if (i < c.time.size()) t.time += c.time[i], t.pixels += c.pixels[i];
      const auto& frames = ops_[i].prepared->frames;
      if (!frames.empty() && frames.front())
        t.samples = t.pixels * static_cast<std::uint64_t>(frames.front()->samples());
      times.push_back(t);
      done.nodes.push_back(id);
    }
    done.counters.emplace_back("tile_edge", static_cast<std::uint64_t>(std::max(0, outcome.tile_edge)));
    done.counters.emplace_back("tile_bytes", outcome.worker_bytes);
    state_.observe([&](Observer& o) {
      o.done(done);
      o.pixel_times(times);
    });
    if (outcome.culprit) {
      const PixelCulprit& c = *outcome.culprit;
      const std::size_t node = pass_.nodes[c.op];
      const Culprit culprit{graph_.nodes[node].id, graph_.nodes[node].type->outputs[c.port].name,
                            c.health.first, c.inputs, c.health};
      state_.caches.said(node, culprit);
      state_.culprit(culprit, node);
    }
  }

  RunState& state_;
  const Graph& graph_;
  const PixelPass& pass_;
  std::vector<TileOp> ops_;
  std::map<std::size_t, std::size_t> op_of_;  // by graph node
  std::vector<TileRoot> roots_;
  std::vector<std::optional<Raster>> whole_;  // one a root
  std::vector<SinkJob> jobs_;
  std::vector<std::unique_ptr<Sink>> sinks_;
  std::vector<std::pair<PortRef, std::size_t>>
      streamed_;  // ports of files that are whole for the cache, and their roots
  std::vector<TileCosts> early_;
  std::uint64_t early_bytes_ = 0;  // of rasters made whole by a cut
  Rect area_;
};

}  // namespace

// An output that is no picture shares no pixel nodes with another, and so is alone in its pass.
void run_pass(RunState& state, std::size_t pass) {
  const PixelPass& p = state.plan.passes[pass];
  if (p.outputs.size() == 1 && state.graph.outputs[p.outputs.front()].whole)
    return save_output(state, state.graph.outputs[p.outputs.front()]);
  Pass(state, p).run();
}

void decide_pass(RunState& state, std::size_t pass) {
  const PixelPass& p = state.plan.passes[pass];
  if (!p.nodes.empty()) Pass(state, p).decide();
}

}  // namespace frustum
