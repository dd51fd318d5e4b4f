#include "runtime/app/effects/prove.h"

#include "runtime/app/effects/plan_effects.h"
#include "runtime/app/metrics/difference.h"
#include "runtime/app/observers.h"
#include "runtime/core/archive.h"
#include "runtime/core/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <set>

namespace frustum {
namespace {

using End = RunResult::End;
using Kind = Verdict::Kind;

std::uint64_t differing_bits(const std::byte* a, const std::byte* b, std::size_t bytes) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < bytes; ++i)
    bits += static_cast<std::uint64_t>(std::popcount(std::to_integer<unsigned>(a[i] ^ b[i])));
  return bits;
}

std::uint64_t differing_bits(const Raster& a, const Raster& b) {
  const Frame& f = a.frame();
  const Tile x = a.view(), y = b.view();
  std::uint64_t bits = 0;
  for (std::size_t p = 0; p < f.planes.size(); ++p)
    for (int s = 0; s < f.samples(); ++s)
      for (int row = f.window.y0; row < f.window.y1; ++row) {
        const int plane = static_cast<int>(p);
        const auto start = [&](const Tile& t) {
          return f.planes[p].kind == PlaneKind::f64
                     ? reinterpret_cast<const std::byte*>(t.row<double>(plane, s, row))
                 : f.planes[p].kind == PlaneKind::f32
                     ? reinterpret_cast<const std::byte*>(t.row<float>(plane, s, row))
                     : reinterpret_cast<const std::byte*>(t.row<std::uint32_t>(plane, s, row));
        };
        bits += differing_bits(start(x), start(y),
                               static_cast<std::size_t>(f.window.width()) * bytes_of(f.planes[p].kind));
      }
  return bits;
}

bool same_shape(const Frame& a, const Frame& b) {
  return a.window == b.window && a.samples() == b.samples() && a.planes == b.planes;
}

class Bytes : public ArchiveWriter {
 public:
  explicit Bytes(const Buffer& b) { b.type().save(b.data(), *this); }
  void raw(const void* data, std::size_t bytes) override {
    const auto* from = static_cast<const std::byte*>(data);
    all.insert(all.end(), from, from + bytes);
  }
  void shared(const std::shared_ptr<const void>& storage, std::size_t bytes) override {
    raw(storage.get(), bytes);
  }
  std::vector<std::byte> all;
};

// ----- what is compared

std::vector<ProvedLayer> layers_of(const Graph& graph, const Demand& demand) {
  std::vector<ProvedLayer> layers;
  const auto add = [&](const std::string& name, PortRef port) {
    for (ProvedLayer& l : layers)
      if (l.port == port) return void(l.name = fmt::format("{}, {}", name, l.name));
    layers.push_back({fmt::format("{} = {}", name, graph.name(port)), port, {}, {}});
  };
  for (const std::size_t o : demand.outputs)
    for (const OutputLayer& l : graph.outputs[o].layers)
      add(l.name.empty() ? graph.outputs[o].name : graph.outputs[o].name + ":" + l.name, l.from);
  for (const PortRef p : demand.ports)
    if (std::none_of(layers.begin(), layers.end(), [&](const ProvedLayer& l) { return l.port == p; }))
      layers.push_back({graph.name(p), p, {}, {}});
  return layers;
}

// Buffers that are no pixels and come after a shortcut that was taken.
void leave_out_after_shortcuts(const Graph& graph, const std::vector<NodeVerdict>& verdicts,
                               std::vector<ProvedLayer>& layers) {
  std::vector<std::string> shortcut(graph.nodes.size());  // the nearest one upstream
  for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
    for (const auto& list : graph.nodes[n].inputs)
      for (const Source& s : list)
        if (const auto* from = std::get_if<PortRef>(&s); from && !shortcut[from->node].empty())
          shortcut[n] = shortcut[from->node];
    for (const EffectDoc& doc : graph.nodes[n].type->effects)
      for (const NodeVerdict& v : verdicts)
        if (doc.shortcut && v.node == graph.nodes[n].id && v.effect == doc.name &&
            v.verdict.kind == Kind::off_exact)
          shortcut[n] = v.node;
  }
  for (ProvedLayer& l : layers)
    if (const std::string& node = shortcut[l.port.node];
        !node.empty() && !graph.port(l.port).types[0]->is_pixels())
      l.left_out = fmt::format("'{}' takes a shortcut, which changes geometry and no picture", node);
}

// The runs of a proof: all at once, then each name that was off somewhere.
std::vector<ProvedRun> runs_of(const std::vector<NodeVerdict>& verdicts) {
  std::vector<ProvedRun> runs{{.forced = "", .nodes = {}}, {.forced = "all", .nodes = {}}};
  for (const NodeVerdict& v : verdicts) {
    if (v.verdict.kind != Kind::off_exact || !is_simulated(v.effect)) continue;
    const auto at =
        std::find_if(runs.begin() + 2, runs.end(), [&](const ProvedRun& r) { return r.forced == v.effect; });
    if (at == runs.end())
      runs.push_back({.forced = v.effect, .nodes = {v.node}});
    else
      at->nodes.push_back(v.node);
  }
  return runs;
}

EffectPolicy policy_of(const ProvedRun& run) {
  EffectPolicy policy;
  policy.force_all = run.forced == "all";
  if (!run.forced.empty() && !policy.force_all) policy.forced.insert(run.forced);
  return policy;
}

// ----- running

class Prover {
 public:
  Prover(Session& session, const Graph& graph, const Demand& demand, const ProveOptions& options)
      : session_(session), graph_(graph), options_(options) {
    proof_.layers = layers_of(graph, demand);
  }

  Proof run() {
    ProvedRun planned;
    const auto found = timed(planned);
    if (!found) return std::move(proof_);
    proof_.verdicts = found->verdicts;
    leave_out_after_shortcuts(graph_, proof_.verdicts, proof_.layers);
    for (ProvedLayer& l : proof_.layers) l.digest = found->buffers.at(l.port).digest();
    proof_.runs = runs_of(proof_.verdicts);
    // The first run of a process meets cold memory and loads libraries: it is compared with, and not timed.
    for (std::size_t i = 1; i < proof_.runs.size(); ++i) {
      ProvedRun& r = proof_.runs[i];
      const auto forced = timed(r);
      if (!forced) return std::move(proof_);
      compare(*found, *forced, r);
      r.times.clear();
    }
    time_in_turns();
    return std::move(proof_);
  }

 private:
  std::optional<RunResult> timed(ProvedRun& r) {
    RunOptions o;
    for (const ProvedLayer& l : proof_.layers) o.demand.ports.push_back(l.port);
    o.threads = options_.threads;
    o.cancel = options_.cancel;
    o.effects = policy_of(r);
    const auto began = std::chrono::steady_clock::now();
    RunResult result = session_.run(graph_, o, false);
    r.times.push_back(std::chrono::steady_clock::now() - began);
    if (result.end == End::done) return result;
    proof_.end = result.end;
    proof_.problems = std::move(result.problems);
    return std::nullopt;
  }

  void compare(const RunResult& planned, const RunResult& forced, ProvedRun& r) {
    for (const ProvedLayer& l : proof_.layers) {
      if (!l.left_out.empty()) continue;
      const Buffer &a = planned.buffers.at(l.port), &b = forced.buffers.at(l.port);
      if (b.digest() == l.digest) continue;
      const Difference d = frustum::compare(b, a);
      LayerDifference found{l.name, std::max<std::uint64_t>(1, frustum::differing_bits(a, b)), d.mismatch};
      if (d.worst)
        found.worst = fmt::format("{}: {:.9g} and not {:.9g}", d.worst->place(), d.worst->a, d.worst->b);
      r.differences.push_back(std::move(found));
    }
  }

  // Turns, so that whatever else slows the machine slows all alike.
  void time_in_turns() {
    for (int i = 0; i < options_.repeats; ++i)
      for (ProvedRun& r : proof_.runs)
        if (!timed(r)) return;
  }

  Session& session_;
  const Graph& graph_;
  const ProveOptions& options_;
  Proof proof_;
};

double milliseconds(std::chrono::nanoseconds t) {
  return std::chrono::duration<double, std::milli>(t).count();
}

double times_faster(const Proof& p) {
  const auto planned = p.runs[0].median_time(), forced = p.runs[1].median_time();
  return static_cast<double>(forced.count()) /
         static_cast<double>(std::max<std::int64_t>(1, planned.count()));
}

std::string plural(std::uint64_t n, std::string_view what) {
  return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
}

}  // namespace

std::uint64_t differing_bits(const Buffer& a, const Buffer& b) {
  if (a.type().is_pixels() && b.type().is_pixels()) {
    const Raster &x = a.type().raster(a.data()), &y = b.type().raster(b.data());
    if (same_shape(x.frame(), y.frame())) return differing_bits(x, y);
  }
  if (&a.type() != &b.type() || a.type().save == nullptr) return a.digest() == b.digest() ? 0 : 1;
  const std::vector<std::byte> x = Bytes(a).all, y = Bytes(b).all;
  const auto [least, most] = std::minmax({x.size(), y.size()});
  return differing_bits(x.data(), y.data(), least) + 8 * (most - least);
}

std::chrono::nanoseconds ProvedRun::median_time() const {
  return times.empty() ? std::chrono::nanoseconds{0} : median(times);
}

std::size_t Proof::skipped() const {
  return static_cast<std::size_t>(std::count_if(verdicts.begin(), verdicts.end(), [](const NodeVerdict& v) {
    return v.verdict.kind == Kind::off_exact && is_simulated(v.effect);
  }));
}

std::uint64_t Proof::differing_bits() const {
  std::uint64_t bits = 0;
  for (const ProvedRun& r : runs)
    for (const LayerDifference& d : r.differences) bits += d.bits;
  return bits;
}

Proof prove_effects(Session& session, const Graph& graph, const Demand& demand, const ProveOptions& options) {
  return Prover(session, graph, demand, options).run();
}

Json to_json(const Proof& p) {
  Json layers = Json::array(), runs = Json::array();
  for (const ProvedLayer& l : p.layers) {
    Json j = {{"layer", l.name}, {"digest", to_hex(l.digest)}, {"compared", l.left_out.empty()}};
    if (!l.left_out.empty()) j["why"] = l.left_out;
    layers.push_back(std::move(j));
  }
  for (const ProvedRun& r : p.runs) {
    Json differences = Json::array();
    for (const LayerDifference& d : r.differences)
      differences.push_back({{"layer", d.layer}, {"bits", d.bits}, {"worst", d.worst}});
    runs.push_back({{"forced", r.forced},
                    {"nodes", r.nodes},
                    {"median_ms", milliseconds(r.median_time())},
                    {"differences", differences}});
  }
  return {{"holds", p.holds()},
          {"skipped", p.skipped()},
          {"times_faster", times_faster(p)},
          {"bits_differ", p.differing_bits()},
          {"layers", layers},
          {"runs", runs}};
}

std::string proof_text(const Proof& p) {
  std::vector<std::vector<std::string>> rows{{"forced", "time", "more", "bits that differ", "of"}};
  const double planned = milliseconds(p.runs[0].median_time());
  std::string where;
  for (const ProvedRun& r : p.runs) {
    const double ms = milliseconds(r.median_time());
    std::uint64_t bits = 0;
    for (const LayerDifference& d : r.differences) {
      bits += d.bits;
      where += fmt::format("{} forced: {} in {}{}{}\n", r.forced, plural(d.bits, "bit"), d.layer,
                           d.worst.empty() ? "" : ", most at ", d.worst);
    }
    const bool as_planned = r.forced.empty();
    rows.push_back({as_planned ? "nothing" : r.forced, fmt::format("{:.2f} ms", ms),
                    as_planned ? "" : fmt::format("{:+.0f} %", planned > 0 ? 100 * (ms / planned - 1) : 0),
                    as_planned ? "" : std::to_string(bits), fmt::format("{}", fmt::join(r.nodes, ", "))});
  }
  std::string out = aligned(rows) + where;
  for (const ProvedLayer& l : p.layers)
    out += l.left_out.empty() ? fmt::format("{}  {}\n", l.name, to_hex(l.digest))
                              : fmt::format("{}  not compared: {}\n", l.name, l.left_out);
  const std::size_t repeats = p.runs[0].times.size();
  out += fmt::format("{} skipped, {:.2f}x faster than with all of them ({} of each in turns), {} differ\n",
                     plural(p.skipped(), "effect"), times_faster(p), plural(repeats, "run"),
                     plural(p.differing_bits(), "bit"));
  return out;
}

}  // namespace frustum
