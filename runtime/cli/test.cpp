// frustum test SUITE...: runs suites and says what held.
#include "runtime/app/files.h"
#include "runtime/app/read_files.h"
#include "runtime/app/suite/html.h"
#include "runtime/app/suite/run.h"
#include "runtime/cli/command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>

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
  Shard shard;
  const auto slash = text.find('/');
  const auto part = [&](std::size_t from, std::size_t to, int& out) {
    const char *begin = text.data() + from, *end = text.data() + to;
    const auto [at, error] = std::from_chars(begin, end, out);
    return error == std::errc() && at == end;
  };
  if (slash == std::string::npos || !part(0, slash, shard.index) ||
      !part(slash + 1, text.size(), shard.count))
    throw UsageError(fmt::format("--shard {}: expected I/N, such as 2/8", text));
  if (shard.count < 1 || shard.index < 1 || shard.index > shard.count)
    throw UsageError(fmt::format("--shard {}: there are parts 1 to N", text));
  return shard;
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
  std::error_code none;
  std::set<fs::path> seen;
  for (const std::string& path : paths)
    if (!seen.insert(fs::weakly_canonical(path, none)).second)
      throw UsageError(fmt::format("{} is given twice", path));
  std::vector<Suite> suites;
  for (const std::string& path : paths)
    if (auto suite = load_suite(path, problems)) suites.push_back(std::move(*suite));
  return suites;
}

// Whether a file begins as the pages that are written here do: then it is none of those that are read, and its
// place may be taken without loading every graph.
bool is_page(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string begin(15, '\0');
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(in.gcount()));
  return begin.starts_with("<?xml") || begin.starts_with("<!doctype html>");
}

// Before anything runs: reports a file that would be written over what is read, and throws where two are one or one
// cannot be written.
std::optional<Diagnostic> bad_target(const Arguments& args, Session& session,
                                     const std::vector<Suite>& suites) {
  std::error_code none;
  if (!args.junit.empty() &&
      (fs::path(args.junit).lexically_normal() == fs::path(args.html).lexically_normal() ||
       fs::equivalent(args.junit, args.html, none)))
    throw UsageError(fmt::format("--junit and --html name one file, {}", args.html));
  for (const auto& [option, file] : {std::pair("--junit", args.junit), std::pair("--html", args.html)}) {
    if (file.empty()) continue;
    require_writable(file);
    if (!fs::is_regular_file(file, none) || is_page(file)) continue;
    if (auto d = overwriting_one(files_read_by(session, suites), {file}, option)) return d;
  }
  return std::nullopt;
}

int test(Arguments& args, bool json) {
  SuiteOptions& options = args.options;
  options.cancel = &cancel_flag();
  options.isolate = !args.here;
  if (!args.shard.empty()) options.shard = shard_of(args.shard);
  Diagnostics problems;
  const std::vector<Suite> suites = load(args.suites, problems);
  if (problems.has_errors()) return fail(problems, json);

  Session session;
  if (const auto d = bad_target(args, session, suites)) return fail(*d, json);

  std::optional<ScratchFolder> staging;
  if (args.accept || args.review) options.goldens = Goldens::propose;
  if (args.accept && !args.review) options.staging = staging.emplace(golden_folder(suites.front())).path();

  std::optional<ScratchFolder> evidence;
  if (!args.html.empty()) options.evidence = evidence.emplace(fs::temp_directory_path()).path();
  options.evidence_of_all = args.all_pictures;

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
