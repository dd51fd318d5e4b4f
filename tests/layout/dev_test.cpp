// ./dev in a tree of its own, whose path has a space, with stand-ins for the programs it calls.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

struct Result {
  int exit_code;
  std::string out;
  std::string err;
};

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  if (std::ifstream file(path); file.peek() != EOF) text << file.rdbuf();
  return text.str();
}

class Dev : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    root_ = fs::path(testing::TempDir()) / ("frustum dev " + std::to_string(getpid()) + test->name());
    fs::create_directories(root_ / "stubs");
    fs::create_directories(root_ / "elsewhere");
    fs::copy_file(fs::path(FRUSTUM_SOURCE_DIR) / "dev", root_ / "dev");
    std::ofstream(root_ / "CMakePresets.json") << "{}";
    stub("id", "echo 1000");
    stub("sudo", "exit 1");
    stub("dpkg-query", "shift 3; for p; do [ $p = libhwy-dev ] || echo \"installed $p\"; done; exit 1");
    stub("apt-get", "echo \"$@\" >>'" + (root_ / "apt.log").string() + "'");
    stub("cmake",
         "d=build/release; mkdir -p $d/bin; touch $d/build.ninja\n"
         "echo \"CMAKE_HOME_DIRECTORY:INTERNAL=$PWD\" >$d/CMakeCache.txt\n"
         "printf '#!/bin/sh\\npwd; printf \"<%%s>\" \"$@\"\\n' >$d/bin/frustum; chmod +x $d/bin/frustum");
    stub("ninja", "echo 'ninja: no work to do.'");
  }
  void TearDown() override { fs::remove_all(root_); }

  void stub(const std::string& name, const std::string& body) {
    const fs::path path = root_ / "stubs" / name;
    std::ofstream(path) << "#!/bin/bash\n" << body << '\n';
    fs::permissions(path, fs::perms::owner_all);
  }
  void everything_is_installed() { stub("dpkg-query", "shift 3; for p; do echo \"installed $p\"; done"); }

  Result dev(const std::string& arguments) {
    const std::string at_root = "'" + root_.string() + "/";
    const std::string command = "cd " + at_root + "elsewhere' && PATH=" + at_root + "stubs:'\"$PATH\" " +
                                at_root + "dev' " + arguments + " </dev/null >" + at_root + "out' 2>" +
                                at_root + "err'";
    const int status = std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe): no other thread
    return {WEXITSTATUS(status), text_of(root_ / "out"), text_of(root_ / "err")};
  }

  fs::path root_;
};

TEST_F(Dev, HelpsWhenAskedForNothing) {
  const Result r = dev("");
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_THAT(r.out, HasSubstr("run GRAPH"));
}

TEST_F(Dev, RefusesAnUnknownCommand) {
  const Result r = dev("tset");
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("no command 'tset'"));
}

TEST_F(Dev, PrintsTheOneCommandWhenItMayNotInstall) {
  const Result r = dev("build");
  EXPECT_EQ(r.exit_code, 3);
  EXPECT_THAT(r.err, HasSubstr("  sudo apt-get install --no-install-recommends libhwy-dev\n"));
  EXPECT_FALSE(fs::exists(root_ / "apt.log"));
}

TEST_F(Dev, InstallsExactlyWhatIsMissingAsRoot) {
  stub("id", "echo 0");
  const Result r = dev("build");
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(text_of(root_ / "apt.log"), "-y update\n-y install --no-install-recommends libhwy-dev\n");
}

TEST_F(Dev, InstallsThroughASudoThatAsksNothing) {
  stub("sudo", "shift; exec \"$@\"");
  EXPECT_EQ(dev("build").exit_code, 0);
  EXPECT_THAT(text_of(root_ / "apt.log"), HasSubstr("install --no-install-recommends libhwy-dev"));
}

TEST_F(Dev, ShowsWhyAnInstallationFailed) {
  stub("id", "echo 0");
  stub("apt-get", "echo 'E: no such package'; exit 100");
  const Result r = dev("build");
  EXPECT_EQ(r.exit_code, 3);
  EXPECT_THAT(r.err, HasSubstr("E: no such package"));
}

TEST_F(Dev, RunsWhereItStandsWithTheArgumentsUntouched) {
  everything_is_installed();
  ASSERT_EQ(dev("build").exit_code, 0);
  const Result r = dev("run 'a b.json' --set 'x=\"*\"' ''");
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_EQ(r.out, (root_ / "elsewhere").string() + "\n<run><a b.json><--set><x=\"*\"><>");
  EXPECT_THAT(r.err, IsEmpty());
}

TEST_F(Dev, ConfiguresAgainOnlyWhenTheTreeHasMoved) {
  everything_is_installed();
  EXPECT_THAT(dev("build").err, HasSubstr("configuring build/release"));
  EXPECT_THAT(dev("build").err, IsEmpty());
  const fs::path moved = root_.string() + " moved";
  fs::rename(root_, moved);
  root_ = moved;
  EXPECT_THAT(dev("build").err, HasSubstr("configuring build/release"));
}

TEST_F(Dev, StopsAtABuildThatFails) {
  everything_is_installed();
  stub("ninja", "echo 'x.cpp:1: error: no'; exit 1");
  const Result r = dev("run graph.json");
  EXPECT_EQ(r.exit_code, 3);
  EXPECT_THAT(r.out, IsEmpty());
  EXPECT_THAT(r.err, HasSubstr("x.cpp:1: error: no\ndev: the build failed\n"));
}

}  // namespace
