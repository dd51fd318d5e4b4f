// Which knobs a sweep turns.
#include "runtime/app/sweep/sweep.h"
#include "runtime/core/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

// As a person writes it: 1, not 1.0.
std::string shown(const Json& value) {
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return value.is_string() ? value.get<std::string>() : value.dump();
}

// Every node whose output `want` depends on.
std::vector<bool> upstream(const Graph& graph, PortRef want) {
  std::vector<bool> needed(graph.nodes.size(), false);
  needed[want.node] = true;
  for (std::size_t n = graph.nodes.size(); n-- > 0;) {
    if (!needed[n]) continue;
    for (const auto& list : graph.nodes[n].inputs)
      for (const Source& s : list)
        if (const auto* from = std::get_if<PortRef>(&s)) needed[from->node] = true;
  }
  return needed;
}

std::string value_of(const GraphNode& node, const ParamField& f) {
  return shown(f.type->write(static_cast<const char*>(node.params.get()) + f.offset));
}

SweepKnob precision_knob(const Graph& graph, PortRef want) {
  return {"precision",
          {"single", "double"},
          graph.nodes[want.node].precision == Precision::single ? "single" : "double",
          "Every node in 24 or in 53 bits of significand.",
          std::nullopt};
}

// Calls f(address, node, field) for every declared knob upstream.
template <class F>
void each_declared(const Graph& graph, PortRef want, const F& f) {
  const auto needed = upstream(graph, want);
  for (std::size_t n = 0; n < graph.nodes.size(); ++n)
    for (const ParamField& field : graph.nodes[n].type->params.fields)
      if (needed[n] && field.knob) f(graph.nodes[n].id + ":" + field.name, graph.nodes[n], field);
}

// Splits at the commas outside of brackets and quotes: "[64,64],[128,128]" is two values.
std::vector<std::string> split_values(const std::string& text) {
  std::vector<std::string> out{""};
  int depth = 0;
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (!quoted) depth += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
    if (c == ',' && depth == 0 && !quoted)
      out.emplace_back();
    else
      out.back() += c;
  }
  return out;
}

// A graph parameter is what it feeds: the declared knob whose value follows it.
void adopt_declaration(Session& session, const Graph& graph, PortRef want, const SweepOptions& o,
                       SweepKnob& knob) {
  each_declared(graph, want, [&](const std::string& address, const GraphNode& node, const ParamField& f) {
    if (address == knob.address) {
      knob.current = value_of(node, f);
      knob.basis = f.knob->basis, knob.slope = f.knob->slope;
      if (knob.values.empty()) knob.values = f.knob->values;
    }
  });
  if (!knob.basis.empty() || knob.values.empty() || knob.address.find(':') != std::string::npos) return;
  LoadOptions turned = o.load;
  turned.settings.push_back({knob.address, knob.values.front()});
  const Loaded loaded = session.load(o.graph, turned);
  if (!loaded.graph || loaded.graph->nodes.size() != graph.nodes.size()) return;
  each_declared(graph, want, [&](const std::string&, const GraphNode& node, const ParamField& f) {
    const auto n = static_cast<std::size_t>(&node - graph.nodes.data());
    if (value_of(loaded.graph->nodes[n], f) == knob.values.front() &&
        value_of(node, f) != knob.values.front() && knob.basis.empty())
      knob.current = value_of(node, f), knob.basis = f.knob->basis, knob.slope = f.knob->slope;
  });
}

SweepKnob named_knob(Session& session, const Graph& graph, PortRef want, const SweepOptions& o,
                     const std::string& text) {
  const auto equals = text.find('=');
  SweepKnob knob{text.substr(0, equals), {}, {}, {}, {}};
  if (equals != std::string::npos) knob.values = split_values(text.substr(equals + 1));
  if (std::find(knob.values.begin(), knob.values.end(), "") != knob.values.end())
    throw NodeError("bad_knob", fmt::format("--knob {}: a value is empty", text));
  if (knob.address == "precision") {
    SweepKnob p = precision_knob(graph, want);
    if (!knob.values.empty()) p.values = knob.values;
    for (const std::string& v : p.values)
      if (v != "single" && v != "double")
        throw NodeError("bad_knob",
                        fmt::format("--knob {}: precision is single or double, not '{}'", text, v));
    return p;
  }
  adopt_declaration(session, graph, want, o, knob);
  if (knob.values.empty()) {
    std::vector<std::string> known{"precision"};
    each_declared(graph, want, [&](const std::string& address, const GraphNode&, const ParamField&) {
      known.push_back(address);
    });
    const auto near = nearest_names(knob.address, known);
    throw NodeError(
        "bad_knob",
        fmt::format("--knob {}: no knob of that address is declared here; write {}=V1,V2,...{}", text,
                    knob.address, near.empty() ? "" : fmt::format(" (did you mean '{}'?)", near.front())));
  }
  std::vector<std::string> sorted = knob.values;
  std::sort(sorted.begin(), sorted.end());
  if (knob.values.size() < 2 || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    throw NodeError("bad_knob",
                    fmt::format("--knob {}: at least two different values, from cheap to exact", text));
  return knob;
}

}  // namespace

std::vector<SweepKnob> sweep_knobs(Session& session, const Graph& graph, PortRef want,
                                   const SweepOptions& o) {
  std::vector<SweepKnob> knobs;
  for (const std::string& text : o.knobs) {
    SweepKnob knob = named_knob(session, graph, want, o, text);
    if (std::any_of(knobs.begin(), knobs.end(), [&](const auto& k) { return k.address == knob.address; }))
      throw NodeError("bad_knob",
                      fmt::format("--knob {}: it is turned already; list all its values once", text));
    knobs.push_back(std::move(knob));
  }
  if (!knobs.empty()) return knobs;
  each_declared(graph, want, [&](const std::string& address, const GraphNode& node, const ParamField& f) {
    if (!f.knob->taste)
      knobs.push_back({address, f.knob->values, value_of(node, f), f.knob->basis, f.knob->slope});
  });
  knobs.push_back(precision_knob(graph, want));
  return knobs;
}

}  // namespace frustum
