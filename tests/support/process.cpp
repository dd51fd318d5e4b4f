#include "tests/support/process.h"

#include "tests/support/temp_file.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace frustum::test {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void redirect(int target, const std::string& path, int flags) {
  const int file = ::open(path.c_str(), flags, 0600);
  if (file < 0 || ::dup2(file, target) < 0) ::_exit(126);
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& command, const std::string& folder,
                          const std::vector<std::string>& environment) {
  const TempFolder said;
  std::vector<char*> argv;
  for (const std::string& a : command) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
    redirect(STDOUT_FILENO, said.file("out"), O_WRONLY | O_CREAT);
    redirect(STDERR_FILENO, said.file("err"), O_WRONLY | O_CREAT);
    for (const std::string& e : environment)
      ::putenv(const_cast<char*>(e.c_str()));  // NOLINT(concurrency-mt-unsafe)
    if (!folder.empty() && ::chdir(folder.c_str()) != 0) ::_exit(126);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  if (::waitpid(child, &status, 0) != child) throw std::runtime_error("cannot wait for " + command.front());
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, text_of(said.file("out")), text_of(said.file("err"))};
}

std::string frustum_program() {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "frustum").string();
}

ProcessResult frustum(std::vector<std::string> arguments, const std::string& folder,
                      const std::vector<std::string>& environment) {
  arguments.insert(arguments.begin(), frustum_program());
  return run_process(arguments, folder, environment);
}

}  // namespace frustum::test
