// What is wrong with files: one line, a remedy, the right exit code, and nothing left half written.

#include <filesystem>

#include "flatpose/core/fnv.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "port/linux/tool/canvas.hpp"
#include "tests/port/linux/tool/workbench.hpp"

namespace flatpose::tool {
namespace {

std::string pcd(int width, int height, const std::string& body) {
  const std::string w = std::to_string(width);
  const std::string h = std::to_string(height);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + w +
         "\nHEIGHT " + h + "\nVIEWPOINT 0 0 500 1 0 0 0\nPOINTS " + std::to_string(width * height) +
         "\nDATA ascii\n" + body;
}

std::string points(int width, int height, const char* z) {
  std::string body;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column)
      body += std::to_string(column) + " " + std::to_string(row) + " " + z + "\n";
  }
  return body;
}

class BadScan : public Workbench {
 protected:
  // Every command that reads a scan refuses this one alike.
  void expect_refused_by_all(const std::string& bytes, const std::string& part) {
    const std::string scan = folder_.write("bad.pcd", bytes);
    make_part();
    const std::size_t count = folder_.file_count();
    expect_refused(run({"teach", scan, "-o", path("new.fpt"), "--preview", path("new.png")}), 2,
                   part);
    expect_refused(run({"locate", path("pad.fpt"), scan, "--json", "--overlay", path("new.png")}),
                   2, part);
    expect_refused(run({"test", path("pad.fpt"), scan}), 2, part);
    expect_refused(run({"align", scan, "-o", path("new.json")}), 2, part);
    expect_refused(run({"info", scan}), 2, part);
    EXPECT_EQ(folder_.file_count(), count);
  }

  void make_part() {
    simulate("single", 3, "good.pcd");
    teach("good.pcd", "pad.fpt");
  }
};

TEST_F(BadScan, Truncated) { expect_refused_by_all(pcd(3, 3, points(3, 2, "1")), "bad.pcd"); }
TEST_F(BadScan, NotOrganized) {
  expect_refused_by_all(pcd(9, 1, points(9, 1, "1")), "not organized");
}
TEST_F(BadScan, OfNoSize) { expect_refused_by_all(pcd(0, 0, ""), "bad.pcd"); }
TEST_F(BadScan, OfAnotherKind) { expect_refused_by_all("hello world\n", "bad.pcd"); }
TEST_F(BadScan, Empty) { expect_refused_by_all("", "bad.pcd"); }
TEST_F(BadScan, InfiniteCoordinate) {
  expect_refused_by_all(pcd(3, 3, points(3, 3, "inf")), "infinite");
}
TEST_F(BadScan, GiantCoordinate) {
  expect_refused_by_all(pcd(3, 3, points(3, 3, "2e7")), "1e6 mm");
}

TEST_F(BadScan, OverTheLimitNamesTheOption) {
  make_part();
  expect_refused(run({"locate", path("pad.fpt"), path("good.pcd"), "--max-points", "1000"}), 2,
                 "--max-points");
  expect_refused(run({"info", path("missing.pcd")}), 2, "missing.pcd");
}

TEST_F(BadScan, AllMissingIsAnOutcome) {
  make_part();
  const std::string scan = folder_.write("bad.pcd", pcd(40, 30, points(40, 30, "nan")));
  const std::size_t count = folder_.file_count();
  expect_refused(run({"teach", scan, "-o", path("new.fpt")}), 1, "every point is missing");
  expect_refused(run({"align", scan, "-o", path("new.json")}), 1, "every point is missing");
  EXPECT_EQ(folder_.file_count(), count);
  const json found = locate("pad.fpt", "bad.pcd", {"--overlay", path("new.png")}, 1);
  EXPECT_EQ(found.at("status"), "scan_poor");
  EXPECT_TRUE(found.at("matches").empty());
  EXPECT_EQ(run({"locate", path("pad.fpt"), scan}).code, 1);
  EXPECT_EQ(run({"test", path("pad.fpt"), scan}).code, 1);
  EXPECT_EQ(run({"info", scan, "--json"}).code, 0);
}

class BadTemplate : public Workbench {
 protected:
  void SetUp() override {
    simulate("single", 3, "good.pcd");
    teach("good.pcd", "pad.fpt");
    bytes_ = read("pad.fpt");
  }
  void expect_refused_by_all(const std::string& bytes, const std::string& why,
                             const std::string& remedy) {
    const std::string part = folder_.write("bad.fpt", bytes);
    for (const Words& words : {Words{"locate", part, path("good.pcd"), "--json"},
                               Words{"test", part, path("good.pcd")}}) {
      expect_refused(run(words), 2, why);
      expect_refused(run(words), 2, remedy);
    }
  }
  std::string bytes_;
};

TEST_F(BadTemplate, OfANewerVersion) {
  bytes_[4] = 99;
  expect_refused_by_all(bytes_, "written by a newer flatpose", "update this one");
  expect_refused(run({"info", path("bad.fpt")}), 2, "written by a newer flatpose");
}

TEST_F(BadTemplate, WithAFlippedByte) {
  for (const std::size_t at : {std::size_t{24}, bytes_.size() / 2, bytes_.size() - 1}) {
    std::string flipped = bytes_;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    expect_refused_by_all(flipped, "damaged", "copy or teach it again");
    expect_refused(run({"info", path("bad.fpt")}), 2, "damaged");
  }
}

TEST_F(BadTemplate, CutOffOrOfAnotherKind) {
  expect_refused_by_all(bytes_.substr(0, bytes_.size() / 2), "cut off", "copy or teach it again");
  expect_refused_by_all(bytes_.substr(0, 6), "cut off", "copy or teach it again");
  expect_refused_by_all(read("good.pcd"), "it is no template", "flatpose teach");
  expect_refused_by_all("x", "it is no template", "flatpose teach");
  expect_refused_by_all("", "it is empty", "copy or teach it again");
}

class BadLesson : public Workbench {
 protected:
  void SetUp() override { simulate("single", 3, "good.pcd"); }
  void expect_no_lesson(const Words& more, const std::string& part) {
    const std::size_t count = folder_.file_count();
    Words words{"teach", path("good.pcd"), "-o", path("new.fpt"), "--preview", path("new.png")};
    words.insert(words.end(), more.begin(), more.end());
    expect_refused(run(words), 2, part);
    EXPECT_EQ(folder_.file_count(), count);
  }
};

TEST_F(BadLesson, RegionWithoutAPart) {
  expect_no_lesson({"--region", "circle:5000,5000,20"}, "; ");
  expect_no_lesson({"--mask", path("good.pcd")}, "good.pcd");
}

std::string painted(const Colour& colour, double width_px) {
  Canvas canvas(200, 160);  // as large as the workbench's scans
  canvas.colour(colour);
  canvas.box(20, 20, width_px, 20);
  return std::string(port::as_text(canvas.png()));
}

TEST_F(BadLesson, MaskThatMarksNoPartIsToBlameItself) {
  const std::string red = folder_.write("red.png", painted({1.0, 0.0, 0.0}, 30.0));
  expect_no_lesson({"--mask", red}, red + ": too little of its blue");
  const std::string blue = folder_.write("blue.png", painted({0.0, 0.0, 1.0}, 30.0));
  expect_no_lesson({"--mask", blue}, blue + ": too few edges");
}

TEST_F(BadLesson, OfTwoOutputsBothOrNeither) {
  const std::size_t count = folder_.file_count();
  const Words taught{"teach", path("good.pcd"), "-o", path("a.fpt"), "--preview", path("no/a.png")};
  const Words made{"simulate", "empty", "--seed", "1",       "--cols",  "9",
                   "--rows",   "9",     "-o",     path("b"), "--truth", path("no/b.json")};
  expect_refused(run(taught), 2, "no/a.png: cannot write it");
  expect_refused(run(made), 2, "no/b.json: cannot write it");
  EXPECT_EQ(folder_.file_count(), count);

  folder_.write("a.fpt", "old");
  folder_.write("b", "older");
  expect_refused(run(taught), 2, "no/a.png: cannot write it");
  expect_refused(run(made), 2, "no/b.json: cannot write it");
  EXPECT_EQ(read("a.fpt"), "old");
  EXPECT_EQ(read("b"), "older");
  // The other way round: where the first fails, the second was not begun.
  expect_refused(run({"teach", path("good.pcd"), "-o", path("no/a.fpt"), "--preview", path("c")}),
                 2, "no/a.fpt: cannot write it");
  EXPECT_FALSE(std::filesystem::exists(path("c")));
}

TEST_F(BadLesson, OutputThatCannotBeWritten) {
  const std::size_t count = folder_.file_count();
  expect_refused(run({"teach", path("good.pcd"), "-o", path("no/such/folder.fpt")}), 2,
                 "cannot write it");
  expect_refused(run({"teach", path("good.pcd"), "-o", "/dev/full"}), 2, "/dev/full");
  expect_refused(run({"teach", path("good.pcd"), "-o", folder_.path()}), 2, "folder");
  expect_refused(run({"align", path("good.pcd"), "-o", path("no/such/folder.json")}), 2,
                 "cannot write it");
  expect_refused(
      run({"simulate", "empty", "--seed", "1", "--cols", "9", "--rows", "9", "-o", path("no/a")}),
      2, "cannot write it");
  EXPECT_EQ(folder_.file_count(), count);
}

TEST_F(BadLesson, OutputThatIsAnInputIsLeftAlone) {
  const std::string before = read("good.pcd");
  std::filesystem::create_symlink(path("good.pcd"), path("link.fpt"));
  expect_refused(run({"teach", path("good.pcd"), "-o", path("good.pcd")}), 2, "written over");
  expect_refused(run({"teach", path("good.pcd"), "-o", path("link.fpt")}), 2, "written over");
  expect_refused(run({"teach", path("good.pcd"), "-o", path("a.fpt"), "--preview", path("a.fpt")}),
                 2, "two outputs");
  EXPECT_EQ(read("good.pcd"), before);
}

TEST_F(BadLesson, NameThatNobodyCanPrint) {
  expect_no_lesson({"--name", "a\nb"}, "--name");
  expect_no_lesson({"--name", std::string(64, 'a')}, "--name");
}

TEST_F(BadLesson, WorkFileOfAnotherSide) {
  EXPECT_EQ(run({"align", path("good.pcd"), "-o", path("work.json")}).code, 0);
  expect_no_lesson({"--work", path("work.json"), "--up", "-z"}, "contradicts");
  expect_no_lesson({"--work", path("good.pcd")}, "good.pcd");
}

// A damaged checksum must not hide behind an equal one: the test's own idea of the file.
TEST_F(BadTemplate, HeaderIsAsTheFormatSays) {
  ASSERT_EQ(bytes_.substr(0, 4), "FPT\n");
  Fnv1a64 hash;
  hash.add(port::as_bytes(std::string_view(bytes_).substr(20)));
  std::uint64_t stored = 0;
  for (int i = 7; i >= 0; --i)
    stored = stored << 8 | static_cast<unsigned char>(bytes_[12 + static_cast<std::size_t>(i)]);
  EXPECT_EQ(hash.value(), stored);
}

}  // namespace
}  // namespace flatpose::tool
