// Runs a program and keeps what it says.
#pragma once

#include <string>
#include <vector>

namespace frustum::test {

struct ProcessResult {
  int code = -1;  // exit code, or 128 + the signal that ended it
  std::string out, err;
};

// The program with its arguments, its folder (empty: the test's own) and further "NAME=VALUE" of the
// environment. Throws std::runtime_error where it cannot be started.
ProcessResult run_process(const std::vector<std::string>& command, const std::string& folder = {},
                          const std::vector<std::string>& environment = {});

// The `frustum` that was built with this test.
std::string frustum_program();
ProcessResult frustum(std::vector<std::string> arguments, const std::string& folder = {},
                      const std::vector<std::string>& environment = {});

}  // namespace frustum::test
