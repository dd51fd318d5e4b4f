// The catalogue's pages and the words they share with `frustum nodes`.
#include "runtime/app/catalog.h"
#include "runtime/app/course_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace frustum {
namespace {

std::string_view family_of(std::string_view node_type) { return node_type.substr(0, node_type.find('.')); }

std::string path_of(std::string_view node_type) {
  std::string path(node_type);
  path[path.find('.')] = '/';
  return path;
}

std::string in_table(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2))
    text.insert(at, "\\");
  return text;
}

std::string ports_table(std::string_view title, const std::vector<Port>& ports, bool input) {
  if (ports.empty()) return "";
  std::string out = fmt::format("\n## {}\n\n| name | kind | meaning |\n| --- | --- | --- |\n", title);
  for (const Port& p : ports)
    out += fmt::format("| `{}` | {}{}{}{} | {} |\n", p.name, type_names(p), p.list ? ", a list" : "",
                       input && p.optional ? ", may be left out" : "", space_names(p), in_table(p.doc));
  return out;
}

std::string field_rows(const ParamType& record, const void* defaults, const std::string& prefix) {
  std::string out;
  for (const ParamField& f : record.fields) {
    const void* member = defaults != nullptr ? static_cast<const char*>(defaults) + f.offset : nullptr;
    const std::string value = member != nullptr ? fmt::format("`{}`", f.type->write(member).dump()) : "";
    out += fmt::format("| `{}{}` | {} | {} | {} | {} |\n", prefix, f.name, in_table(value_text(*f.type)),
                       in_table(value), range_text(f.options), in_table(f.doc));
    const ParamType* inner = f.type;
    while (inner->element != nullptr) inner = inner->element;
    if (inner->kind == ParamType::Kind::record) out += field_rows(*inner, nullptr, prefix + f.name + ".");
  }
  return out;
}

std::string params_table(const NodeType& type) {
  if (type.params.fields.empty()) return "";
  const auto defaults = type.default_params();
  return "\n## Parameters\n\n| name | value | default | range | meaning |\n| --- | --- | --- | --- | --- "
         "|\n" +
         field_rows(type.params, defaults.get(), "");
}

std::string knobs_table(const NodeType& type) {
  std::string rows;
  for (const ParamField& f : type.params.fields)
    if (f.knob)
      rows += fmt::format("| `{}` | {} | {} | {} |\n", f.name, fmt::join(f.knob->values, ", "),
                          f.knob->taste   ? "taste"
                          : f.knob->slope ? fmt::format("{}", *f.knob->slope)
                                          : "",
                          in_table(f.knob->basis));
  if (rows.empty()) return "";
  return "\n## Knobs\n\nWhat `frustum sweep` turns, from cheap to exact; the slope is that of log(error) "
         "over "
         "log(value). Knobs of taste are swept only where they are named.\n\n| parameter | values | slope | "
         "why |\n"
         "| --- | --- | --- | --- |\n" +
         rows;
}

std::string effects_table(const NodeType& type) {
  if (type.effects.empty()) return "";
  std::string out =
      "\n## Effects\n\nWork that is left out where the scene does not call for it; `frustum plan` says "
      "where, and why "
      "([effects](../effects.md)).\n\n| effect | what is done where it is on | one costs |\n| --- | --- | "
      "--- |\n";
  for (const EffectDoc& e : type.effects)
    out += fmt::format("| `{}`{} | {} | {} |\n", e.name, e.shortcut ? " (a shortcut)" : "", in_table(e.doc),
                       cost_text(e.cost));
  return out;
}

}  // namespace

std::string cost_text(const EffectCost& cost) {
  if (cost.item.empty()) return "";
  const double two_digits = cost.ns < 100 ? cost.ns : std::round(cost.ns / 10) * 10;
  return fmt::format("{:.{}g} ns a {}", two_digits, two_digits < 100 ? 2 : 4, cost.item);
}

std::string type_names(const Port& port) {
  std::vector<std::string_view> names;
  for (const BufferType* t : port.types) names.push_back(t->name);
  return fmt::format("{}", fmt::join(names, " or "));
}

std::string space_names(const Port& port) {
  std::vector<std::string_view> names;
  for (const auto& [space, name] : choices(Space{}))
    if (port.spaces.has(space)) names.push_back(name);
  return names.empty() ? "" : fmt::format(", in {} space", fmt::join(names, " or "));
}

std::string value_text(const ParamType& type) {
  using Kind = ParamType::Kind;
  const auto plural = [](const ParamType& t) -> std::string {
    switch (t.kind) {
      case Kind::real: return "numbers";
      case Kind::integer: return "integers";
      case Kind::text: return "texts";
      case Kind::record: return "objects";
      default: return fmt::format("({})", value_text(t));
    }
  };
  switch (type.kind) {
    case Kind::array:
      return type.count != 0 ? fmt::format("{} {}", type.count, plural(*type.element))
                             : fmt::format("list of {}", plural(*type.element));
    case Kind::optional: return value_text(*type.element) + ", or null";
    case Kind::choice: {
      std::string out;
      for (std::size_t i = 0; i < type.choices.size(); ++i)
        out += (i == 0 ? "" : i + 1 < type.choices.size() ? ", " : " or ") + type.choices[i];
      return out;
    }
    default: return type.name;
  }
}

std::string range_text(const ParamOptions& options) {
  const Range& r = options.range;
  const std::string unit = options.unit.empty() ? "" : fmt::format(" {}", options.unit);
  const bool low = std::isfinite(r.low), high = std::isfinite(r.high);
  if (low && high)
    return fmt::format("{}{} to {}{}{}", r.open_low ? "above " : "", r.low, r.open_high ? "below " : "",
                       r.high, unit);
  if (low) return fmt::format("{} {}{}", r.open_low ? "above" : "at least", r.low, unit);
  if (high) return fmt::format("{} {}{}", r.open_high ? "below" : "at most", r.high, unit);
  return std::string(options.unit);
}

std::string example_path(std::string_view node_type) {
  return "graphs/nodes/" + path_of(node_type) + ".json";
}

std::string node_page(const NodeType& type) {
  std::string out = fmt::format("# {}\n\n{}\n\n", type.name, type.doc);
  out += type.is_pixel() ? "A pixel node: it fills rectangles, and streams with its neighbours.\n"
                         : "A geometry node: whole buffers in, whole buffers out.\n";
  if (type.foreign) out += "A library computes its numbers: the same bytes on one processor only.\n";
  out += ports_table("Inputs", type.inputs, true) + ports_table("Outputs", type.outputs, false) +
         params_table(type) + knobs_table(type) + effects_table(type);
  if (!type.citations.empty()) {
    out += "\n## Sources\n\n";
    for (const std::string& c : type.citations) out += fmt::format("- {}\n", c);
  }
  if (!type.rows.empty())
    out += fmt::format("\nCovers row{} {} of the [course](../coverage.md).\n",
                       type.rows.size() == 1 ? "" : "s", fmt::join(type.rows, ", "));
  const std::string path = path_of(type.name);
  return out + fmt::format(
                   "\nExample: [`{0}`](../../{0}) · algorithm: [`nodes/{1}.h`](../../nodes/{1}.h) · node: "
                   "[`nodes/{1}.cpp`](../../nodes/{1}.cpp) · tests: "
                   "[`tests/nodes/{1}_test.cpp`](../../tests/nodes/{1}_test.cpp)\n",
                   example_path(type.name), path);
}

std::string node_index(const Registry& registry) {
  std::string out = "# Node types\n\nGenerated from the declarations by `./dev docs`.\n";
  std::string_view family;
  for (const auto& [name, type] : registry) {
    if (family_of(name) != family) {
      family = family_of(name);
      out += fmt::format("\n## {}\n\n", family);
    }
    out += fmt::format("- [{0}]({0}.md): {1}\n", name, type.doc);
  }
  return out;
}

std::string coverage_page(const Registry& registry) {
  std::map<int, std::vector<std::string>> nodes;
  for (const auto& [name, type] : registry)
    for (const int row : type.rows) nodes[row].push_back(name);
  std::string body;
  int covered = 0, all = 0;
  for (const CourseSection& section : course_sections()) {
    body += fmt::format(
        "\n## {} {}\n\n| row | named by the course | nodes | example graphs | tests |\n"
        "| --- | --- | --- | --- | --- |\n",
        section.number, section.title);
    for (int row = section.first; const std::string_view title : section.rows) {
      std::vector<std::string> pages, graphs, tests;
      for (const std::string& n : nodes[row]) {
        const std::string path = path_of(n);
        pages.push_back(fmt::format("[{0}](nodes/{0}.md)", n));
        graphs.push_back(fmt::format("[{0}](../{1})", path, example_path(n)));
        tests.push_back(fmt::format("[{0}_test](../tests/nodes/{0}_test.cpp)", path));
      }
      covered += pages.empty() ? 0 : 1, ++all;
      body += fmt::format("| {} | {} | {} | {} | {} |\n", row, in_table(std::string(title)),
                          pages.empty() ? "open" : fmt::format("{}", fmt::join(pages, ", ")),
                          fmt::join(graphs, ", "), fmt::join(tests, ", "));
      ++row;
    }
  }
  return fmt::format(
             "# What of the course is covered\n\nGenerated by `./dev docs` from the rows that each node says "
             "it "
             "answers. {} of {} rows have a node.\n",
             covered, all) +
         body;
}

}  // namespace frustum
