#include "runtime/cli/command.h"

#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string_view>

namespace frustum::cli {
namespace {

CancelFlag cancel;

static_assert(std::atomic<bool>::is_always_lock_free, "the handler may touch nothing else");

extern "C" void on_signal(int) {
  if (cancel.cancelled()) std::_Exit(Exit::cancelled);
  cancel.cancel();
}

// Read before any thread starts.
std::string_view environment(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe)
  return value != nullptr ? value : "";
}

bool terminal() {
  static const bool is = ::isatty(STDERR_FILENO) == 1 && environment("TERM") != "dumb";
  return is;
}

}  // namespace

bool color_on_stderr() {
  static const bool wanted = terminal() && environment("NO_COLOR").empty();
  return wanted;
}

bool progress_on_stderr() { return terminal(); }

CancelFlag& cancel_flag() { return cancel; }

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // a reader that went away is a failed write, not the end of the process
}

}  // namespace frustum::cli
