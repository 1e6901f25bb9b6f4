#include "port/linux/records/record_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <random>
#include <set>

#include "port/linux/files/input_error.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace {

/// What was synced, a letter each: a file or a folder.
std::string synced;

}  // namespace

/// In the place of the C library's.
extern "C" int fsync(int fd) {
  struct stat info {};
  synced += ::fstat(fd, &info) == 0 && S_ISDIR(info.st_mode) ? 'd' : 'f';
  return static_cast<int>(::syscall(SYS_fsync, fd));
}

namespace flatpose::port {
namespace {

namespace fs = std::filesystem;
using Kind = RecordName::Kind;

RecordName a_name(Kind kind, std::uint16_t number = 7) {
  return {0, "20260131T235959Z", number, kind, kind == Kind::kSaved ? "" : "status"};
}

struct Written {
  std::string stem;
  bool is_failed = false;
  std::int64_t bytes = 0;
};

std::set<std::string> stems_in(const std::string& path) {
  std::set<std::string> stems;
  for (const auto& entry : fs::directory_iterator(path)) stems.insert(entry.path().stem().string());
  return stems;
}

std::int64_t bytes_in(const std::string& path) {
  std::int64_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(path))
    bytes += static_cast<std::int64_t>(entry.file_size());
  return bytes;
}

Written add(RecordFolder& folder, Kind kind, std::size_t scan_bytes, std::size_t json_bytes = 10) {
  const RecordName name = folder.named(a_name(kind));
  folder.add(name, std::vector<std::byte>(scan_bytes), std::string(json_bytes, 'j'));
  return {name.text(), kind == Kind::kFailed, static_cast<std::int64_t>(scan_bytes + json_bytes)};
}

TEST(RecordFolder, KeepsTheLastAndMoreOfTheFailedWithinItsBytes) {
  std::mt19937 random(11);
  for (int round = 0; round < 25; ++round) {
    const TemporaryFolder base;
    const RecordLimits limits{static_cast<int>(random() % 6), static_cast<int>(random() % 6), 3,
                              static_cast<std::int64_t>(300 + random() % 2000)};
    std::deque<Written> all;  // newest first
    for (int i = 0; i < 25; ++i) {
      RecordFolder folder(base.path("r"), limits);  // each time as after a restart
      folder.open();
      const Kind kind = random() % 3 == 0 ? Kind::kFailed : i % 2 == 0 ? Kind::kFound : Kind::kDone;
      all.push_front(add(folder, kind, random() % 200));
      std::set<std::string> expected;  // by walking from the newest
      int count = 0;
      int failed_count = 0;
      std::int64_t bytes = 0;
      for (const Written& one : all) {
        const bool is_wanted =
            count < limits.last_count || (one.is_failed && failed_count < limits.failed_count);
        ++count;
        failed_count += one.is_failed ? 1 : 0;
        if (!is_wanted) continue;
        bytes += one.bytes;
        if (bytes > limits.bytes_max) break;
        expected.insert(one.stem);
      }
      std::erase_if(all, [&](const Written& one) { return !expected.contains(one.stem); });
      ASSERT_EQ(stems_in(base.path("r")), expected) << round << ", " << i;
      ASSERT_LE(bytes_in(base.path("r")), limits.bytes_max);
    }
  }
}

// Two files, then once the folder for both names; what is only a copy goes without.
TEST(RecordFolder, RecordOutlastsALossOfPowerForThreeSyncs) {
  const TemporaryFolder base;
  RecordFolder folder(base.path("r"), {});
  folder.open();
  synced.clear();
  add(folder, Kind::kFound, 100);
  EXPECT_EQ(synced, "ffd");
  synced.clear();
  add(folder, Kind::kFound, 0);  // without a scan
  EXPECT_EQ(synced, "fd");
  synced.clear();
  folder.put("last.json", {}, NewName::kMayBeLost);
  EXPECT_EQ(synced, "f");
  synced.clear();
  folder.put("picks.json", {});
  EXPECT_EQ(synced, "fd");
}

TEST(RecordFolder, LeavesStrangersAlone) {
  const TemporaryFolder base;
  const std::vector<std::string> names{"notes.txt",
                                       "record.pcd",
                                       "a.json",
                                       ".hidden",
                                       a_name(Kind::kFound).text() + ".txt",
                                       "record-0000000001-x-n1-found-ok.pcd"};
  for (const std::string& name : names) base.write(name, std::string(5000, 'x'));
  fs::create_directory(base.path(a_name(Kind::kFound).text() + ".pcd"));
  const std::string elsewhere = base.write("elsewhere", "x");
  fs::create_symlink(elsewhere,
                     base.path("record-0000000001-20260131T235959Z-n00001-found-ok.pcd"));
  RecordFolder folder(base.path(), {1, 0, 0, 100});
  folder.open();
  for (int i = 0; i < 5; ++i) add(folder, Kind::kFound, 50);
  for (const std::string& name : names) EXPECT_TRUE(fs::exists(base.path(name))) << name;
  EXPECT_TRUE(fs::exists(elsewhere));
  EXPECT_EQ(base.file_count(), names.size() + 3 + 2);
}

TEST(RecordFolder, TakesAwayWhatAKilledWriterLeftAndNothingOfALivingOne) {
  const TemporaryFolder base;
  const std::string parent = ".flatpose-" + std::to_string(getppid()) + "-0.tmp";
  const std::string own = ".flatpose-" + std::to_string(getpid()) + "-0.tmp";
  for (const std::string& name : {parent, own, std::string(".flatpose-999999999-1.tmp"),
                                  std::string(".flatpose-x.tmp"), std::string("999999999-1.tmp")})
    base.write(name, "half");
  RecordFolder(base.path(), {}).open();
  EXPECT_TRUE(fs::exists(base.path(parent)));
  EXPECT_FALSE(fs::exists(base.path(own)));
  EXPECT_FALSE(fs::exists(base.path(".flatpose-999999999-1.tmp")));
  EXPECT_TRUE(fs::exists(base.path(".flatpose-x.tmp")));
  EXPECT_TRUE(fs::exists(base.path("999999999-1.tmp")));
}

TEST(RecordFolder, SavedAreNeverRotatedAwayAndNeverMoreThanAllowed) {
  const TemporaryFolder base;
  RecordFolder folder(base.path(), {1, 0, 2, 400});
  const std::vector<std::byte> scan(1000);
  const auto save = [&] {
    const RecordName name = folder.named(a_name(Kind::kSaved));
    folder.save(name, scan, "{}");
  };
  save();
  for (int i = 0; i < 4; ++i) add(folder, Kind::kFound, 100);
  save();
  expect_input_error(save, {base.path(), "2 saved", "[records]"});
  add(folder, Kind::kFound, 100);
  EXPECT_EQ(base.file_count(), 2U * 2U + 2U);
}

TEST(RecordFolder, RecordThatIsTooLargeForAllTheBytesIsRefusedAndCostsNoOther) {
  const TemporaryFolder base;
  RecordFolder folder(base.path(), {5, 5, 5, 400});
  add(folder, Kind::kFound, 100);
  expect_input_error([&] { add(folder, Kind::kFound, 500); }, {base.path(), "max_mb"});
  EXPECT_EQ(base.file_count(), 2U);
}

TEST(RecordFolder, IsMadeWhenItsParentIsThere) {
  const TemporaryFolder base;
  RecordFolder folder(base.path("r"), {});
  folder.open();
  fs::remove_all(base.path("r"));
  add(folder, Kind::kFound, 1);
  EXPECT_TRUE(fs::exists(base.path("r")));
  RecordFolder orphan(base.path("no/r"), {});
  expect_input_error([&] { orphan.open(); }, {"no/r"});
  expect_input_error([&] { add(orphan, Kind::kFound, 1); }, {"no/r"});
}

TEST(RecordFolder, FindsTheNewestOfANumberThatIsNotTooOld) {
  const TemporaryFolder base;
  RecordFolder folder(base.path(), {});
  const auto put = [&](Kind kind, std::uint16_t number) {
    const RecordName name = folder.named(a_name(kind, number));
    if (kind == Kind::kSaved) {
      folder.save(name, {}, "{}");
    } else {
      folder.add(name, {}, "{}");
    }
    return name.sequence;
  };
  const std::uint64_t first = put(Kind::kFound, 3);
  put(Kind::kFound, 4);
  const std::uint64_t second = put(Kind::kFailed, 3);
  put(Kind::kSaved, 3);
  EXPECT_EQ(folder.find(3, first)->sequence, second);
  EXPECT_FALSE(folder.find(3, second + 1));
  EXPECT_FALSE(folder.find(5, 0));
}

}  // namespace
}  // namespace flatpose::port
