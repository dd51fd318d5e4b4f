#include "runtime/graph/load.h"

#include "runtime/core/read_file.h"
#include "runtime/graph/check.h"
#include "runtime/graph/output_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>
#include <tuple>

namespace frustum {
namespace {

constexpr std::size_t absent = ~std::size_t{0};

// From what was checked to a Graph, which holds only what can run.
class Builder {
 public:
  Builder(const Document& doc, Flat& flat, const Checked& checked, const LoadOptions& options,
          Diagnostics& problems)
      : doc_(doc),
        flat_(flat),
        checked_(checked),
        options_(options),
        problems_(problems),
        index_(flat.nodes.size(), absent) {}

  Graph build() {
    graph_.title = doc_.title;
    graph_.file = doc_.file();
    graph_.seed = doc_.seed;
    for (const std::size_t i : checked_.order)
      if (flat_.nodes[i].left_out.graph == nullptr) add_node(i);
    for (const DocumentOutput& output : doc_.outputs) add_output(output);
    name_ports(*flat_.top);
    return std::move(graph_);
  }

 private:
  // Of a node: where its name stands.
  static SourcePlace place_of(const SourceText& text, const std::string& pointer) {
    const TextPlace at = text.key_place(pointer);
    return {text.file(), pointer, at.line, at.column};
  }

  static SourcePlace value_place(const SourceText& text, const std::string& pointer,
                                 const std::string& setting = {}) {
    const TextPlace at = text.value_place(pointer);
    return {text.file(), pointer, at.line, at.column, setting};
  }

  void add_node(std::size_t i) {
    FlatNode& flat = flat_.nodes[i];
    GraphNode node{.id = flat.id,
                   .type = flat.node->type,
                   .params = flat.params.values,
                   .inputs = std::vector<std::vector<Source>>(flat.inputs.size()),
                   .precision = flat.precision,
                   .place = place_of(*flat.instance->document->text, flat.node->pointer),
                   .parts = {}};
    for (const FlatParams::Place& p : flat.params.places)
      node.parts.emplace_back(at_param(p.name), value_place(*p.text, p.pointer, p.setting));
    for (std::size_t p = 0; p < flat.inputs.size(); ++p) {
      const std::string part = at_input(flat.type().inputs[p].name);
      if (!flat.inputs[p].empty())
        node.parts.emplace_back(part, value_place(*flat.instance->document->text, flat.node->pointer + part));
      for (const Edge& edge : flat.inputs[p])
        if (auto source = source_of(edge, flat.type().inputs[p]))
          node.inputs[p].push_back(std::move(*source));
    }
    index_[i] = graph_.nodes.size();
    graph_.nodes.push_back(std::move(node));
  }

  std::optional<Source> source_of(const Edge& edge, const Port& port) {
    if (const auto from = port_of(edge)) return *from;
    if (edge.kind != Edge::Kind::literal) return std::nullopt;
    const BufferType* kind = nullptr;
    for (const BufferType* t : port.types)
      if (kind == nullptr && t->from_json != nullptr) kind = t;
    if (kind == nullptr) return std::nullopt;
    Buffer literal = read_literal(edge, *kind, options_, problems_);
    return literal ? std::optional<Source>(std::move(literal)) : std::nullopt;
  }

  std::optional<PortRef> port_of(const Edge& edge) const {
    if (edge.kind != Edge::Kind::port || index_[edge.from.node] == absent) return std::nullopt;
    return PortRef{index_[edge.from.node], edge.from.port};
  }

  void add_output(const DocumentOutput& output) {
    GraphOutput out{.name = output.name,
                    .file = output.file,
                    .whole = output.whole,
                    .bits = output.bits,
                    .compression = output.compression,
                    .layers = {},
                    .place = value_place(*doc_.text, output.pointer + "/file")};
    for (const DocumentLayer& layer : output.layers) {
      int budget = 1000000;
      for (const Edge& edge : follow(*flat_.top, layer.from, problems_, budget)) {
        check_layer(output, edge);
        const BufferType* kind = facts_of(flat_, checked_, edge).kind;
        out.whole = out.whole || (kind != nullptr && !kind->is_pixels() && is_saved_whole(output, *kind));
        if (const auto from = port_of(edge)) out.layers.push_back({layer.name, *from});
      }
    }
    if (out.layers.empty()) return;
    if (out.file.empty())
      graph_.port_names.push_back({out.name, out.layers[0].from});
    else
      graph_.outputs.push_back(std::move(out));
  }

  void check_layer(const DocumentOutput& output, const Edge& edge) {
    const PortFacts facts = facts_of(flat_, checked_, edge);
    const LeftOut missing = left_out_by(flat_, edge);
    if (missing.graph != nullptr && missing.graph != flat_.top.get()) {
      report(problems_, *doc_.text,
             {.code = "left_out",
              .pointer = edge.link->pointer,
              .message = why_left_out(edge, missing),
              .expected = "the optional input",
              .got = "nothing"});
    } else if (!output.file.empty() && facts.kind != nullptr) {
      check_kind(output, edge, *facts.kind);
    }
  }

  std::vector<std::string> forms_of(const BufferType& kind) const {
    return options_.saved_as ? options_.saved_as(kind) : std::vector<std::string>();
  }
  // A kind that is no picture may have a form in a format of pictures: fragments are saved as deep EXR.
  bool is_saved_whole(const DocumentOutput& output, const BufferType& kind) const {
    const std::vector<std::string> forms = forms_of(kind);
    const bool plain = output.layers.size() == 1 && output.layers[0].name.empty() && output.bits == 0 &&
                       output.compression.empty();
    return (plain || output.whole) &&
           std::find(forms.begin(), forms.end(), extension_of(output.file)) != forms.end();
  }

  void check_kind(const DocumentOutput& output, const Edge& edge, const BufferType& kind) {
    const std::vector<std::string> forms = forms_of(kind);
    if ((kind.is_pixels() && !output.whole) || is_saved_whole(output, kind)) return;
    report(problems_, *doc_.text,
           {.code = "wrong_type",
            .pointer = edge.link->pointer,
            .message = fmt::format(
                "{} ({}) cannot be written to '{}': {}", name_of(flat_, edge), kind.name, output.file,
                output.whole ? "such a file holds another kind of buffer" : "pictures hold pixels"),
            .expected = output.whole ? fmt::format("a file for a {}: {}", kind.name, fmt::join(forms, ", "))
                        : forms.empty() ? "a port of pixels"
                                        : fmt::format("a port of pixels, or a file for a {}: {}", kind.name,
                                                      fmt::join(forms, ", ")),
            .got = std::string(kind.name)});
  }

  // "draw.image" for every port of every graph used as a node, and "draw" for its first.
  void name_ports(const Instance& instance) {
    for (const Instance::Member& member : instance.members) {
      if (member.graph == nullptr) continue;
      const Instance& child = *member.graph;
      const std::string id = child.prefix.substr(0, child.prefix.size() - 1);
      bool first = true;
      for (const DocumentOutput& output : child.document->outputs) {
        if (output.layered || output.layers.empty()) continue;
        Diagnostics known;
        for (const Edge& edge : follow(child, output.layers[0].from, known, naming_budget_)) {
          const auto from = port_of(edge);
          if (!from) continue;
          if (first) graph_.port_names.push_back({id, *from});
          graph_.port_names.push_back({fmt::format("{}.{}", id, output.name), *from});
        }
        first = false;
      }
      name_ports(child);
    }
  }

  const Document& doc_;
  Flat& flat_;
  const Checked& checked_;
  const LoadOptions& options_;
  Diagnostics& problems_;
  std::vector<std::size_t> index_;  // of flat nodes in the graph
  int naming_budget_ = 1000000;  // hops of all names together: graphs that only pass things on multiply them
  Graph graph_;
};

// What is right but of no use. Only of the file that the user named: a library serves more graphs than this one.
void warn(const Document& doc, Diagnostics& problems) {
  const auto warning = [&](std::string code, std::string pointer, std::string message, std::string expected) {
    Diagnostic d{.code = std::move(code),
                 .severity = Severity::warning,
                 .pointer = std::move(pointer),
                 .message = std::move(message),
                 .expected = std::move(expected)};
    report(problems, *doc.text, std::move(d), true);
  };
  if (doc.outputs.empty() && !doc.text->json().contains("outputs"))
    warning("no_outputs", "", "the graph has no \"outputs\": a run of it writes nothing", "outputs");
  else
    for (const DocumentNode& node : doc.nodes)
      if (!node.used)
        warning("unused_node", node.pointer, fmt::format("nothing reads '{}', so it does not run", node.id),
                "a link or an output that reads it");
  for (const WrittenParam& p : doc.params)
    if (!doc.params_used.contains(p.name))
      warning("unused_parameter", p.pointer, fmt::format("nothing takes '${}'", p.name),
              fmt::format("a parameter that is \"${}\"", p.name));
  for (const DocumentInput& input : doc.inputs) {
    if (!input.used)
      warning("unused_input", input.pointer, fmt::format("nothing reads '${}'", input.name),
              fmt::format("an input that is \"${}\"", input.name));
    else if (!input.optional && input.kind != nullptr)
      warning("open_input", input.pointer,
              fmt::format("'{}' is given only where this graph is used as a node: what needs it does not run",
                          input.name),
              "a graph that uses this one as a node");
  }
}

using Place = std::tuple<std::string, std::string>;

// Problems that follow from a number that could not be read, and repetitions by a file that is used several times, go. The rest
// is ordered as it stands in the files, the user's file first.
void tidy(Diagnostics& problems, const std::string& top) {
  std::set<Place> not_finite;
  for (const Diagnostic& d : problems.list())
    if (d.code == "not_finite") not_finite.emplace(d.file, d.pointer);
  // What is said of a parameter follows from the numbers in it.
  const auto holds_one = [&](const Diagnostic& d) {
    if (d.pointer.find("/params/") == std::string::npos) return false;
    const auto in = not_finite.lower_bound({d.file, d.pointer + "/"});
    return in != not_finite.end() && std::get<0>(*in) == d.file &&
           std::get<1>(*in).starts_with(d.pointer + "/");
  };
  const auto follows = [&](const Diagnostic& d) {
    if (d.code == "not_finite") return false;
    const auto here = [&](const Related& r) {
      return not_finite.contains({r.file.empty() ? d.file : r.file, r.pointer});
    };
    return not_finite.contains({d.file, d.pointer}) || holds_one(d) ||
           std::any_of(d.related.begin(), d.related.end(), here);
  };
  auto& list = problems.list();
  if (!not_finite.empty()) std::erase_if(list, follows);

  const auto rank = [&](const Diagnostic& d) {
    return std::tuple(d.file != top, std::string_view(d.file), d.line, d.column);
  };
  std::stable_sort(list.begin(), list.end(),
                   [&](const Diagnostic& a, const Diagnostic& b) { return rank(a) < rank(b); });
  std::set<std::tuple<std::string, std::string, std::string, std::string, int, int>> seen;
  std::erase_if(list, [&](const Diagnostic& d) {
    return !seen.emplace(d.file, d.code, d.pointer, d.message, d.line, d.column).second;
  });
}

}  // namespace

Loaded load_graph_text(const std::string& text, const std::string& path, const Registry& registry,
                       const LoadOptions& options) {
  Loaded loaded;
  Documents documents(registry, options.library_folders, loaded.problems, options.saved_as);
  if (const auto doc = documents.read(text, path)) {
    Flat flat = flatten(*doc, options, loaded.problems);
    const Checked checked = check(flat, loaded.problems);
    warn(*doc, loaded.problems);
    Graph graph = Builder(*doc, flat, checked, options, loaded.problems).build();
    if (!loaded.problems.has_errors()) loaded.graph = std::move(graph);
  }
  tidy(loaded.problems, path);
  return loaded;
}

Loaded load_graph(const std::string& path, const Registry& registry, const LoadOptions& options) {
  return load_graph_text(read_file(path), path, registry, options);
}

}  // namespace frustum
