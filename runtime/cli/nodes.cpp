// frustum nodes [TYPE]: the catalogue, or one node in full.
#include "runtime/app/catalog.h"
#include "runtime/app/text.h"
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <map>

namespace frustum::cli {
namespace {

constexpr std::size_t page_width = 100;

std::string catalogue_text(const Registry& registry) {
  std::string out, family;
  for (const auto& [name, type] : registry) {
    const std::string mine = name.substr(0, name.find('.'));
    if (mine != family) out += (out.empty() ? "" : "\n") + mine + "\n";
    family = mine;
    out += fmt::format("  {:<24} {}\n", name, wrapped(type.doc, page_width - 27, 27));
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

std::string node_text(const NodeType& type) {
  std::string out =
      fmt::format("{}  ({})\n  {}\n", type.name, type.is_pixel() ? "pixel node" : "geometry node",
                  wrapped(type.doc, page_width - 2, 2));
  if (type.foreign) out += "  A library computes its numbers: same bytes on one processor only.\n";
  out += ports_text("inputs", type.inputs, true) + ports_text("outputs", type.outputs, false);
  const auto defaults = type.default_params();
  if (!type.params.fields.empty()) out += "\nparameters\n";
  for (const ParamField& f : type.params.fields) {
    const Json value = f.type->write(static_cast<const char*>(defaults.get()) + f.offset);
    std::string head = fmt::format("{}  {}, default {}", f.name, f.type->name, value.dump());
    if (const std::string range = range_text(f.options); !range.empty()) head += fmt::format(" ({})", range);
    out += described(head, f.doc);
  }
  if (!type.citations.empty()) out += fmt::format("\nsources\n  {}\n", fmt::join(type.citations, "\n  "));
  return out + fmt::format("\nexample: {}\n", example_path(type.name));
}

int nodes(const std::string& wanted, bool json) {
  const Session session;
  if (wanted.empty()) {
    if (!json) return print(catalogue_text(session.registry())), done;
    Json list = Json::array();
    for (const auto& [name, type] : session.registry()) list.push_back(node_json(type));
    return print(Json{{"nodes", list}}), done;
  }
  const NodeType* type = session.registry().find(wanted);
  if (type == nullptr) {
    Diagnostics problems;
    problems.add({.code = "unknown_type",
                  .pointer = "",
                  .message = fmt::format("'{}' is not a node type", wanted),
                  .got = wanted,
                  .suggestions = nearest_names(wanted, session.registry().names())});
    return fail(problems, json);
  }
  if (json)
    print(node_json(*type));
  else
    print(node_text(*type));
  return done;
}

}  // namespace

void add_nodes(CLI::App& app, Invocation& chosen) {
  auto wanted = std::make_shared<std::string>();
  CLI::App& c = add_command(app, chosen, "nodes", "Lists the node types, or shows one in full.",
                            "frustum nodes clip.homogeneous",
                            [wanted, &chosen] { return nodes(*wanted, chosen.json); });
  c.add_option("type", *wanted, "A node type.")->type_name("TYPE");
}

}  // namespace frustum::cli
