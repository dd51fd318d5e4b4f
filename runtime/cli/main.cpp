// The command line: one file per command, this one reads the arguments and turns every end into an exit code.
#include "runtime/app/run_failure.h"
#include "runtime/cli/command.h"
#include "runtime/core/version.h"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <CLI/Error.hpp>
#include <nlohmann/json.hpp>

#include <cstring>
#include <new>
#include <optional>

namespace frustum::cli {
namespace {

void log_to_stderr() {
  using Sink = spdlog::sinks::stderr_color_sink_mt;
  auto sink =
      std::make_shared<Sink>(color_on_stderr() ? spdlog::color_mode::always : spdlog::color_mode::never);
  auto logger = std::make_shared<spdlog::logger>("frustum", sink);
  logger->set_pattern("%^%l%$: %v");
  spdlog::set_default_logger(logger);
}

int world_error(const std::string& code, const std::string& message, bool json) {
  Diagnostics problems;
  problems.add({.code = code, .pointer = "", .message = message});
  return fail(problems, json, world_failed);
}

int usage_error(const std::string& message, const std::vector<std::string>& near, const std::string& help,
                bool json) {
  if (json) {
    Diagnostics problems;
    problems.add({.code = "usage", .pointer = "", .message = message, .suggestions = near});
    return fail(problems, true);
  }
  std::string text = "frustum: " + message + "\n";
  if (!near.empty()) text += fmt::format("  did you mean '{}'?\n", near.front());
  text += fmt::format("  see: {}\n", help);
  std::fwrite(text.data(), 1, text.size(), stderr);
  return bad_input;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* c : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(c->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* o : command.get_options())
    for (const std::string& l : o->get_lnames()) names.push_back("--" + l);
  return names;
}

// What CLI11 calls an extra argument: a command or an option that does not exist, or one argument too many.
int unexpected(const CLI::App& app, bool json) {
  const auto chosen = app.get_subcommands();
  if (chosen.empty()) {
    const std::string name = app.remaining().empty() ? "" : app.remaining().front();
    const bool option = name.starts_with('-');
    return usage_error(fmt::format("no {} '{}'", option ? "option" : "command", name),
                       nearest_names(name, option ? option_names(app) : command_names(app)), "frustum --help",
                       json);
  }
  const CLI::App& command = *chosen.front();
  const std::string help = fmt::format("frustum {} --help", command.get_name());
  const auto left = command.remaining();
  std::string name = left.empty() ? "" : left.front();
  for (const std::string& l : left)
    if (l.starts_with("--")) name = l.substr(0, l.find('='));
  if (!name.starts_with('-'))
    return usage_error(fmt::format("one argument too many: '{}'", name), {}, help, json);
  return usage_error(fmt::format("{} has no option '{}'", command.get_name(), name),
                     nearest_names(name, option_names(command)), help, json);
}

// An option or argument that was given as an empty text: none of them has a meaning for it, and to take it as not given would
// be a silent default.
std::optional<std::string> given_empty(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands())
    for (const CLI::Option* o : command->get_options())
      for (const std::string& value : o->results())
        if (value.empty()) return o->get_name();
  return std::nullopt;
}

std::string help_of(const CLI::App& app) {
  const auto commands = app.get_subcommands();
  return commands.empty() ? "frustum --help" : fmt::format("frustum {} --help", commands.front()->get_name());
}

int run_body(const CLI::App& app, const Invocation& chosen) {
  try {
    return chosen.body();
  } catch (const UsageError& e) {
    return usage_error(e.what(), {}, help_of(app), chosen.json);
  } catch (const RunFailure& e) {
    return fail(e.result.problems, chosen.json, static_cast<Exit>(exit_code(e.result)));
  } catch (const Mistake& e) {
    return fail(e.problem, chosen.json);
  } catch (const WorldError& e) {
    return world_error(e.code, e.what(), chosen.json);
  } catch (const NodeError& e) {
    Diagnostics problems;
    problems.add({.code = e.code, .pointer = "", .message = e.what()});
    return fail(problems, chosen.json);
  } catch (const Cancelled&) {
    return fail({}, chosen.json, cancelled);
  } catch (const std::bad_alloc&) {
    return world_error("out_of_memory", "there is not enough memory", chosen.json);
  } catch (const std::exception& e) {
    spdlog::debug("{}", e.what());  // the text of a library, of no use without the source
    return world_error("internal", "this is a fault of frustum, which met an error that it does not know",
                       chosen.json);
  }
}

int main_(int argc, char** argv) {
  log_to_stderr();
  catch_signals();
  CLI::App app{"A graphics pipeline written as JSON graphs.", "frustum"};
  app.set_version_flag("--version", fmt::format("frustum {} ({})", version, build_id()));
  app.require_subcommand(1);
  app.footer(
      "\nExample:\n  frustum run graphs/gallery/teapot.json\n\n"
      "Exit codes: 0 done, 1 a check did not hold, 2 the input is wrong, 3 the world failed, 130 cancelled.");
  Invocation chosen;
  for (const auto add : {add_run, add_check, add_plan, add_inspect, add_report, add_nodes, add_diff,
                         add_sweep, add_diverge, add_stability, add_test, add_new, add_catalog})
    add(app, chosen);
  // Whether errors of the command line itself are to be JSON has to be known before it could be read.
  for (int i = 1; i < argc; ++i) chosen.json |= std::strcmp(argv[i], "--json") == 0;

  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    if (app.get_subcommands().empty() && !app.remaining().empty()) return unexpected(app, chosen.json);
    print(app.help() + "\n");  // of the command that was named, if one was
    return done;
  } catch (const CLI::CallForVersion& e) {
    if (chosen.json)
      print(Json{{"version", version}, {"build", build_id()}});
    else
      print(std::string(e.what()) + "\n");
    return done;
  } catch (const CLI::ExtrasError&) {
    return unexpected(app, chosen.json);
  } catch (const CLI::ParseError& e) {
    if (argc < 2) {
      print(app.help() + "\n");
      return bad_input;
    }
    const auto commands = app.get_subcommands();
    if (commands.empty() && !app.remaining().empty()) return unexpected(app, chosen.json);
    return usage_error(e.what(), {}, help_of(app), chosen.json);
  }
  if (const auto name = given_empty(app))
    return usage_error(fmt::format("{}: the text is empty", *name), {}, help_of(app), chosen.json);
  return run_body(app, chosen);
}

}  // namespace
}  // namespace frustum::cli

int main(int argc, char** argv) {
  frustum::cli::hold_standard_streams();
  return frustum::cli::exit_after_output(frustum::cli::main_(argc, argv));
}
