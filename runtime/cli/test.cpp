// frustum test SUITE...: runs suites and says what held.
#include "runtime/app/files.h"
#include "runtime/app/suite/html.h"
#include "runtime/app/suite/run.h"
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

namespace frustum::cli {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::vector<std::string> suites;
  SuiteOptions options;
  bool accept = false, review = false, yes = false, here = false;
  bool all_pictures = false;
  std::string shard, reason, junit, html;
};

bool color_on_stdout() { return color_on_stderr() && ::isatty(STDOUT_FILENO) == 1; }

// A folder for what is not kept, gone with this object.
class ScratchFolder {
 public:
  // Beside `near`, so that files can be renamed from it.
  explicit ScratchFolder(const fs::path& near) {
    std::string name = (near / ".frustum_XXXXXX").string();
    std::error_code error;
    fs::create_directories(near, error);
    if (::mkdtemp(name.data()) == nullptr)
      throw WorldError("cannot_write_file", fmt::format("cannot make a folder in {}", near.string()));
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

Shard shard_of(const std::string& text) {
  const auto slash = text.find('/');
  if (slash == std::string::npos)
    throw UsageError(fmt::format("--shard {}: expected I/N, such as 2/8", text));
  const int index = integers("--shard", text.substr(0, slash), 1).front();
  const int count = integers("--shard", text.substr(slash + 1), 1).front();
  if (count < 1 || index < 1 || index > count)
    throw UsageError(fmt::format("--shard {}: there are parts 1 to N", text));
  return {index, count};
}

std::size_t proposals(const std::vector<CaseResult>& results) {
  std::size_t n = 0;
  for (const CaseResult& r : results)
    n += static_cast<std::size_t>(
        std::count_if(r.accepted.begin(), r.accepted.end(), [](const auto& c) { return !c.trace; }));
  return n;
}

// On a terminal somebody looks at what stands above before it is recorded.
bool confirmed(const Arguments& args, std::size_t goldens) {
  if (args.yes || ::isatty(STDIN_FILENO) != 1 || ::isatty(STDOUT_FILENO) != 1) return true;
  print(fmt::format("accept {}? [y/N] ",
                    goldens == 1 ? "this golden" : fmt::format("these {} goldens", goldens)));
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "yes");
}

void accept(const Arguments& args, const std::vector<Suite>& suites, const std::vector<CaseResult>& results,
            bool json) {
  const std::size_t goldens = proposals(results);
  if (args.review) {
    if (!json) print(fmt::format("{} goldens would be accepted\n", goldens));
    return;
  }
  if (goldens > 0 && !confirmed(args, goldens)) {
    print(std::string("nothing was accepted\n"));
    return;
  }
  record_goldens(suites, results, args.reason);
  if (!json) print(fmt::format("{} goldens accepted\n", goldens));
}

std::vector<Suite> load(const std::vector<std::string>& paths, Diagnostics& problems) {
  std::vector<Suite> suites;
  for (const std::string& path : paths)
    if (auto suite = load_suite(path, problems)) suites.push_back(std::move(*suite));
  return suites;
}

int test(Arguments& args, bool json) {
  SuiteOptions& options = args.options;
  options.cancel = &cancel_flag();
  options.isolate = !args.here;
  if (!args.shard.empty()) options.shard = shard_of(args.shard);
  Diagnostics problems;
  const std::vector<Suite> suites = load(args.suites, problems);
  if (problems.has_errors()) return fail(problems, json);

  std::optional<ScratchFolder> staging;
  if (args.accept || args.review) options.goldens = Goldens::propose;
  if (args.accept && !args.review) options.staging = staging.emplace(golden_folder(suites.front())).path();

  std::optional<ScratchFolder> evidence;
  if (!args.html.empty()) options.evidence = evidence.emplace(fs::temp_directory_path()).path();
  options.evidence_of_all = args.all_pictures;

  Session session;
  const auto results = run_suites(session, suites, options, [&](const CaseResult& r) {
    if (!json) print(to_text(r, color_on_stdout()));
  });
  if (results.empty() && options.shard.count == 1) throw UsageError("no case matches the filters");
  if (options.goldens == Goldens::propose) accept(args, suites, results, json);
  if (!args.junit.empty()) write_text(args.junit, junit_text(results));
  if (evidence)
    write_text(args.html, suite_page(results, {.evidence = evidence->path(), .date = today_utc()}));
  if (json)
    print(to_json(results));
  else
    print(summary_text(results));
  const bool good =
      std::none_of(results.begin(), results.end(), [](const auto& r) { return counts_against(r.verdict); });
  return good ? done : check_failed;
}

void add_selection(CLI::App& c, Arguments& args) {
  c.add_option("suites", args.suites, "Suite files.")->required()->type_name("SUITE");
  c.add_option("--filter", args.options.filters,
               "Only cases with this id or tag; * and ? are wild, a leading ! leaves out; repeatable.")
      ->type_name("GLOB")
      ->allow_extra_args(false);
  c.add_option("--shard", args.shard, "Only part I of N; the parts are the same on every machine.")
      ->type_name("I/N");
}

// CLI::PositiveNumber prints the greatest double as what is allowed, in 309 digits.
std::string above_zero(const std::string& text) {
  double value = 0;
  if (CLI::detail::lexical_cast(text, value) && value > 0 && std::isfinite(value)) return {};
  return fmt::format("must be above 0, not {}", text);
}

void add_running(CLI::App& c, Arguments& args) {
  c.add_option("-j,--jobs", args.options.jobs, "Cases at a time; 0 is one a processor.")
      ->check(quiet(CLI::Range(0, 1024)))
      ->type_name("N");
  c.add_option("--threads", args.options.threads, "Threads of each case; 0 shares the processors.")
      ->check(quiet(CLI::Range(0, 4096)))
      ->type_name("N");
  c.add_option("--timeout", args.options.timeout,
               "Seconds after which a case that says nothing else is ended.")
      ->check(quiet(CLI::Validator(above_zero, "")))
      ->type_name("SECONDS");
  c.add_option("--retry", args.options.retry,
               "Further attempts of a case that does not pass; if one does, it is flaky.")
      ->check(quiet(CLI::Range(0, 10)))
      ->type_name("N");
  c.add_flag("--no-isolation", args.here, "Runs the cases in this process, for a debugger.");
}

void add_results(CLI::App& c, Arguments& args) {
  c.add_flag("--accept", args.accept,
             "Shows the goldens of the chosen cases that are new or differ, and records them.");
  c.add_flag("--review", args.review, "Shows what --accept would record, and records nothing.");
  c.add_flag("--yes", args.yes, "Does not ask before it accepts.");
  c.add_option("--reason", args.reason, "Why, kept with what is accepted.")->type_name("TEXT");
  c.add_option("--junit", args.junit, "Writes the results as JUnit XML.")->type_name("FILE");
  c.add_option("--html", args.html, "Writes the results as one page, with the pictures that differ.")
      ->type_name("FILE");
  c.add_flag("--all-pictures", args.all_pictures, "Puts the pictures of checks that hold into the page too.");
}

}  // namespace

void add_test(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c = add_command(
      app, chosen, "test", "Runs suites: graphs, settings, and what has to hold of their buffers.",
      "frustum test tests/suites/gallery.json --filter 'pictures/*' --junit results.xml",
      [args, &chosen] { return test(*args, chosen.json); });
  add_selection(c, *args);
  add_running(c, *args);
  add_results(c, *args);
}

}  // namespace frustum::cli
