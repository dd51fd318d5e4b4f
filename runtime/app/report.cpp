#include "runtime/app/report.h"

#include "runtime/app/files.h"
#include "runtime/app/report/buffers.h"
#include "runtime/app/report/page.h"
#include "runtime/core/version.h"
#include "runtime/graph/load.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace frustum {
namespace {

double ms(std::chrono::nanoseconds t) { return std::chrono::duration<double, std::milli>(t).count(); }

// What each node, and each pass over tiles, took.
class Measured : public Observer {
 public:
  struct Node {
    double ms = 0;         // of a geometry node, or of a pixel node's preparation
    double pixels_ms = 0;  // in passes over tiles, summed over all threads
    std::uint64_t pixels = 0, bytes = 0;
    std::map<std::string, std::uint64_t> counters;
  };
  struct Pass {
    std::vector<std::string> nodes;
    double ms = 0;
    std::uint64_t bytes = 0;
    std::map<std::string, std::uint64_t> counters;
  };
  std::map<std::string, Node, std::less<>> nodes;
  std::vector<Pass> passes;

  void done(const WorkDone& w) override {
    if (w.kind == WorkDone::Kind::pixels) {
      passes.push_back({w.nodes, ms(w.time), w.bytes, {}});
      for (const auto& [name, n] : w.counters) passes.back().counters[name] += n;
      return;
    }
    Node& node = nodes[w.nodes.front()];
    node.ms += ms(w.time);
    node.bytes += w.bytes;
    for (const auto& [name, n] : w.counters) node.counters[name] += n;
  }
  void pixel_times(const std::vector<PixelNodeTime>& times) override {
    for (const PixelNodeTime& t : times) {
      nodes[t.node].pixels_ms += ms(t.time);
      nodes[t.node].pixels += t.pixels;
    }
  }
};

// ----- what is asked for

void ask(std::vector<PortRef>& ports, PortRef p) {
  if (std::find(ports.begin(), ports.end(), p) == ports.end()) ports.push_back(p);
}

void ask_layers(std::vector<PortRef>& ports, const GraphOutput& output) {
  for (const OutputLayer& layer : output.layers) ask(ports, layer.from);
}

// Only buffers are asked for: a report writes no file but its own.
std::vector<PortRef> asked_ports(const Graph& graph, const ReportOptions& options, Diagnostics& problems) {
  const Demand demand = demand_of(graph, options.wanted, problems);
  std::vector<PortRef> ports;
  for (const std::size_t o : demand.outputs) ask_layers(ports, graph.outputs[o]);
  for (const PortRef p : demand.ports) ask(ports, p);
  if (options.wanted.empty())
    for (const PortRef p : end_ports(graph)) ask(ports, p);
  if (!options.all) return ports;
  const Plan plan = make_plan(graph, {.ports = ports});
  for (const PlannedNode& n : plan.nodes)
    for (std::size_t p = 0; p < graph.nodes[n.node].type->outputs.size(); ++p) ask(ports, {n.node, p});
  return ports;
}

// ----- the page's data

Json node_json(const Graph& graph, std::size_t index, const Measured& measured) {
  const GraphNode& n = graph.nodes[index];
  const NodeType& type = *n.type;
  Json out = {{"id", n.id},
              {"type", type.name},
              {"family", type.name.substr(0, type.name.find('.'))},
              {"doc", type.doc},
              {"pixel", type.is_pixel()},
              {"precision", n.precision == Precision::single ? "single" : "double"},
              {"params", write_record(type.params, n.params.get())},
              {"inputs", Json::array()},
              {"outputs", Json::array()}};
  for (std::size_t i = 0; i < n.inputs.size(); ++i) {
    Json links = Json::array();
    for (const Source& s : n.inputs[i])
      links.push_back(std::holds_alternative<PortRef>(s) ? graph.name(std::get<PortRef>(s)) : "a literal");
    out["inputs"].push_back({{"name", type.inputs[i].name}, {"links", std::move(links)}});
  }
  for (const Port& p : type.outputs)
    out["outputs"].push_back(
        {{"name", p.name}, {"kind", p.types.front()->name}, {"color", p.types.front()->color}});
  if (const auto found = measured.nodes.find(n.id); found != measured.nodes.end()) {
    out["ms"] = found->second.ms;
    out["pixels_ms"] = found->second.pixels_ms;
    out["pixels"] = found->second.pixels;
    out["bytes"] = found->second.bytes;
    out["counters"] = found->second.counters;
  }
  return out;
}

Json edges_json(const Graph& graph, const Plan& plan) {
  Json edges = Json::array();
  for (const PlannedNode& planned : plan.nodes) {
    const GraphNode& n = graph.nodes[planned.node];
    for (std::size_t i = 0; i < n.inputs.size(); ++i)
      for (const Source& s : n.inputs[i])
        if (const auto* from = std::get_if<PortRef>(&s)) {
          const BufferType& kind = *graph.port(*from).types.front();
          edges.push_back({{"from", graph.nodes[from->node].id},
                           {"port", graph.port(*from).name},
                           {"to", n.id},
                           {"input", n.type->inputs[i].name},
                           {"kind", kind.name},
                           {"color", kind.color},
                           {"streams", n.type->inputs[i].tiled}});
        }
  }
  return edges;
}

Json plan_json(const Graph& graph, const Plan& plan, const Measured& measured) {
  Json passes = Json::array();
  for (const PixelPass& pass : plan.passes) {
    Json p = {{"nodes", Json::array()}, {"whole", Json::array()}};
    std::vector<std::string> ids;
    for (const std::size_t n : pass.nodes)
      p["nodes"].push_back(graph.nodes[n].id), ids.push_back(graph.nodes[n].id);
    for (const PixelPass::Root& r : pass.roots)
      p["whole"].push_back({{"port", graph.name(r.port)}, {"why", name_of(r.why)}});
    for (const Measured::Pass& m : measured.passes)
      if (m.nodes == ids) p["ms"] = m.ms, p["bytes"] = m.bytes, p["counters"] = m.counters;
    passes.push_back(std::move(p));
  }
  Json skipped = Json::array();
  for (const std::size_t n : plan.skipped) skipped.push_back(graph.nodes[n].id);
  return {{"steps", plan.steps.size()}, {"passes", std::move(passes)}, {"skipped", std::move(skipped)}};
}

// The graph's own parameters as its file states them, under what was set for this run.
Json params_json(const Graph& graph, const ReportOptions& options) {
  Json params = Json::object();
  if (!graph.file.empty()) {
    const Json file = Json::parse(read_text(graph.file), nullptr, false);
    if (file.is_object() && file.contains("params") && file["params"].is_object())
      for (const auto& [name, value] : file["params"].items()) params[name] = {{"value", value}};
  }
  for (const std::string& s : options.settings) {
    const auto equals = std::min(s.find('='), s.size() - 1);
    const Json value = Json::parse(s.substr(equals + 1), nullptr, false);
    params[s.substr(0, equals)] = {{"value", value.is_discarded() ? Json(s.substr(equals + 1)) : value},
                                   {"set", true}};
  }
  return params;
}

std::vector<std::string> names_of(const Graph& graph, PortRef port) {
  std::vector<std::string> names;
  for (const GraphOutput& o : graph.outputs)
    for (const OutputLayer& l : o.layers)
      if (l.from == port) names.push_back(l.name.empty() ? o.name : o.name + ":" + l.name);
  for (const PortName& n : graph.port_names)
    if (n.port == port && n.name.find_first_of("./") == std::string::npos) names.push_back(n.name);
  return names;
}

Json culprit_json(const Culprit& c) {
  return {{"node", c.node}, {"port", c.port}, {"where", c.where}, {"inputs", c.inputs}};
}

// ----- the page

}  // namespace

Report make_report(Session& session, const Graph& graph, const ReportOptions& options) {
  Report report;
  RunOptions run = options.run;
  run.demand.ports = asked_ports(graph, options, report.problems);
  if (report.problems.has_errors()) return report;
  Measured measured;
  run.observer = &measured;
  const auto began = std::chrono::steady_clock::now();
  report.result = session.run(graph, run, false);
  const double total_ms = ms(std::chrono::steady_clock::now() - began);
  report.problems.add(report.result.problems);
  if (report.result.end != RunResult::End::done) return report;

  const Plan plan = make_plan(graph, run.demand, {.fuse = run.fuse, .cropped = run.region.has_value()});
  Json data = {
      {"title", graph.title.empty() ? std::filesystem::path(graph.file).stem().string() : graph.title},
      {"file", graph.file},
      {"version", version},
      {"build", build_id()},
      {"params", params_json(graph, options)},
      {"run", {{"ms", total_ms}, {"peak_bytes", report.result.peak_bytes}, {"threads", run.threads}}},
      {"nodes", Json::array()},
      {"edges", edges_json(graph, plan)},
      {"plan", plan_json(graph, plan, measured)},
      {"buffers", Json::array()}};
  data.update(to_json(report.problems));
  if (report.result.culprit) data["culprit"] = culprit_json(*report.result.culprit);
  for (const PlannedNode& n : plan.nodes) data["nodes"].push_back(node_json(graph, n.node, measured));
  report::Blobs blobs;
  for (const PortRef port : run.demand.ports) {
    const auto found = report.result.buffers.find(port);
    if (found == report.result.buffers.end() || !found->second)
      continue;  // an output that the node did not make
    const Buffer& b = found->second;
    Json described = report::describe_buffer(b, blobs, options.most_values);
    described["port"] = graph.name(port);
    described["node"] = graph.nodes[port.node].id;
    described["names"] = names_of(graph, port);
    data["buffers"].push_back(std::move(described));
    report.ports.push_back(graph.name(port));
  }
  report.page = report::page_text(report::Page::run, data, blobs);
  return report;
}

}  // namespace frustum
