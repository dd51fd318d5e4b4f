// Work in processes of its own: what crashes or hangs there ends there.
#pragma once

#include "runtime/core/context.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace frustum {

// How one piece of work ended.
struct IsolatedEnd {
  enum class Kind : std::uint8_t { done, crash, timeout };
  std::size_t tag = 0;
  Kind kind = Kind::done;
  std::string result;  // what the work returned; of `done` only
  std::string how;     // of a crash: "signal 11 (Segmentation fault)", "exit code 3"
  std::string said;    // the last 4 kB that it wrote to stdout and stderr
  std::chrono::nanoseconds time{0};
};

// Processes forked from this one, so that they start with everything that is loaded here. This one must
// never have started a thread of ours: after a fork only the forking thread is left, and whoever waits for
// another waits for ever. Every process leads a group of its own, which is killed as a whole; all end with
// this object and with this process, however that ends.
class IsolatedProcesses {
 public:
  explicit IsolatedProcesses(std::size_t jobs);
  ~IsolatedProcesses();
  IsolatedProcesses(const IsolatedProcesses&) = delete;
  IsolatedProcesses& operator=(const IsolatedProcesses&) = delete;

  bool full() const;
  bool empty() const;

  // Starts `work` under the name `tag`; its result comes back through wait(). An exception in it is a crash
  // with its text. Throws WorldError where there are no more processes or descriptors to be had.
  void start(std::size_t tag, std::chrono::nanoseconds timeout, const std::function<std::string()>& work);

  // Waits until one or more ended and gives them; kills those whose time is over. Throws Cancelled, all
  // being killed first.
  std::vector<IsolatedEnd> wait(const CancelFlag* cancel);

 private:
  struct Process;
  std::size_t jobs_;
  std::vector<std::unique_ptr<Process>> running_;
};

}  // namespace frustum
