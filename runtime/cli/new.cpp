// frustum new FAMILY.NODE: the files of a new node type.
#include "runtime/app/files.h"
#include "runtime/app/scaffold.h"
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <initializer_list>
#include <utility>

namespace frustum::cli {
namespace {

struct Arguments {
  std::string name, root;
  bool pixels = false;
};

std::filesystem::path tree(const Arguments& args) {
  if (!args.root.empty()) {
    if (!std::filesystem::is_directory(args.root))
      throw UsageError(fmt::format("new: --root {}: there is no such folder", args.root));
    if (std::filesystem::is_directory(std::filesystem::path(args.root) / "nodes")) return args.root;
    throw UsageError(fmt::format("new: --root {}: it is no source tree: it has no folder nodes/", args.root));
  }
  if (const auto here = source_root(".")) return *here;
  throw UsageError("new: no source tree around the current folder; name it with --root");
}

// What ctest -R takes for the node's own tests and for those that every node is held to.
std::string test_pattern(std::string_view name) {
  std::string own = pascal_name(name), conformance(name);
  conformance[conformance.find('.')] = '_';
  return own + "|" + conformance;
}

// Lines of two columns, the first as wide as it has to be.
std::string table(std::initializer_list<std::pair<std::string, std::string_view>> rows) {
  std::size_t width = 0;
  for (const auto& [left, right] : rows) width = std::max(width, left.size());
  std::string out;
  for (const auto& [left, right] : rows) out += fmt::format("  {:<{}}   {}\n", left, width, right);
  return out;
}

std::string what_next(std::string_view name, const std::vector<ScaffoldFile>& files) {
  return "\nIt builds and runs as it is. Now make it do what you want:\n" +
         table({{files[0].path, "the algorithm"},
                {files[1].path, "its ports and parameters"},
                {files[2].path, "a case worked by hand, a property, a degenerate case"},
                {files[3].path, "the smallest graph that shows it"}}) +
         "\n" +
         table({{"./dev run " + files[3].path, "builds and runs the example"},
                {fmt::format("./dev test -R '{}'", test_pattern(name)), "runs its tests"},
                {"./dev docs", "writes its schema and its page"}}) +
         "\ndocs/adding_a_node.md tells the rest.\n";
}

int make(const Arguments& args, bool json) {
  if (const std::string problem = problem_of_node_name(args.name); !problem.empty())
    throw UsageError(fmt::format("new {}: {}", args.name, problem));
  const std::filesystem::path root = tree(args);
  const auto files = scaffold(args.name, args.pixels ? NewNode::pixels : NewNode::geometry);
  Diagnostics problems;
  for (const ScaffoldFile& f : files)
    if (std::filesystem::exists(root / f.path))
      problems.add({.code = "exists", .pointer = "", .message = fmt::format("{} is already there", f.path)});
  if (problems.has_errors()) return fail(problems, json);
  Json written = Json::array();
  std::string text;
  for (const ScaffoldFile& f : files) {
    write_text(root / f.path, f.text);
    written.push_back(f.path);
    text += fmt::format("wrote {}\n", f.path);
  }
  if (json)
    print(Json{{"written", written}});
  else
    print(text + what_next(args.name, files));
  return done;
}

}  // namespace

void add_new(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c =
      add_command(app, chosen, "new", "Writes the files of a new node type, ready to build.",
                  "frustum new curve.supercircle", [args, &chosen] { return make(*args, chosen.json); });
  c.add_option("name", args->name, "FAMILY.NODE in snake_case.")->required()->type_name("FAMILY.NODE");
  c.add_flag("--pixels", args->pixels, "A node that fills rectangles of pixels, not one of whole buffers.");
  c.add_option("--root", args->root, "The source tree; by default the one around the current folder.")
      ->type_name("DIR");
}

}  // namespace frustum::cli
