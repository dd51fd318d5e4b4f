#include "runtime/core/temporary_files.h"

#include "runtime/core/error.h"
#include "runtime/core/partial_file.h"
#include "runtime/graph/cache_file.h"
#include "runtime/graph/disk_cache.h"
#include "tests/support/temp_file.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <thread>
#include <vector>

namespace frustum {
namespace {

using std::filesystem::exists;
using std::filesystem::is_empty;

TEST(TemporaryFiles, AreRemovedUntilTheyAreForgotten) {
  const test::TempFolder folder;
  const std::string half = folder.write("half", "x"), whole = folder.write("whole", "y");
  remember_temporary_file(half);
  remember_temporary_file(whole);
  remember_temporary_file(folder.file("never made"));
  forget_temporary_file(whole);
  remove_temporary_files();
  EXPECT_FALSE(exists(half));
  EXPECT_TRUE(exists(whole));
  // What is removed is forgotten; forgetting it again is no harm.
  folder.write("half", "z");
  remove_temporary_files();
  EXPECT_TRUE(exists(half));
  for (const char* name : {"half", "never made", "unknown"}) forget_temporary_file(folder.file(name));
  remember_temporary_file(half);
  remove_temporary_files();
  EXPECT_FALSE(exists(half));
  forget_temporary_file(half);
}

TEST(TemporaryFiles, OfPartialFilesAreThoseThatAreNotFinished) {
  const test::TempFolder folder;
  PartialFile finished(folder.file("finished"));
  finished.add("a");
  finished.commit();
  PartialFile begun(folder.file("begun"));
  begun.add("b");
  EXPECT_FALSE(exists(folder.file("begun")));
  remove_temporary_files();
  EXPECT_TRUE(exists(folder.file("finished")));
  std::filesystem::remove(folder.file("finished"));
  EXPECT_TRUE(is_empty(folder.path()));
}

TEST(PartialFiles, LeaveNoEmptyFolderOfTheirOwn) {
  const test::TempFolder folder;
  std::filesystem::create_directory(folder.file("old"));
  {
    PartialFile a(folder.file("old/new/deep/a")), b(folder.file("old/new/b"));
    a.add("a");
    EXPECT_TRUE(exists(folder.file("old/new/deep")));
  }
  EXPECT_TRUE(is_empty(folder.file("old"))) << "what was there before stays";
  {
    PartialFile a(folder.file("new/deep/a")), b(folder.file("new/b"));
    b.commit();
  }
  EXPECT_FALSE(exists(folder.file("new/deep")));
  EXPECT_TRUE(exists(folder.file("new/b")));
}

// Nobody makes folders there, not even root.
TEST(PartialFiles, SayWhyTheirFolderCannotBeMade) {
  if (!exists("/sys/kernel")) GTEST_SKIP() << "no /sys";
  try {
    const PartialFile file("/sys/kernel/frustum_test/deep/file.txt");
    FAIL();
  } catch (const WorldError& e) {
    EXPECT_EQ(e.code, "cannot_write_file");
    EXPECT_EQ(std::string(e.what()).find("No such file"), std::string::npos) << e.what();
  }
  try {
    const DiskCache cache("/sys/kernel/frustum_test/deep", 1 << 20);
    FAIL();
  } catch (const WorldError& e) {
    EXPECT_EQ(e.code, "cache_unusable");
    EXPECT_EQ(std::string(e.what()).find("No such file"), std::string::npos) << e.what();
  }
}

TEST(TemporaryFiles, OfTheCacheAreThoseThatAreNotFinished) {
  const test::TempFolder folder;
  CacheFileWriter finished(folder.file("part"), CacheContent::notes);
  finished.write("a", 1);
  EXPECT_EQ(finished.commit({}, folder.file("finished")), FileFault::none);
  CacheFileWriter begun(folder.file("begun"), CacheContent::notes);
  begun.write("b", 1);
  ASSERT_TRUE(exists(folder.file("begun")));
  remove_temporary_files();
  EXPECT_FALSE(exists(folder.file("begun")));
  EXPECT_TRUE(exists(folder.file("finished")));
  // A name that is free again may be another's.
  const std::string other = folder.write("part", "c");
  remove_temporary_files();
  EXPECT_TRUE(exists(other));
}

// A handler may run while every thread is busy with files.
TEST(TemporaryFiles, MayBeRemovedWhileOthersAreMade) {
  const test::TempFolder folder;
  std::atomic<bool> done{false};
  std::vector<std::thread> writers;
  for (int t = 0; t < 4; ++t)
    writers.emplace_back([&, t] {
      for (int i = 0; i < 500; ++i) {
        const std::string name = folder.file(std::to_string(t) + "_" + std::to_string(i % 7));
        remember_temporary_file(name);
        forget_temporary_file(name);
      }
    });
  std::thread handler([&] {
    while (!done) remove_temporary_files();
  });
  for (auto& w : writers) w.join();
  done = true;
  handler.join();
  EXPECT_TRUE(is_empty(folder.path()));
}

}  // namespace
}  // namespace frustum
