#include "port/linux/files/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::port {
namespace {

std::string content(const std::string& path) {
  return std::string(as_text(read_file(path, 1 << 20)));
}

TEST(ReadFile, GivesAllBytesUpToItsBound) {
  const TemporaryFolder folder;
  const std::string path = folder.write("f", std::string("a\0b\n", 4));
  EXPECT_EQ(content(path), std::string("a\0b\n", 4));
  EXPECT_EQ(read_file(path, 4).size(), 4u);
  expect_input_error([&] { (void)read_file(path, 3); }, {path, "4 bytes", "3 allowed"});
  EXPECT_TRUE(read_file(folder.write("empty", ""), 10).empty());
}

TEST(ReadFile, BoundsFilesThatSayTheyAreEmpty) {
  EXPECT_FALSE(read_file("/proc/self/status", 1 << 20).empty());
  expect_input_error([] { (void)read_file("/proc/self/status", 10); }, {"10 allowed"});
}

TEST(ReadFile, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  const auto expect = [](const std::string& path, std::string_view why) {
    expect_input_error([&] { (void)read_file(path, 100); }, {path, why});
  };
  expect(folder.path("missing"), "No such file");
  expect(folder.path(), "it is a folder");
  ASSERT_EQ(::mkfifo(folder.path("pipe").c_str(), 0600), 0);
  expect(folder.path("pipe"), "it is a pipe");
  expect("/dev/zero", "it is a device");
  expect("", "No such file");
  ASSERT_EQ(::symlink("loop", folder.path("loop").c_str()), 0);
  expect(folder.path("loop"), "symbolic links");
}

TEST(ReadFile, EscapesHostileNames) {
  expect_input_error([] { (void)read_file("/nowhere/\x1b[2J\n", 100); }, {"\\x1b[2J\\x0a"});
}

TEST(WriteFileAtomically, WritesAndReplaces) {
  const TemporaryFolder folder;
  const std::string path = folder.path("out");
  write_file_atomically(path, "one");
  write_file_atomically(path, "second");
  EXPECT_EQ(content(path), "second");
  EXPECT_EQ(folder.file_count(), 1u);
  write_file_atomically(path, "");
  EXPECT_EQ(content(path), "");
}

TEST(WriteFileAtomically, KeepsRightsAndFollowsLinks) {
  const TemporaryFolder folder;
  const std::string path = folder.write("out", "one");
  ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
  ASSERT_EQ(::symlink("out", folder.path("link").c_str()), 0);
  write_file_atomically(folder.path("link"), "two");
  EXPECT_EQ(content(path), "two");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link")));
  struct stat info {};
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0640u);
}

TEST(WriteFileAtomically, TakesNamesWithoutAFolderAndLongNames) {
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  write_file_atomically("plain", "x");
  write_file_atomically(std::string(255, 'n'), "y");
  std::filesystem::current_path(before);
  EXPECT_EQ(content(folder.path("plain")), "x");
  EXPECT_EQ(folder.file_count(), 2u);
  expect_input_error([&] { write_file_atomically(folder.path(std::string(256, 'n')), "z"); },
                     {"too long", "shorter name"});
  EXPECT_EQ(folder.file_count(), 2u);
}

TEST(WriteFileAtomically, RefusesWhatItMustNotReplace) {
  const TemporaryFolder folder;
  expect_input_error([&] { write_file_atomically(folder.path(), "x"); }, {"it is a folder"});
  expect_input_error([&] { write_file_atomically("/dev/full", "x"); }, {"it is a device"});
  expect_input_error([&] { write_file_atomically("", "x"); }, {"name is empty"});
  expect_input_error([&] { write_file_atomically(folder.path("no/where"), "x"); },
                     {"No such file", "create the folder"});
  expect_input_error([&] { write_file_atomically("/proc/flatpose", "x"); }, {"cannot write it"});
  EXPECT_EQ(folder.file_count(), 0u);
}

// Root may write everywhere, so a test that runs as root becomes somebody else for a moment.
class Nobody {
 public:
  Nobody() : was_root_(::geteuid() == 0 && ::seteuid(65534) == 0) {}
  ~Nobody() {
    if (was_root_ && ::seteuid(0) != 0) std::abort();
  }
  Nobody(const Nobody&) = delete;
  Nobody& operator=(const Nobody&) = delete;

 private:
  bool was_root_;
};

TEST(WriteFileAtomically, LeavesTheOldFileWhenTheRightsAreMissing) {
  const TemporaryFolder folder;
  const std::string path = folder.write("out", "old");
  ASSERT_EQ(::chmod(folder.path().c_str(), 0555), 0);
  const auto refused = [&](const char* name) {
    const Nobody nobody;
    expect_input_error([&] { write_file_atomically(folder.path(name), "new"); },
                       {"Permission denied", "name a folder that you may write to"});
  };
  refused("out");  // neither the folder nor the file may be written
  refused("new");
  ASSERT_EQ(::chmod(folder.path().c_str(), 0777), 0);
  ASSERT_EQ(::chmod(path.c_str(), 0444), 0);
  refused("out");  // the folder may, the file not
  ASSERT_EQ(::chmod(path.c_str(), 0000), 0);
  {
    const Nobody nobody;
    expect_input_error([&] { (void)read_file(path, 10); }, {"Permission denied", "owner"});
  }
  ASSERT_EQ(::chmod(path.c_str(), 0600), 0);
  EXPECT_EQ(content(path), "old");
  EXPECT_EQ(folder.file_count(), 1u);
}

// A disk that fills up in the middle: the system stops the file at 8 KiB.
TEST(WriteFileAtomically, LeavesNothingWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  const std::string path = folder.write("out", "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit full{8192, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
  expect_input_error([&] { write_file_atomically(path, std::string(100'000, 'x')); },
                     {path, "File too large", "make room"});
  expect_input_error([&] { write_file_atomically(folder.path("new"), std::string(10'000, 'x')); },
                     {"make room"});
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(content(path), "old");
  EXPECT_EQ(folder.file_count(), 1u);
}

}  // namespace
}  // namespace flatpose::port
