// Cases in processes of their own: what ends one ends no other, and nothing is left running.
#include "runtime/app/suite/isolate.h"

#include "tests/support/process.h"
#include "tests/support/suite_runs.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <thread>

namespace frustum {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string act(const std::string& id, const std::string& what, const std::string& more = "") {
  return R"({"id": ")" + id + R"(", "graph": "act.json", "set": {"made:what": ")" + what + "\"}" + more + "}";
}

TEST(SuiteIsolation, ACrashAndAHangAreResultsAndEverythingElsePasses) {
  if (test::done_in_a_fresh_process()) return;
  const test::SuiteFolder folder;
  std::string cases = act("crash", "crash") + "," + act("hang", "hang", R"(, "timeout": 1)") + "," +
                      act("exit", "exit") + "," + act("say", "say");
  for (int i = 0; i < 20; ++i) cases += "," + act("good " + std::to_string(i), "nothing");
  SuiteOptions options;
  options.jobs = 3;
  const auto r = folder.run(cases, options);
  ASSERT_EQ(r.size(), 24u);
  EXPECT_EQ(r[0].verdict, CaseVerdict::crash);
  EXPECT_THAT(r[0].failures, ElementsAre(HasSubstr("signal 11 (Segmentation fault)")));
  EXPECT_EQ(r[1].verdict, CaseVerdict::timeout);
  EXPECT_THAT(r[1].failures, ElementsAre("it did not end within 1 s"));
  EXPECT_EQ(r[2].verdict, CaseVerdict::crash);
  EXPECT_THAT(r[2].failures, ElementsAre(HasSubstr("exit code 7")));
  EXPECT_NE(r[3].verdict, CaseVerdict::pass);
  EXPECT_THAT(r[3].said, HasSubstr("what it said \xEF\xBF\xBD")) << "as UTF-8";
  for (std::size_t i = 4; i < r.size(); ++i)
    EXPECT_EQ(r[i].verdict, CaseVerdict::pass) << r[i].id << testing::PrintToString(r[i].failures);
}

// Whoever is quicker, the case or what would end it.
TEST(SuiteIsolation, ACaseThatEndsLateIsLate) {
  if (test::done_in_a_fresh_process()) return;
  const test::SuiteFolder folder;
  std::string cases;
  for (int i = 0; i < 20; ++i)
    cases += (i == 0 ? "" : ",") + act("late " + std::to_string(i), "nothing", R"(, "timeout": 1e-6)");
  SuiteOptions options;
  options.jobs = 2;
  for (const CaseResult& r : folder.run(cases, options)) EXPECT_EQ(r.verdict, CaseVerdict::timeout) << r.id;
}

TEST(SuiteIsolation, GivesTheResultsOfOneProcess) {
  if (test::done_in_a_fresh_process()) return;
  const test::SuiteFolder folder;
  const std::string cases =
      R"({"id": "a", "graph": "image.json", "checks": [{"port": "out", "shape": {"width": 9}}]},
      {"id": "b", "graph": "image.json", "matrix": {"made:add": [0, 1, 2]}})";
  SuiteOptions options;
  options.jobs = 2;
  auto apart = folder.run(cases, options), here = folder.run(cases);
  ASSERT_EQ(apart.size(), here.size());
  for (std::size_t i = 0; i < here.size(); ++i) {
    apart[i].time = here[i].time = {};
    EXPECT_EQ(case_to_json(apart[i]).dump(), case_to_json(here[i]).dump());
  }
}

TEST(SuiteIsolation, CancellingLeavesNothingRunning) {
  if (test::done_in_a_fresh_process()) return;
  CancelFlag flag;
  {
    IsolatedProcesses processes(2);
    for (std::size_t i = 0; i < 2; ++i)
      processes.start(i, std::chrono::hours(1), []() -> std::string {
        for (;;) ::pause();
      });
    EXPECT_TRUE(processes.full());
    flag.cancel();
    EXPECT_THROW(processes.wait(&flag), Cancelled);
    EXPECT_TRUE(processes.empty());
  }
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "no child is left";
}

TEST(SuiteIsolation, AnExceptionIsACrashWithItsText) {
  if (test::done_in_a_fresh_process()) return;
  IsolatedProcesses processes(1);
  processes.start(7, std::chrono::hours(1), []() -> std::string { throw std::runtime_error("no reason"); });
  const auto ends = processes.wait(nullptr);
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].tag, 7u);
  EXPECT_EQ(ends[0].kind, IsolatedEnd::Kind::crash);
  EXPECT_EQ(ends[0].said, "no reason\n");
}

TEST(SuiteIsolation, ALargeResultComesBackWhole) {
  if (test::done_in_a_fresh_process()) return;
  IsolatedProcesses processes(1);
  processes.start(0, std::chrono::hours(1), [] { return std::string(5 << 20, 'x'); });
  EXPECT_EQ(processes.wait(nullptr).at(0).result.size(), std::size_t{5} << 20);
}

// The real program: a suite that takes long, stopped as by Ctrl-C.
TEST(SuiteIsolation, AnInterruptEndsTheProgramWith130AndItsProcesses) {
  const test::TempFolder folder;
  std::filesystem::create_directories(folder.file("suites"));
  const std::string suite =
      folder.write("suites/long.json",
                   R"({"format": "frustum.suite/1", "cases": [{"id": "long", "graph": ")" +
                       std::string(FRUSTUM_SOURCE_DIR) +
                       R"(/graphs/gallery/teapot.json", "set": {"resolution": [3000, 3000], "samples": 64},
      "matrix": {"mesh:tolerance_px": [0.1, 0.2, 0.3]}}]})");
  const pid_t program = ::fork();
  ASSERT_GE(program, 0);
  if (program == 0) {
    ::setpgid(0, 0);
    ::execl(test::frustum_program().c_str(), "frustum", "test", suite.c_str(), "-j2", nullptr);
    ::_exit(127);
  }
  const auto children = [&] {
    std::ifstream in("/proc/" + std::to_string(program) + "/task/" + std::to_string(program) + "/children");
    std::vector<pid_t> out;
    for (pid_t p = 0; in >> p;) out.push_back(p);
    return out;
  };
  std::vector<pid_t> cases;
  for (int i = 0; i < 1000 && cases.size() < 2; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    cases = children();
  }
  ASSERT_EQ(cases.size(), 2u);
  ::kill(program, SIGINT);
  int status = 0;
  ASSERT_EQ(::waitpid(program, &status, 0), program);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  for (const pid_t p : cases) EXPECT_EQ(::kill(p, 0), -1) << p << " is still there";
}

}  // namespace
}  // namespace frustum
