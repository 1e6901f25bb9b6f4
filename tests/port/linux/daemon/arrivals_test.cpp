#include "port/linux/daemon/arrivals.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "port/linux/daemon/folder_watch.hpp"
#include "tests/port/linux/files/temporary_folder.hpp"

namespace flatpose::daemon {
namespace {

using Names = std::vector<std::string>;

TEST(Arrivals, CountWhenTheyBeganAndWereFinishedSinceTheMark) {
  Arrivals arrivals;
  arrivals.created("old", 1);
  arrivals.created("slow", 2);
  arrivals.closed("old");
  arrivals.mark();
  EXPECT_EQ(arrivals.fresh(), Names{});
  arrivals.closed("slow");  // was being written when the mark was made
  arrivals.closed("unseen");
  EXPECT_EQ(arrivals.fresh(), Names{});
  EXPECT_EQ(arrivals.stale(), "unseen");
  arrivals.created("b", 3);
  arrivals.created("a", 4);
  EXPECT_EQ(arrivals.fresh(), Names{});
  arrivals.closed("a");
  arrivals.closed("b");
  EXPECT_EQ(arrivals.fresh(), (Names{"a", "b"}));
  EXPECT_EQ(arrivals.find("b")->began_us, 3);
  arrivals.let_go("a");
  EXPECT_EQ(arrivals.fresh(), Names{"b"});
  arrivals.mark();
  EXPECT_EQ(arrivals.fresh(), Names{});
  EXPECT_EQ(arrivals.stale(), "");
}

TEST(Arrivals, WrittenOverInPlaceStayAsOldAsTheyAre) {
  Arrivals arrivals;
  arrivals.created("a", 1);
  arrivals.closed("a");
  arrivals.mark();
  arrivals.closed("a");
  EXPECT_EQ(arrivals.fresh(), Names{});
  arrivals.removed("a");
  arrivals.created("a", 2);
  arrivals.closed("a");
  EXPECT_EQ(arrivals.fresh(), Names{"a"});
  arrivals.created("a", 3);  // and once more, not finished yet
  EXPECT_EQ(arrivals.fresh(), Names{});
}

TEST(Arrivals, RenamedAreTheFilesThatTheyWere) {
  Arrivals arrivals;
  arrivals.created("old.tmp", 1);
  arrivals.mark();
  arrivals.created("new.tmp", 2);
  arrivals.closed("old.tmp");
  arrivals.closed("new.tmp");
  arrivals.moved_out("old.tmp", 7);
  arrivals.moved_in("old", 7, 3);
  arrivals.moved_out("new.tmp", 8);
  arrivals.moved_in("new", 8, 3);
  arrivals.moved_out("unseen.tmp", 9);
  arrivals.moved_in("unseen", 9, 3);
  EXPECT_EQ(arrivals.fresh(), Names{"new"});
  EXPECT_EQ(arrivals.find("new")->began_us, 2);
  EXPECT_FALSE(arrivals.find("new")->is_from_elsewhere);
}

TEST(Arrivals, RenamedBeforeTheyAreFinishedWaitForThat) {
  Arrivals arrivals;
  arrivals.created("a.tmp", 1);
  arrivals.moved_out("a.tmp", 7);
  arrivals.moved_in("a", 7, 2);
  EXPECT_EQ(arrivals.fresh(), Names{});
  arrivals.closed("a");
  EXPECT_EQ(arrivals.fresh(), Names{"a"});
}

TEST(Arrivals, MovedInFromElsewhereBeginThen) {
  Arrivals arrivals;
  arrivals.moved_out("gone", 6);
  arrivals.moved_in("a", 7, 5);
  EXPECT_EQ(arrivals.fresh(), Names{"a"});
  EXPECT_TRUE(arrivals.find("a")->is_from_elsewhere);
  EXPECT_EQ(arrivals.find("a")->began_us, 5);
  arrivals.moved_out("a", 8);
  EXPECT_EQ(arrivals.fresh(), Names{});
  EXPECT_EQ(arrivals.find("a"), nullptr);
}

TEST(Arrivals, ForgottenOnesAreOld) {
  Arrivals arrivals;
  arrivals.created("a", 1);
  arrivals.forget();
  arrivals.closed("a");
  EXPECT_EQ(arrivals.fresh(), Names{});
  arrivals.created("b", 2);
  arrivals.closed("b");
  EXPECT_EQ(arrivals.fresh(), Names{"b"});
}

TEST(Arrivals, TakeNoMoreThanTheirLimit) {
  Arrivals arrivals;
  for (std::size_t i = 0; i < 3 * kArrivalsMax; ++i) {
    const std::string name = "f" + std::to_string(i);
    arrivals.created(name, 1);
    if (i % 2 == 0) arrivals.closed(name);
  }
  EXPECT_LE(arrivals.fresh().size(), kArrivalsMax);
  arrivals.mark();
  arrivals.created("b", 2);
  arrivals.closed("b");
  EXPECT_EQ(arrivals.fresh(), Names{"b"});
}

class Folder : public testing::Test {
 protected:
  Folder() { EXPECT_TRUE(watch_.attach()); }
  Names read() {
    watch_.read(arrivals_, 1);
    return arrivals_.fresh();
  }
  void write(const std::string& name) const { (void)folder_.write(name, "x"); }
  int open(const std::string& name) const {
    return ::open(folder_.path(name).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  }

  port::TemporaryFolder folder_;
  FolderWatch watch_{folder_.path()};
  Arrivals arrivals_;
};

TEST_F(Folder, MarkParts) {
  write("before");
  const int slow = open("slow");
  const FolderWatch::Mark mark = watch_.mark();
  ASSERT_NE(mark, FolderWatch::kNoMark);
  EXPECT_FALSE(watch_.has_passed(mark));
  close(slow);
  write("after");
  // However late it is read.
  EXPECT_EQ(read(), Names{"after"});
  EXPECT_TRUE(watch_.has_passed(mark));
  const FolderWatch::Mark next = watch_.mark();
  EXPECT_FALSE(watch_.has_passed(next));
  EXPECT_EQ(read(), Names{});
  EXPECT_TRUE(watch_.has_passed(next));
  EXPECT_TRUE(watch_.has_passed(mark));
}

TEST_F(Folder, MovesAreSeenAsWhatTheyAre) {
  const port::TemporaryFolder elsewhere;
  (void)elsewhere.write("in", "x");
  write("old.part");
  (void)watch_.mark();
  write("new.part");
  std::filesystem::rename(folder_.path("old.part"), folder_.path("old"));
  std::filesystem::rename(folder_.path("new.part"), folder_.path("new"));
  std::filesystem::rename(elsewhere.path("in"), folder_.path("in"));
  EXPECT_EQ(read(), (Names{"new", "in"}));
  EXPECT_TRUE(arrivals_.find("in")->is_from_elsewhere);
  std::filesystem::remove(folder_.path("in"));
  EXPECT_EQ(read(), Names{"new"});
}

TEST_F(Folder, MoreThanTheQueueHoldsIsOldAndWhatComesThenIsNot) {
  const int slow = open("slow");
  const FolderWatch::Mark lost = [&] {
    for (int i = 0; i < 40'000; ++i)  // changes by turns: equal ones in a row are one
      (void)(i % 2 == 0 ? close(open("x")) : unlink(folder_.path("x").c_str()));
    return watch_.mark();
  }();
  close(slow);
  write("unseen");
  (void)read();
  EXPECT_TRUE(watch_.has_overflown());
  EXPECT_FALSE(watch_.has_overflown());
  while (!watch_.has_passed(lost)) EXPECT_EQ(read(), Names{});
  write("seen");
  EXPECT_EQ(read(), Names{"seen"});
  const FolderWatch::Mark next = watch_.mark();
  EXPECT_FALSE(watch_.has_passed(next));
  EXPECT_EQ(read(), Names{});
  EXPECT_TRUE(watch_.has_passed(next));
}

TEST_F(Folder, ThatGoesIsNoticedAndFoundAgain) {
  write("a");
  std::filesystem::remove_all(folder_.path());
  EXPECT_EQ(read(), Names{});
  EXPECT_FALSE(watch_.is_attached());
  EXPECT_FALSE(watch_.attach());
  std::filesystem::create_directory(folder_.path());
  EXPECT_TRUE(watch_.attach());
  write("b");
  EXPECT_EQ(read(), Names{"b"});
  // Another in its place, with no word of it in the queue: its parent was renamed, say.
  const std::string aside = folder_.path() + "-aside";
  std::filesystem::rename(folder_.path(), aside);
  std::filesystem::create_directory(folder_.path());
  EXPECT_TRUE(watch_.attach());
  write("c");
  EXPECT_EQ(read(), Names{"c"});
  std::filesystem::remove_all(aside);
}

}  // namespace
}  // namespace flatpose::daemon
