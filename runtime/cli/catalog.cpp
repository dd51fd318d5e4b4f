// frustum catalog: writes the schemas and the pages of the node types.
#include "runtime/app/catalog.h"
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace frustum::cli {
namespace {

struct Arguments {
  CatalogFolders folders;
  bool check = false;
};

int catalog(const Arguments& args, bool json) {
  if (args.folders.schemas.empty() && args.folders.docs.empty())
    throw UsageError("catalog: say where, with --schemas DIR or --docs DIR");
  const Session session;
  const CatalogChanges changes = write_catalog(session.registry(), args.folders, args.check);
  if (json)
    print(Json{{"written", changes.written}, {"removed", changes.removed}, {"checked_only", args.check}});
  else
    for (const auto& [list, what] :
         {std::pair{&changes.written, "written"}, std::pair{&changes.removed, "removed"}})
      for (const std::string& path : *list)
        print(fmt::format("{}{}: {}\n", args.check ? "to be " : "", what, path));
  return args.check && !changes.empty() ? check_failed : done;
}

}  // namespace

void add_catalog(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c =
      add_command(app, chosen, "catalog", "Writes the JSON Schemas and the pages of all node types.",
                  "frustum catalog --schemas schemas --docs docs",
                  [args, &chosen] { return catalog(*args, chosen.json); });
  c.add_option("--schemas", args->folders.schemas, "The folder of graph.schema.json and nodes/.")
      ->type_name("DIR");
  c.add_option("--docs", args->folders.docs, "The folder of coverage.md and nodes/.")->type_name("DIR");
  c.add_flag("--check", args->check, "Writes nothing; exit 1 where something is out of date.");
}

}  // namespace frustum::cli
