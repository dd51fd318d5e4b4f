#include "runtime/graph/flatten.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

// Graphs of graphs multiply: 30 files that use the next one twice are 2^30 nodes. What people write stays far below.
constexpr std::size_t most_nodes = 100000;
constexpr int most_edges = 1000000;
// Of graphs that a link passes through: it is followed by recursion. Enough to leave the innermost graph
// and enter another.
constexpr std::size_t most_hops = 2 * Documents::max_levels;

class Flattener {
 public:
  Flattener(const LoadOptions& options, Diagnostics& problems) : options_(options), problems_(problems) {}

  Flat flatten(const Document& document) {
    Flat flat{.top = std::make_unique<Instance>(), .nodes = {}};
    Instance& top = *flat.top;
    top.document = &document;
    top.precision = options_.precision.value_or(document.precision.value_or(Precision::single));
    for (const WrittenParam& p : document.params) top.params[p.name] = default_of(document, p);
    apply_settings(top, options_, problems_);
    add_members(top, flat);
    int budget = most_edges;
    for (FlatNode& node : flat.nodes) connect(node, budget);
    if (budget < 0) too_large(top, fmt::format("{} links", most_edges));
    return flat;
  }

 private:
  void add_members(Instance& instance, Flat& flat) {
    instance.members.resize(instance.document->nodes.size());
    for (std::size_t i = 0; i < instance.members.size(); ++i) {
      if (flat.nodes.size() + instances_ > most_nodes) return;
      const DocumentNode& node = instance.document->nodes[i];
      if (node.graph != nullptr) {
        instance.members[i].graph = enter(instance, node);
        add_members(*instance.members[i].graph, flat);
      } else if (node.type != nullptr) {
        instance.members[i].flat = flat.nodes.size();
        flat.nodes.push_back({.node = &node,
                              .instance = &instance,
                              .id = instance.prefix + node.id,
                              .precision = node.precision.value_or(instance.precision),
                              .params = read_params(node, instance, options_, problems_),
                              .inputs = std::vector<std::vector<Edge>>(node.type->inputs.size())});
      }
    }
    if (flat.nodes.size() + instances_ > most_nodes) too_large(instance, fmt::format("{} nodes", most_nodes));
  }

  void too_large(const Instance& instance, const std::string& limit) {
    if (too_large_) return;
    too_large_ = true;
    const Instance* at = &instance;
    while (at->parent != nullptr && at->parent->parent != nullptr) at = at->parent;
    const bool inside = at->parent != nullptr;
    report(problems_, inside ? *at->parent->document->text : *at->document->text,
           {.code = "too_large",
            .pointer = inside ? at->node->pointer : "",
            .message = fmt::format("with the graphs used as nodes this is more than {}", limit),
            .expected = "at most " + limit});
  }

  // "$$" is a '$' of the text itself here too; a "$name" stands for nothing, which the reader has reported.
  static GivenValue default_of(const Document& doc, const WrittenParam& p) {
    auto value = substitute(*p.value, Instance{});
    return {std::make_shared<const Json>(value ? std::move(*value) : *p.value), doc.folder, doc.text.get(),
            p.pointer};
  }

  // Values are taken in the scope of the parent, where they are written; what comes from further outside is stronger.
  std::unique_ptr<Instance> enter(const Instance& parent, const DocumentNode& node) {
    ++instances_;
    auto child = std::make_unique<Instance>();
    const Document& doc = *node.graph;
    child->document = &doc;
    child->parent = &parent;
    child->node = &node;
    child->prefix = fmt::format("{}{}/", parent.prefix, node.id);
    const auto own = options_.precision ? std::nullopt : doc.precision;
    child->precision = node.precision.value_or(own.value_or(parent.precision));
    for (const WrittenParam& p : doc.params) child->params[p.name] = default_of(doc, p);
    for (const WrittenParam& p : node.params) give(child->params[p.name], p, parent);
    for (const WrittenParam& p : node.overrides) {
      GivenValue value;
      if (give(value, p, parent)) child->overrides[p.name] = std::move(value);
    }
    const std::string inside = node.id + "/", own_params = node.id + ":";
    for (auto o = parent.overrides.lower_bound(node.id);
         o != parent.overrides.end() && o->first.starts_with(node.id); ++o) {
      if (o->first.starts_with(inside))
        child->overrides[o->first.substr(inside.size())] = o->second;
      else if (o->first.starts_with(own_params))
        child->params[o->first.substr(own_params.size())] = o->second;
    }
    return child;
  }

  static bool give(GivenValue& out, const WrittenParam& written, const Instance& scope) {
    const GivenValue* used = nullptr;
    auto value = substitute(*written.value, scope, &used);
    if (!value) return false;
    const bool whole = used != nullptr && written.value->is_string();
    if (whole && !used->setting.empty())
      out = *used;
    else
      out = {std::make_shared<const Json>(std::move(*value)), whole ? used->folder : scope.document->folder,
             scope.document->text.get(), written.pointer};
    return true;
  }

  void connect(FlatNode& node, int& budget) {
    for (const Binding& binding : node.node->inputs) {
      std::vector<Edge>& edges = node.inputs[binding.input];
      for (const Link& link : binding.links)
        for (Edge& edge : follow(*node.instance, link, problems_, budget)) edges.push_back(std::move(edge));
    }
  }

  const LoadOptions& options_;
  Diagnostics& problems_;
  std::size_t instances_ = 0;
  bool too_large_ = false;
};

// Walks one link; keeps the way it came, so that graphs that only pass data round in a ring are seen.
class Follower {
 public:
  Follower(Diagnostics& problems, int& budget) : problems_(problems), budget_(budget) {}

  std::vector<Edge> follow(const Instance& scope, const Link& first) {
    first_ = &first;
    first_scope_ = &scope;
    walk(scope, first, {});
    return std::move(out_);
  }

 private:
  void walk(const Instance& scope, const Link& link, const std::vector<Crossing>& crossings) {
    if (--budget_ < 0) return;
    const std::pair step{&scope, &link};
    if (std::find(way_.begin(), way_.end(), step) != way_.end()) return ring();
    if (way_.size() == most_hops) return too_long();
    way_.push_back(step);
    if (link.node)
      from_node(scope, link, crossings);
    else if (link.input)
      from_input(scope, link, crossings);
    else if (link.literal != nullptr)
      add({.kind = Edge::Kind::literal,
           .literal = link.literal,
           .instance = &scope,
           .literal_pointer = link.pointer,
           .crossings = crossings});
    else
      add({.kind = Edge::Kind::bad, .crossings = crossings});
    way_.pop_back();
  }

  void from_node(const Instance& scope, const Link& link, const std::vector<Crossing>& crossings) {
    if (scope.members.size() <= *link.node) return add({.kind = Edge::Kind::bad, .crossings = crossings});
    const Instance::Member& member = scope.members[*link.node];
    if (member.flat)
      return add({.kind = Edge::Kind::port, .from = {*member.flat, link.port}, .crossings = crossings});
    if (member.graph == nullptr) return add({.kind = Edge::Kind::bad, .crossings = crossings});
    const DocumentOutput& output = member.graph->document->outputs[link.port];
    if (!output.layers.empty()) walk(*member.graph, output.layers[0].from, crossings);
  }

  void from_input(const Instance& scope, const Link& link, const std::vector<Crossing>& crossings) {
    const DocumentInput& input = scope.document->inputs[*link.input];
    if (scope.parent == nullptr)
      return add(
          {.kind = Edge::Kind::open, .instance = &scope, .input = *link.input, .crossings = crossings});
    const auto& bindings = scope.node->inputs;
    const auto given = std::find_if(bindings.begin(), bindings.end(),
                                    [&](const Binding& b) { return b.input == *link.input; });
    if (given == bindings.end()) {
      const auto kind = input.optional ? Edge::Kind::left_out : Edge::Kind::bad;
      return add({.kind = kind, .instance = &scope, .input = *link.input, .crossings = crossings});
    }
    for (const Link& outer : given->links) {
      std::vector<Crossing> more{{&scope, *link.input, &outer}};
      more.insert(more.end(), crossings.begin(), crossings.end());
      walk(*scope.parent, outer, more);
    }
  }

  void add(Edge edge) {
    edge.link = first_;
    out_.push_back(std::move(edge));
  }

  void too_long() {
    add({.kind = Edge::Kind::bad});
    report_inside(
        problems_, *first_scope_,
        {.code = "too_deep",
         .pointer = first_->pointer,
         .message = fmt::format("'{}' is passed on by more than {} graphs", first_->text, most_hops),
         .expected = fmt::format("at most {} graphs on the way", most_hops),
         .got = first_->text});
  }

  void ring() {
    add({.kind = Edge::Kind::bad});
    report_inside(problems_, *first_scope_,
                  {.code = "cycle",
                   .pointer = first_->pointer,
                   .message = fmt::format("'{}' leads back to itself through graphs that only pass it on",
                                          first_->text),
                   .expected = "a link that ends at a node",
                   .got = first_->text});
  }

  Diagnostics& problems_;
  int& budget_;
  const Link* first_ = nullptr;
  const Instance* first_scope_ = nullptr;
  std::vector<std::pair<const Instance*, const Link*>> way_;
  std::vector<Edge> out_;
};

}  // namespace

bool Instance::is_inside(const Instance* other) const {
  for (const Instance* i = this; i != nullptr; i = i->parent)
    if (i == other) return true;
  return false;
}

Flat flatten(const Document& document, const LoadOptions& options, Diagnostics& problems) {
  return Flattener(options, problems).flatten(document);
}

std::vector<Edge> follow(const Instance& scope, const Link& link, Diagnostics& problems, int& budget) {
  return Follower(problems, budget).follow(scope, link);
}

void report_inside(Diagnostics& problems, const Instance& instance, Diagnostic d, bool at_key) {
  for (const Instance* i = &instance; i->parent != nullptr; i = i->parent) {
    const SourceText& text = *i->parent->document->text;
    const TextPlace at = text.key_place(i->node->pointer);
    d.related.push_back(
        {.pointer = i->node->pointer,
         .message = fmt::format("used here as '{}'", i->prefix.substr(0, i->prefix.size() - 1)),
         .line = at.line,
         .column = at.column,
         .file = text.file()});
  }
  report(problems, *instance.document->text, std::move(d), at_key);
}

}  // namespace frustum
