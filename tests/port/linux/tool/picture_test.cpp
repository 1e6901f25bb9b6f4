// Pictures: of the right size, and with the drawing where the part is.

#include "port/linux/files/png_image.hpp"
#include "tests/port/linux/tool/workbench.hpp"

namespace flatpose::tool {
namespace {

class Picture : public Workbench {
 protected:
  [[nodiscard]] port::PngImage image(const std::string& name) const {
    const std::string bytes = read(name);
    return port::read_png(name, port::as_bytes(bytes), port::PngKind::kColour8, {});
  }
  // Bounding box of the contour's orange, which the shading never has.
  struct Box {
    int x0 = 1 << 20, y0 = 1 << 20, x1 = -1, y1 = -1, count = 0;
  };
  static Box orange(const port::PngImage& picture) {
    Box box;
    for (int y = 0; y < picture.height_px; ++y) {
      for (int x = 0; x < picture.width_px; ++x) {
        const auto* p = &picture.rgba[4 * (static_cast<std::size_t>(y) * picture.width_px + x)];
        if (p[0] < 240 || p[1] < 160 || p[1] > 200 || p[2] > 60) continue;
        box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x), std::max(box.y1, y),
               box.count + 1};
      }
    }
    return box;
  }
};

TEST_F(Picture, OfAMatchHasTheContourWhereThePartIs) {
  simulate("single", 3, "a.pcd");
  teach("a.pcd", "pad.fpt", {"--preview", path("teach.png")});
  const json found = locate("pad.fpt", "a.pcd", {"--overlay", path("locate.png")});
  const Pose pose = pose_of(found.at("matches")[0]);
  for (const char* name : {"teach.png", "locate.png"}) {
    const port::PngImage picture = image(name);
    EXPECT_GE(picture.width_px, 1100);
    EXPECT_LE(picture.width_px, 1300);
    const Box box = orange(picture);
    EXPECT_GT(box.count, 500);
    // The field is 400 x 320 mm with its middle at 0; y runs upward in the picture.
    const double px_per_mm = picture.width_px / 400.0;
    const double map_middle_px = 0.5 * px_per_mm * 320.0;
    EXPECT_NEAR(0.5 * (box.x0 + box.x1), 0.5 * picture.width_px + px_per_mm * pose.position_mm.x,
                30.0);
    EXPECT_NEAR(0.5 * (box.y0 + box.y1), map_middle_px - px_per_mm * pose.position_mm.y, 30.0);
    EXPECT_GT(box.x1 - box.x0, 70.0 * px_per_mm);  // the pad is 150 x 70 mm
    EXPECT_LT(box.x1 - box.x0, 180.0 * px_per_mm);
  }
}

TEST_F(Picture, OfNothingFoundHasNoContour) {
  simulate("single", 3, "a.pcd");
  teach("a.pcd", "pad.fpt");
  simulate("empty", 3, "b.pcd");
  locate("pad.fpt", "b.pcd", {"--overlay", path("locate.png")}, 1);
  EXPECT_EQ(orange(image("locate.png")).count, 0);
}

TEST_F(Picture, ThatCannotBeWrittenIsAnErrorWithoutOutput) {
  simulate("single", 3, "a.pcd");
  teach("a.pcd", "pad.fpt");
  expect_refused(run({"locate", path("pad.fpt"), path("a.pcd"), "--json", "--overlay",
                      path("no/such/folder.png")}),
                 2, "cannot write it");
}

}  // namespace
}  // namespace flatpose::tool
