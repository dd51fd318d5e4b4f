// --cache and --cache-size, for the commands that run graphs.
#include "runtime/app/observers.h"
#include "runtime/cli/command.h"
#include "runtime/core/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdlib>

namespace frustum::cli {

void add_cache_arguments(CLI::App& app, CacheArguments& args) {
  app.add_option(
         "--cache", args.cache,
         "The folder that keeps buffers from one run to the next; off keeps none; check computes all anew "
         "and compares with the folder (--cache DIR --cache check). Default: $FRUSTUM_CACHE, if set.")
      ->type_name("DIR|off|check")
      ->allow_extra_args(false);
  app.add_option("--cache-size", args.size,
                 "Most bytes of that folder (10G); what was used longest ago goes first.")
      ->type_name("SIZE");
}

bool open_cache(const CacheArguments& args, Session& session) {
  std::string folder;
  bool check = false, off = false;
  for (const std::string& word : args.cache) {
    if (word == "check")
      check = true;
    else if (word == "off")
      off = true;
    else if (word.empty())
      throw UsageError("--cache: expected a folder, off or check");
    else if (folder.empty() || folder == word)
      folder = word;
    else
      throw UsageError(fmt::format("--cache {}: there is one folder, and {} was named before", word, folder));
  }
  if (off && (check || !folder.empty())) throw UsageError("--cache off: nothing else goes with it");
  if (off) return false;
  if (const char* named = std::getenv("FRUSTUM_CACHE"); folder.empty() && named != nullptr) folder = named;
  if (check && folder.empty())
    throw UsageError("--cache check: name the folder too (--cache DIR --cache check), or set $FRUSTUM_CACHE");
  std::uint64_t limit = DiskCache::default_limit_bytes;
  if (!args.size.empty()) {
    const auto bytes = parse_bytes(args.size);
    if (!bytes || *bytes == 0)
      throw UsageError(fmt::format("--cache-size {}: expected a size such as 512M or 10G", args.size));
    limit = *bytes;
  }
  if (!folder.empty()) session.use_disk(folder, limit, check);
  return true;
}

Json to_json(const std::vector<NodeCaching>& caching) {
  Json list = Json::array();
  for (const NodeCaching& c : caching) list.push_back(frustum::to_json(c));
  return list;
}

}  // namespace frustum::cli
