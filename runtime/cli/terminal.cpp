#include "runtime/cli/command.h"
#include "runtime/core/temporary_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string_view>

namespace frustum::cli {
namespace {

CancelFlag cancel;

static_assert(std::atomic<bool>::is_always_lock_free, "the handler sets it");

// The first signal ends the work in good order, the second the process; neither leaves a half-written file.
extern "C" void on_signal(int) {
  if (cancel.cancelled()) {
    remove_temporary_files();
    std::_Exit(Exit::cancelled);
  }
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

void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
    const int taken =
        ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);  // the lowest free number
    if (taken != stream) std::_Exit(Exit::world_failed);
  }
}

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // The terminal went away; under nohup that is ignored, and stays so.
  struct sigaction before {};
  if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);  // so is one beyond the size that files may have
  std::signal(SIGPIPE, SIG_IGN);  // a reader that went away is a failed write, not the end of the process
}

}  // namespace frustum::cli
