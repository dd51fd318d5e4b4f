// frustum test SUITE...: runs suites and says what held.
#include "runtime/app/files.h"
#include "runtime/app/suite_run.h"
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <algorithm>

namespace frustum::cli {
namespace {

struct Arguments {
  std::vector<std::string> suites;
  SuiteOptions options;
  std::string junit;
};

bool color_on_stdout() { return color_on_stderr() && ::isatty(STDOUT_FILENO) == 1; }

int test(Arguments& args, bool json) {
  args.options.cancel = &cancel_flag();
  std::vector<Suite> suites;
  Diagnostics problems;
  for (const std::string& path : args.suites)
    if (auto suite = load_suite(path, problems)) suites.push_back(std::move(*suite));
  if (problems.has_errors()) return fail(problems, json);

  Session session;
  std::vector<CaseResult> results;
  for (const Suite& suite : suites) {
    const auto more = run_suite(session, suite, args.options, [&](const CaseResult& r) {
      if (!json) print(to_text(r, color_on_stdout()));
    });
    results.insert(results.end(), more.begin(), more.end());
  }
  if (!args.junit.empty()) write_text(args.junit, junit_text(results));
  const auto failed =
      std::count_if(results.begin(), results.end(), [](const auto& r) { return r.verdict != Verdict::pass; });
  if (json)
    print(to_json(results));
  else
    print(fmt::format("{} of {} cases pass\n", results.size() - static_cast<std::size_t>(failed),
                      results.size()));
  if (results.empty()) throw UsageError("no case matches the filters");
  return failed == 0 ? done : check_failed;
}

}  // namespace

void add_test(CLI::App& app, Invocation& chosen) {
  auto args = std::make_shared<Arguments>();
  CLI::App& c = add_command(app, chosen, "test",
                            "Runs suites: graphs, settings, and what has to hold of their buffers.",
                            "frustum test tests/suites/gallery.json --filter teapot",
                            [args, &chosen] { return test(*args, chosen.json); });
  c.add_option("suites", args->suites, "Suite files.")->required()->type_name("SUITE");
  c.add_option("--filter", args->options.filters,
               "Only cases whose id has this part, or that carry this tag; repeatable.")
      ->type_name("TEXT")
      ->allow_extra_args(false);
  c.add_flag("--accept", args->options.accept, "Records the goldens of the chosen cases and says which.");
  c.add_option("--reason", args->options.reason, "Why, kept with what is accepted.")->type_name("TEXT");
  c.add_option("--threads", args->options.threads, "Threads; 0 takes every processor.")
      ->check(quiet(CLI::Range(0, 4096)))
      ->type_name("N");
  c.add_option("--junit", args->junit, "Writes the results as JUnit XML.")->type_name("FILE");
}

}  // namespace frustum::cli
