// frustum nodes [TYPE]: the catalogue, a family of it, or one node in full.
#include "runtime/app/catalog.h"
#include "runtime/cli/command.h"
#include "runtime/core/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <set>
#include <string>
#include <vector>

namespace frustum::cli {
namespace {

constexpr std::size_t page_width = 100;

std::string catalogue_text(const std::vector<const NodeType*>& types) {
  std::string out, family;
  for (const NodeType* type : types) {
    const std::string mine = type->name.substr(0, type->name.find('.'));
    if (mine != family) out += (out.empty() ? "" : "\n") + mine + "\n";
    family = mine;
    out += fmt::format("  {:<24} {}\n", type->name, wrapped(type->doc, page_width - 27, 27));
  }
  return out;
}

std::string described(const std::string& head, const std::string& doc) {
  return fmt::format("  {}\n      {}\n", head, wrapped(doc, page_width - 6, 6));
}

std::string ports_text(const std::string& title, const std::vector<Port>& ports, bool input) {
  if (ports.empty()) return "";
  std::string out = "\n" + title + "\n";
  for (const Port& p : ports)
    out += described(fmt::format("{}  {}{}{}{}", p.name, type_names(p), p.list ? ", a list" : "",
                                 input && p.optional ? ", may be left out" : "", space_names(p)),
                     p.doc);
  return out;
}

// Fields of objects inside stand after them, by their path.
std::string fields_text(const ParamType& record, const void* defaults, const std::string& path) {
  std::string out;
  for (const ParamField& f : record.fields) {
    std::string head = fmt::format("{}{}  {}", path, f.name, value_text(*f.type));
    if (defaults != nullptr)
      head +=
          fmt::format(", default {}", f.type->write(static_cast<const char*>(defaults) + f.offset).dump());
    if (const std::string range = range_text(f.options); !range.empty()) head += fmt::format(" ({})", range);
    out += described(head, f.doc);
    const ParamType* inner = f.type;
    while (inner->element != nullptr) inner = inner->element;
    if (inner->kind == ParamType::Kind::record) out += fields_text(*inner, nullptr, path + f.name + ".");
  }
  return out;
}

std::string effect_head(const EffectDoc& e) {
  const std::string cost = cost_text(e.cost);
  return fmt::format("{}{}{}", e.name, e.shortcut ? "  a shortcut" : "",
                     cost.empty() ? "" : fmt::format("  {}", cost));
}

std::string node_text(const NodeType& type) {
  std::string out =
      fmt::format("{}  ({})\n  {}\n", type.name, type.is_pixel() ? "pixel node" : "geometry node",
                  wrapped(type.doc, page_width - 2, 2));
  if (type.foreign) out += "  A library computes its numbers: same bytes on one processor only.\n";
  out += ports_text("inputs", type.inputs, true) + ports_text("outputs", type.outputs, false);
  const auto defaults = type.default_params();
  if (!type.params.fields.empty()) out += "\nparameters\n" + fields_text(type.params, defaults.get(), "");
  if (!type.effects.empty()) out += "\neffects\n";
  for (const EffectDoc& e : type.effects) out += described(effect_head(e), e.doc);
  if (!type.citations.empty()) out += fmt::format("\nsources\n  {}\n", fmt::join(type.citations, "\n  "));
  return out + fmt::format("\nexample: {}\n", example_path(type.name));
}

using Types = std::vector<const NodeType*>;

// What there is of some sort in the types: as {KEY: [...]}, or as text, which says so where it is nothing.
int listing(const char* key, const Json& list, const std::string& text, const std::string& none, bool json) {
  if (json)
    print(Json{{key, list}});
  else
    print(text.empty() ? none + "\n" : text);
  return done;
}

int knobs(const Types& types, bool json) {
  Json list = Json::array();
  std::string text;
  for (const NodeType* type : types) {
    for (Json knob : knobs_json(*type)) {
      std::string values;
      for (const Json& v : knob["values"])
        values += (values.empty() ? "" : " ") + (v.is_string() ? v.get<std::string>() : v.dump());
      std::string head = fmt::format("{}:{}  {}", type->name, knob["param"].get<std::string>(), values);
      if (knob.contains("slope")) head += fmt::format("  (error ~ value^{})", knob["slope"].dump());
      if (knob.contains("taste")) head += "  (taste)";
      text += described(head, knob["basis"].get<std::string>());
      knob["node"] = type->name;
      list.push_back(std::move(knob));
    }
  }
  return listing("knobs", list, text, "no parameter here trades accuracy for time", json);
}

int effects(const Types& types, bool json) {
  Json list = Json::array();
  std::string text;
  for (const NodeType* type : types) {
    for (const EffectDoc& e : type->effects)
      text += described(fmt::format("{}: {}", type->name, effect_head(e)), e.doc);
    const Json whole = node_json(*type);  // a part of a temporary would not last as long as the loop
    for (Json e : whole["effects"]) {
      e["node"] = type->name;
      list.push_back(std::move(e));
    }
  }
  return listing("effects", list, text, "no work here is left out where a scene does not call for it", json);
}

int catalogue(const Types& types, bool json) {
  if (!json) return print(catalogue_text(types)), done;
  Json list = Json::array();
  for (const NodeType* t : types) list.push_back(node_json(*t));
  return print(Json{{"nodes", list}}), done;
}

// The type of that name, or those of the family; all for an empty name.
Types types_of(const Registry& registry, const std::string& wanted) {
  Types out;
  for (const auto& [name, type] : registry)
    if (wanted.empty() || name == wanted || name.starts_with(wanted + ".")) out.push_back(&type);
  return out;
}

[[noreturn]] void unknown(const Registry& registry, const std::string& wanted) {
  std::vector<std::string> known = registry.names();
  std::set<std::string> families;
  for (const std::string& name : known) families.insert(name.substr(0, name.find('.')));
  known.insert(known.end(), families.begin(), families.end());
  throw Mistake({.code = "unknown_type",
                 .pointer = "",
                 .message = fmt::format("'{}' is neither a node type nor a family of them", wanted),
                 .expected = fmt::format("a node type, or one of: {}", fmt::join(families, ", ")),
                 .got = wanted,
                 .suggestions = nearest_names(wanted, known)});
}

enum class Only { all, knobs, effects };

int nodes(const std::string& wanted, Only only, bool json) {
  const Session session;
  const Types types = types_of(session.registry(), wanted);
  if (types.empty()) unknown(session.registry(), wanted);
  if (only == Only::knobs) return knobs(types, json);
  if (only == Only::effects) return effects(types, json);
  if (types.front()->name != wanted) return catalogue(types, json);
  if (json)
    print(node_json(*types.front()));
  else
    print(node_text(*types.front()));
  return done;
}

}  // namespace

void add_nodes(CLI::App& app, Invocation& chosen) {
  auto wanted = std::make_shared<std::string>();
  auto only_knobs = std::make_shared<bool>(false), only_effects = std::make_shared<bool>(false);
  CLI::App& c =
      add_command(app, chosen, "nodes", "Lists the node types, those of a family, or shows one in full.",
                  "frustum nodes clip.homogeneous", [wanted, only_knobs, only_effects, &chosen] {
                    const Only only = *only_knobs ? Only::knobs : *only_effects ? Only::effects : Only::all;
                    return nodes(*wanted, only, chosen.json);
                  });
  c.add_option("type", *wanted, "A node type, or a family of them such as clip.")->type_name("TYPE");
  CLI::Option* knob_flag = c.add_flag(
      "--knobs", *only_knobs,
      "Only the parameters that trade accuracy for time, from cheap to exact; of all, of a family or "
      "of one type.");
  c.add_flag("--effects", *only_effects, "Only the work that a scene may not call for.")->excludes(knob_flag);
}

}  // namespace frustum::cli
