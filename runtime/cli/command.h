// What the commands share. Each lives in a file of its own and adds itself to the command line with one
// function.
#pragma once

#include "runtime/app/session.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::cli {

enum Exit : int { done = 0, check_failed = 1, bad_input = 2, world_failed = 3, cancelled = 130 };

// What is to be done once the command line has been read.
struct Invocation {
  std::function<int()> body;
  bool json = false;
};

void add_run(CLI::App&, Invocation&);
void add_check(CLI::App&, Invocation&);
void add_plan(CLI::App&, Invocation&);
void add_inspect(CLI::App&, Invocation&);
void add_report(CLI::App&, Invocation&);
void add_nodes(CLI::App&, Invocation&);
void add_diff(CLI::App&, Invocation&);
void add_sweep(CLI::App&, Invocation&);
void add_diverge(CLI::App&, Invocation&);
void add_test(CLI::App&, Invocation&);
void add_new(CLI::App&, Invocation&);
void add_catalog(CLI::App&, Invocation&);
void add_stability(CLI::App&, Invocation&);

// A command with --json and an example under its help; `body` runs when the command was chosen. Options
// live as long as the callbacks that hold them.
CLI::App& add_command(CLI::App& app, Invocation& chosen, const std::string& name, const std::string& what,
                      const std::string& example, std::function<int()> body);

// A check of an option's value that adds nothing to the help, which has the option's own type name.
CLI::Validator quiet(CLI::Validator check);

// Wrong use of the command line: exit 2 with one line of help.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A mistake that is found while a command goes on, with its place and what was meant: exit 2.
struct Mistake : std::runtime_error {
  Diagnostic problem;
  explicit Mistake(Diagnostic d) : std::runtime_error(d.message), problem(std::move(d)) {}
};

// ----- a graph and the values set in it
struct GraphArguments {
  std::string path;
  std::vector<std::string> settings;
  std::string precision;
};
void add_graph_arguments(CLI::App&, GraphArguments&);
LoadOptions load_options(const GraphArguments&);  // throws UsageError for a --set without '='

// The graph, or its problems printed and no graph. Warnings of a graph are printed, or added to `warnings`.
std::optional<Graph> load_or_report(const Session&, const GraphArguments&, bool json, LoadOptions,
                                    Diagnostics* warnings = nullptr);

// Takes out the warnings that nothing reads a node: those of what feeds the ports that are asked for.
void drop_unused(const Graph& graph, std::span<const PortRef> asked, Diagnostics& warnings);

// ----- how a run goes
struct RunArguments {
  int threads = 0;
  std::string memory, simd;
  int tile = 0;
  bool no_fuse = false;
  std::string region;
};
void add_run_arguments(CLI::App&, RunArguments&);
void add_memory_argument(CLI::App&, std::string& memory);  // --memory alone
std::uint64_t memory_limit(const std::string& memory);     // 0: none was given. Throws UsageError
// Throws UsageError. A --simd that the processor lacks is WorldError("unsupported_simd").
void apply(const RunArguments&, RunOptions&);

// An error for every wanted port of pixels that has none in the region.
void check_region(const Graph&, const RunOptions&, const RunResult&, Diagnostics&);

// "samples=64,lit:interpolation=phong" as its parts; commas inside brackets belong to a value.
std::vector<std::string> assignments(const std::string& text);
// ----- where buffers are kept from one run to the next
struct CacheArguments {
  std::vector<std::string> cache;  // DIR, off, check
  std::string size;
};
void add_cache_arguments(CLI::App&, CacheArguments&);
// Opens the folder: that of --cache, else of $FRUSTUM_CACHE. False where nothing is to be kept, not even in
// memory. Throws UsageError, WorldError("cache_unusable").
bool open_cache(const CacheArguments&, Session&);
Json to_json(const std::vector<NodeCaching>&);

// "3,4" as two integers and the like; throws UsageError naming the option.
std::vector<int> integers(std::string_view option, std::string_view text, std::size_t count);
// "1-48" or "7"; throws UsageError.
std::pair<int, int> frame_range(std::string_view text);

// ----- what is said
void print(const std::string& text);  // stdout; what fails is kept for exit_after_output
void print(const Json& object);       // stdout, one object
void report(const Diagnostics&);      // as text on stderr
// {"diagnostics": [...]} merged into `object`.
Json with_diagnostics(Json object, const Diagnostics&);
// Prints the problems, as JSON on stdout or as text on stderr, and gives `exit`.
int fail(const Diagnostics&, bool json, Exit exit = bad_input);
int fail(const Diagnostic&, bool json);
int exit_code(const RunResult&);
// `code`, or 3 with a message where a part of what was printed is lost. A reader that went away has what it
// wants: that is no failure.
int exit_after_output(int code);

// ----- the terminal
bool color_on_stderr();
bool progress_on_stderr();

// Set by SIGINT, SIGTERM and SIGHUP; a second signal removes unfinished files and ends the process at once.
CancelFlag& cancel_flag();
void catch_signals();
// Where a standard stream is closed, its number would go to the first file that is opened, and messages into
// that file. Takes the number, so that each use of the stream fails.
void hold_standard_streams();

}  // namespace frustum::cli
