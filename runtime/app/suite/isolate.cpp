#include "runtime/app/suite/isolate.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>

namespace frustum {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int failed_with_exception = 113;  // of our own children only, beside what they say
constexpr off_t tail_bytes = 4096;

// A descriptor that is closed with its owner.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {
    if (fd_ < 0)
      throw WorldError("no_process", fmt::format("cannot start a process: {}", std::strerror(errno)));
  }
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  int get() const { return fd_; }

 private:
  int fd_ = -1;
};

// A file in memory: what a process leaves behind, however it ends, without anybody having to read along.
Descriptor memory_file(const char* name) { return Descriptor(::memfd_create(name, MFD_CLOEXEC)); }

std::string content(const Descriptor& file, off_t most) {
  const off_t size = ::lseek(file.get(), 0, SEEK_END);
  const off_t first = std::max<off_t>(0, size - most);
  std::string text(static_cast<std::size_t>(std::max<off_t>(0, size - first)), '\0');
  std::size_t have = 0;
  while (have < text.size()) {
    const ssize_t n =
        ::pread(file.get(), text.data() + have, text.size() - have, first + static_cast<off_t>(have));
    if (n <= 0) break;
    have += static_cast<std::size_t>(n);
  }
  text.resize(have);
  return text;
}

void write_all(int fd, const std::string& text) {
  for (std::size_t have = 0; have < text.size();) {
    const ssize_t n = ::write(fd, text.data() + have, text.size() - have);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) ::_exit(failed_with_exception);
    have += static_cast<std::size_t>(n);
  }
}

// The life of a child from the fork to its end. Destructors of static objects do not run: threads of this
// process, which are not there, might be waited for.
[[noreturn]] void live(pid_t parent, int result, int said, const std::function<std::string()>& work) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(failed_with_exception);  // it ended before it could be told
  for (const int s : {SIGINT, SIGTERM}) ::signal(s, SIG_DFL);
  ::dup2(said, STDOUT_FILENO), ::dup2(said, STDERR_FILENO);
  if (const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC); nothing >= 0)
    ::dup2(nothing, STDIN_FILENO);
  int code = 0;
  try {
    write_all(result, work());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    code = failed_with_exception;
  }
  std::fflush(nullptr);
  ::_exit(code);
}

std::string how_it_ended(const siginfo_t& info) {
  if (info.si_code != CLD_EXITED)
    return fmt::format("signal {} ({})", info.si_status, ::strsignal(info.si_status));
  if (info.si_status == failed_with_exception) return "an exception";
  return fmt::format("exit code {}", info.si_status);
}

}  // namespace

struct IsolatedProcesses::Process {
  std::size_t tag = 0;
  pid_t pid = 0;
  Descriptor handle, result, said;
  Clock::time_point began, deadline;
  bool killed = false;
  bool reaped = false;

  ~Process() {
    if (reaped) return;
    ::kill(-pid, SIGKILL);
    ::kill(pid, SIGKILL);  // before it made its group
    siginfo_t info{};
    while (::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED) < 0 && errno == EINTR) {
    }
  }

  IsolatedEnd reap() {
    siginfo_t info{};
    while (::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED) < 0 && errno == EINTR) {
    }
    reaped = true;
    ::kill(-pid, SIGKILL);  // what it may have started
    IsolatedEnd end{.tag = tag,
                    .kind = IsolatedEnd::Kind::done,
                    .result = {},
                    .how = {},
                    .said = content(said, tail_bytes),
                    .time = Clock::now() - began};
    const bool ended = info.si_code == CLD_EXITED && info.si_status == 0;
    if (ended && Clock::now() > deadline)  // before it could be killed
      end.kind = IsolatedEnd::Kind::timeout;
    else if (ended)
      end.result = content(result, std::numeric_limits<off_t>::max());
    else
      end.kind = killed ? IsolatedEnd::Kind::timeout : IsolatedEnd::Kind::crash, end.how = how_it_ended(info);
    return end;
  }
};

IsolatedProcesses::IsolatedProcesses(std::size_t jobs) : jobs_(std::max<std::size_t>(jobs, 1)) {}
IsolatedProcesses::~IsolatedProcesses() = default;

bool IsolatedProcesses::full() const { return running_.size() >= jobs_; }
bool IsolatedProcesses::empty() const { return running_.empty(); }

void IsolatedProcesses::start(std::size_t tag, std::chrono::nanoseconds timeout,
                              const std::function<std::string()>& work) {
  auto process = std::make_unique<Process>();
  process->reaped = true;  // nothing to end yet
  process->tag = tag, process->result = memory_file("result"), process->said = memory_file("said");
  std::fflush(nullptr);  // what is buffered here is not to be written twice
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0)
    throw WorldError("no_process", fmt::format("cannot start a process: {}", std::strerror(errno)));
  if (pid == 0) live(parent, process->result.get(), process->said.get(), work);
  ::setpgid(pid, pid);  // in both, since either may be first
  process->pid = pid, process->reaped = false;
  process->handle = Descriptor(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)));
  process->began = Clock::now(), process->deadline = process->began + timeout;
  running_.push_back(std::move(process));
}

std::vector<IsolatedEnd> IsolatedProcesses::wait(const CancelFlag* cancel) {
  using std::chrono::milliseconds;
  std::vector<IsolatedEnd> ends;
  while (ends.empty() && !running_.empty()) {
    if (cancel != nullptr && cancel->cancelled()) {
      running_.clear();
      throw Cancelled();
    }
    std::vector<pollfd> handles;
    auto until =
        Clock::now() + milliseconds(100);  // a signal between the check above and poll() waits no longer
    for (const auto& p : running_) {
      handles.push_back({p->handle.get(), POLLIN, 0});
      if (!p->killed) until = std::min(until, p->deadline);
    }
    const auto left = std::chrono::ceil<milliseconds>(until - Clock::now()).count();
    ::poll(handles.data(), handles.size(), static_cast<int>(std::clamp<long>(left, 0, 100)));
    for (std::size_t i = handles.size(); i-- > 0;) {
      Process& p = *running_[i];
      if (handles[i].revents != 0) {
        ends.push_back(p.reap());
        running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
      } else if (!p.killed && Clock::now() >= p.deadline) {
        p.killed = true;
        ::kill(-p.pid, SIGKILL);
      }
    }
  }
  return ends;
}

}  // namespace frustum
