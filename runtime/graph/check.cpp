#include "runtime/graph/check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <functional>
#include <queue>

namespace frustum {
namespace {

template <class Visit>
void each_feeder(const FlatNode& node, Visit visit) {
  for (const auto& edges : node.inputs)
    for (const Edge& edge : edges)
      if (edge.kind == Edge::Kind::port) visit(edge);
}

// ----- order and cycles

// Kahn 1962 with a heap: of the nodes that are ready the first of the file comes first. Nodes on or behind cycles are left.
std::vector<std::size_t> sorted(const Flat& flat) {
  std::vector<std::size_t> missing(flat.nodes.size());
  std::vector<std::vector<std::size_t>> readers(flat.nodes.size());
  for (std::size_t i = 0; i < flat.nodes.size(); ++i)
    each_feeder(flat.nodes[i], [&](const Edge& e) {
      readers[e.from.node].push_back(i);
      ++missing[i];
    });
  std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>> ready;
  for (std::size_t i = 0; i < flat.nodes.size(); ++i)
    if (missing[i] == 0) ready.push(i);
  std::vector<std::size_t> order;
  order.reserve(flat.nodes.size());
  while (!ready.empty()) {
    const std::size_t node = ready.top();
    ready.pop();
    order.push_back(node);
    for (const std::size_t reader : readers[node])
      if (--missing[reader] == 0) ready.push(reader);
  }
  return order;
}

// Of a longer ring only the end is told.
constexpr std::size_t most_named = 12;

void report_cycle(const Flat& flat, std::vector<const Edge*> ring, std::vector<std::size_t> nodes,
                  Diagnostics& problems) {
  // Edge i feeds nodes[i] from nodes[i + 1]. It is told from the first of the file, in the direction of the data.
  const auto first = std::min_element(nodes.begin(), nodes.end()) - nodes.begin();
  std::rotate(nodes.begin(), nodes.begin() + first, nodes.end());
  std::rotate(ring.begin(), ring.begin() + first, ring.end());
  const std::size_t shown = std::min(nodes.size() - 1, most_named);
  std::string path = flat.nodes[nodes[0]].id;
  if (shown < nodes.size() - 1) path += " -> ...";
  for (std::size_t i = shown + 1; i-- > 0;) path += " -> " + flat.nodes[nodes[i]].id;
  const FlatNode& start = flat.nodes[nodes[0]];
  Diagnostic d{.code = "cycle",
               .pointer = ring[0]->link->pointer,
               .message = fmt::format("these nodes feed each other in a ring: {}", path),
               .expected = "links without a ring",
               .got = path};
  for (std::size_t i = shown + 1; i-- > 1;) {
    const FlatNode& node = flat.nodes[nodes[i]];
    const SourceText& text = *node.instance->document->text;
    const TextPlace at = text.value_place(ring[i]->link->pointer);
    d.related.push_back(
        {.pointer = ring[i]->link->pointer,
         .message = fmt::format("'{}' reads '{}' here", node.id, flat.nodes[ring[i]->from.node].id),
         .line = at.line,
         .column = at.column,
         .file = text.file()});
  }
  report_inside(problems, *start.instance, std::move(d));
}

// One cycle of every knot of cycles: a walk from reader to feeder, back edges of which no node was reported yet.
void find_cycles(const Flat& flat, const std::vector<std::size_t>& order, Diagnostics& problems) {
  enum : char { fresh, open, done };
  std::vector<char> state(flat.nodes.size(), fresh), reported(flat.nodes.size(), 0);
  for (const std::size_t i : order) state[i] = done;
  struct Step {
    std::size_t node;
    std::vector<const Edge*> feeders;
    std::size_t next = 0;
  };
  for (std::size_t root = 0; root < flat.nodes.size(); ++root) {
    if (state[root] != fresh) continue;
    std::vector<Step> way;
    const auto enter = [&](std::size_t node) {
      state[node] = open;
      way.push_back({node, {}});
      each_feeder(flat.nodes[node], [&](const Edge& e) { way.back().feeders.push_back(&e); });
    };
    enter(root);
    while (!way.empty()) {
      Step& top = way.back();
      if (top.next == top.feeders.size()) {
        state[top.node] = done;
        way.pop_back();
        continue;
      }
      const std::size_t feeder = top.feeders[top.next++]->from.node;
      if (state[feeder] == fresh) {
        enter(feeder);
      } else if (state[feeder] == open) {
        std::vector<std::size_t> nodes;
        std::vector<const Edge*> ring;
        auto step = std::find_if(way.begin(), way.end(), [&](const Step& s) { return s.node == feeder; });
        bool is_new = true;
        for (; step != way.end(); ++step) {
          is_new = is_new && reported[step->node] == 0;
          nodes.push_back(step->node);
          ring.push_back(step->feeders[step->next - 1]);
        }
        for (const std::size_t n : nodes) reported[n] = 1;
        if (is_new) report_cycle(flat, ring, nodes, problems);
      }
    }
  }
}

// ----- kinds and spaces

std::vector<std::string> names_of(Spaces spaces) {
  std::vector<std::string> out;
  for (const auto& [space, name] : choices(Space{}))
    if (spaces.has(space)) out.emplace_back(name);
  return out;
}

bool have_common(Spaces a, Spaces b) {
  for (const auto& [space, name] : choices(Space{}))
    if (a.has(space) && b.has(space)) return true;
  return false;
}

std::string names_of(const std::vector<const BufferType*>& kinds) {
  std::vector<std::string_view> names;
  for (const BufferType* k : kinds) names.push_back(k->name);
  return fmt::format("{}", fmt::join(names, " or "));
}

class Inference {
 public:
  Inference(Flat& flat, Checked& checked, Diagnostics& problems)
      : flat_(flat), checked_(checked), problems_(problems) {}

  void visit(FlatNode& node, std::vector<PortFacts>& outputs) {
    for (std::size_t i = 0; i < node.inputs.size(); ++i)
      for (const Edge& edge : node.inputs[i]) check_edge(node, node.type().inputs[i], edge);
    infer(node, outputs);
    cascade(node);
  }

  void infer(const FlatNode& node, std::vector<PortFacts>& outputs) const {
    for (std::size_t o = 0; o < outputs.size(); ++o) {
      const Port& port = node.type().outputs[o];
      // An output of several kinds follows the first input of the same kinds.
      if (port.types.size() == 1)
        outputs[o].kind = port.types[0];
      else
        outputs[o].kind = first_of(node, [&](const Port& in) { return in.types == port.types; }).kind;
      outputs[o].spaces = port.spaces;
      if (!port.spaces.empty() || outputs[o].kind == nullptr) continue;
      // One that does not say keeps the space of the first input of its kind; what is made from another kind, such as a
      // mesh from a surface, that of the first input that is in one.
      outputs[o].spaces = first_of(node, [&](const Port& in) { return in.takes(*outputs[o].kind); }).spaces;
      if (outputs[o].spaces.empty()) outputs[o].spaces = first_space(node);
    }
  }

 private:
  template <class Accept>
  PortFacts first_of(const FlatNode& node, Accept accept) const {
    for (std::size_t i = 0; i < node.inputs.size(); ++i)
      if (accept(node.type().inputs[i]))
        return node.inputs[i].empty() ? PortFacts{} : facts_of(flat_, checked_, node.inputs[i][0]);
    return {};
  }

  Spaces first_space(const FlatNode& node) const {
    for (const auto& edges : node.inputs)
      if (!edges.empty())
        if (const Spaces s = facts_of(flat_, checked_, edges[0]).spaces; !s.empty()) return s;
    return {};
  }

  // The problem stands at the outermost link on the way that does not fit.
  void check_edge(const FlatNode& node, const Port& port, const Edge& edge) {
    const PortFacts facts = facts_of(flat_, checked_, edge);
    for (const Crossing& c : edge.crossings) {
      const DocumentInput& input = c.instance->document->inputs[c.input];
      if (input.kind == nullptr) return;
      const bool literal = edge.kind == Edge::Kind::literal;
      if (literal ? input.kind->from_json != nullptr : facts.kind == nullptr || facts.kind == input.kind)
        continue;
      const std::string reader =
          fmt::format("{}{}.{}", c.instance->parent->prefix, c.instance->node->id, input.name);
      return clash(*c.instance->parent, *c.link, edge, reader, std::string(input.kind->name), facts);
    }
    const std::string reader = fmt::format("{}.{}", node.id, port.name);
    if (edge.kind == Edge::Kind::literal) {
      const auto readable = [](const BufferType* t) { return t->from_json != nullptr; };
      if (std::none_of(port.types.begin(), port.types.end(), readable))
        clash(*node.instance, *edge.link, edge, reader, names_of(port.types), facts);
    } else if (facts.kind != nullptr && !port.takes(*facts.kind)) {
      clash(*node.instance, *edge.link, edge, reader, names_of(port.types), facts);
    } else if (!port.spaces.empty() && !facts.spaces.empty() && !have_common(port.spaces, facts.spaces)) {
      wrong_space(node, port, edge, facts);
    }
  }

  void clash(const Instance& at, const Link& link, const Edge& edge, const std::string& reader,
             const std::string& expected, const PortFacts& facts) {
    const bool literal = edge.kind == Edge::Kind::literal;
    const std::string got = literal ? "a literal" : std::string(facts.kind->name);
    Diagnostic d{
        .code = "wrong_type",
        .pointer = link.pointer,
        .message =
            literal ? fmt::format("'{}' takes {}, which has no literal form", reader, expected)
                    : fmt::format("{} ({}) cannot feed {} ({})", name_of(flat_, edge), got, reader, expected),
        .expected = expected,
        .got = got};
    add_feeder(d, edge);
    report_inside(problems_, at, std::move(d));
  }

  void wrong_space(const FlatNode& node, const Port& port, const Edge& edge, const PortFacts& facts) {
    const std::string expected = fmt::format("{}", fmt::join(names_of(port.spaces), " or "));
    const std::string got = fmt::format("{}", fmt::join(names_of(facts.spaces), " or "));
    Diagnostic d{.code = "wrong_space",
                 .pointer = edge.link->pointer,
                 .message = fmt::format("{} is in {} space, but {}.{} takes {} space", name_of(flat_, edge),
                                        got, node.id, port.name, expected),
                 .expected = expected,
                 .got = got};
    add_feeder(d, edge);
    report_inside(problems_, *node.instance, std::move(d));
  }

  void add_feeder(Diagnostic& d, const Edge& edge) const {
    if (edge.kind != Edge::Kind::port) return;
    const FlatNode& feeder = flat_.nodes[edge.from.node];
    const SourceText& text = *feeder.instance->document->text;
    const TextPlace at = text.key_place(feeder.node->pointer);
    d.related.push_back({.pointer = feeder.node->pointer,
                         .message = fmt::format("'{}' ({}) stands here", feeder.id, feeder.type().name),
                         .line = at.line,
                         .column = at.column,
                         .file = text.file()});
  }

  // A node that needs what is left out is left out itself, within the graph whose input is optional; outside it is an error.
  void cascade(FlatNode& node) {
    for (std::size_t i = 0; i < node.inputs.size(); ++i) {
      const Port& port = node.type().inputs[i];
      if (port.list || port.optional) continue;
      for (const Edge& edge : node.inputs[i]) {
        const LeftOut missing = left_out_by(flat_, edge);
        if (missing.graph == nullptr) continue;
        if (node.instance->is_inside(missing.graph)) {
          node.left_out = missing;
          continue;
        }
        report_inside(
            problems_, *node.instance,
            {.code = "left_out",
             .pointer = edge.link->pointer,
             .message = fmt::format("{}; '{}.{}' needs it", why_left_out(edge, missing), node.id, port.name),
             .expected = "the optional input",
             .got = "nothing"});
      }
    }
  }

  Flat& flat_;
  Checked& checked_;
  Diagnostics& problems_;
};

}  // namespace

LeftOut left_out_by(const Flat& flat, const Edge& edge) {
  LeftOut missing;
  if (edge.kind == Edge::Kind::left_out || edge.kind == Edge::Kind::open)
    missing = {edge.instance, edge.input};
  if (edge.kind == Edge::Kind::port) missing = flat.nodes[edge.from.node].left_out;
  if (missing.graph == nullptr) return missing;
  // A graph that takes it as an optional input of its own goes without.
  for (const Crossing& c : edge.crossings)
    if (c.instance->document->inputs[c.input].optional) missing = {c.instance, c.input};
  return missing;
}

std::string why_left_out(const Edge& edge, const LeftOut& missing) {
  const std::string& prefix = missing.graph->prefix;
  return fmt::format("'{}' is left out, since the optional input '{}' of '{}' is not given", edge.link->text,
                     missing.graph->document->inputs[missing.input].name,
                     prefix.substr(0, prefix.size() - 1));
}

std::string name_of(const Flat& flat, const Edge& edge) {
  if (edge.kind != Edge::Kind::port) return edge.link->text.empty() ? "a literal" : edge.link->text;
  const FlatNode& node = flat.nodes[edge.from.node];
  return fmt::format("{}.{}", node.id, node.type().outputs[edge.from.port].name);
}

PortFacts facts_of(const Flat&, const Checked& checked, const Edge& edge) {
  if (edge.kind == Edge::Kind::port) return checked.facts[edge.from.node][edge.from.port];
  if (edge.kind == Edge::Kind::open || edge.kind == Edge::Kind::left_out)
    return {edge.instance->document->inputs[edge.input].kind, {}};
  return {};
}

Checked check(Flat& flat, Diagnostics& problems) {
  Checked checked;
  for (const FlatNode& node : flat.nodes) {
    checked.facts.emplace_back(node.type().outputs.size());
    for (std::size_t o = 0; o < node.type().outputs.size(); ++o) {
      // What holds in a ring too.
      const Port& port = node.type().outputs[o];
      if (port.types.size() == 1) checked.facts.back()[o] = {port.types[0], port.spaces};
    }
  }
  checked.order = sorted(flat);
  Inference inference(flat, checked, problems);
  for (const std::size_t i : checked.order) inference.visit(flat.nodes[i], checked.facts[i]);
  if (checked.order.size() == flat.nodes.size()) return checked;
  find_cycles(flat, checked.order, problems);
  std::vector<char> seen(flat.nodes.size(), 0);
  for (const std::size_t i : checked.order) seen[i] = 1;
  for (std::size_t i = 0; i < flat.nodes.size(); ++i)
    if (seen[i] == 0) inference.visit(flat.nodes[i], checked.facts[i]);
  return checked;
}

}  // namespace frustum
