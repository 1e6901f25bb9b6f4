#include "port/sim/sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/port/sim/box.hpp"

namespace flatpose::sim {
namespace {

TEST(Ruler, StandsWhereTheConfigSays) {
  SensorConfig config;
  config.laser_angle_rad = -0.1;
  const Ruler ruler(config);
  EXPECT_EQ(ruler.laser_mm().z, 1300.0);
  EXPECT_EQ(ruler.camera_mm().z, 1300.0);
  EXPECT_NEAR(ruler.laser_mm().y, -1300.0 * std::tan(0.1), 1e-9);
  EXPECT_NEAR(ruler.camera_mm().y, 1300.0 * std::tan(22.0 * kPi / 180.0), 1e-9);
}

TEST(Ruler, GridHasOnePitchAndItsMiddleAtTheOrigin) {
  const Ruler ruler{SensorConfig{}};
  EXPECT_EQ(ruler.floor_point_mm(0, 0), (Vec3{-299.5, -249.5, 0.0}));
  EXPECT_EQ(ruler.floor_point_mm(599, 499), (Vec3{299.5, 249.5, 0.0}));
  EXPECT_EQ(ruler.floor_point_mm(1, 0) - ruler.floor_point_mm(0, 0), (Vec3{1.0, 0.0, 0.0}));
  EXPECT_EQ(ruler.floor_point_mm(0, 1) - ruler.floor_point_mm(0, 0), (Vec3{0.0, 1.0, 0.0}));
}

TEST(Ruler, FieldNarrowsTowardTheLaser) {
  const Ruler ruler{SensorConfig{}};
  EXPECT_TRUE(ruler.in_field({299.9, 0, 0}));
  EXPECT_FALSE(ruler.in_field({300.1, 0, 0}));
  const double half_mm = 300.0 * (1300.0 - 130.0) / 1300.0;  // 270 at a height of 130
  EXPECT_TRUE(ruler.in_field({half_mm - 0.1, 0, 130}));
  EXPECT_FALSE(ruler.in_field({half_mm + 0.1, 0, 130}));
  EXPECT_FALSE(ruler.in_field({0, 0, 1300}));
}

TEST(Ruler, FacesAreSeenFromBothOrNotAtAll) {
  const Ruler ruler{SensorConfig{}};
  EXPECT_TRUE(ruler.faces_both({0, 0, 0}, {0, 0, 1}));
  EXPECT_FALSE(ruler.faces_both({0, 0, 0}, {0, 0, -1}));
  EXPECT_FALSE(ruler.faces_both({0, -200, 0}, {0, -1, 0}));  // turned from both
  EXPECT_FALSE(ruler.faces_both({0, 200, 0}, {0, -1, 0}));   // turned to the laser only
  EXPECT_TRUE(ruler.faces_both({0, -200, 0}, {0, 1, 0}));    // laser at 81.3 degrees
  EXPECT_FALSE(ruler.faces_both({0, -50, 0}, {0, 1, 0}));    // laser at 87.8 degrees: too oblique
}

TEST(SensorConfig, DefaultsAreValid) { EXPECT_EQ(validate(SensorConfig{}), ""); }

TEST(SensorConfig, EveryBadFieldHasItsReason) {
  const auto reason = [](auto spoil) {
    SensorConfig config;
    spoil(config);
    EXPECT_EQ(validate(config).empty(), false);
    EXPECT_THROW(Ruler{config}, std::invalid_argument);
    return validate(config);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto says = [](const std::string& text, const char* word) {
    EXPECT_NE(text.find(word), std::string::npos) << text;
  };
  says(reason([](auto& c) { c.columns = 1; }), "columns");
  says(reason([](auto& c) { c.rows = -5; }), "rows");
  says(reason([](auto& c) { c.columns = c.rows = 2000; }), "points");
  says(reason([](auto& c) { c.columns = c.rows = std::numeric_limits<int>::max(); }), "points");
  says(reason([&](auto& c) { c.field_x_mm = nan; }), "field_x_mm");
  says(reason([](auto& c) { c.field_y_mm = 0.0; }), "field_y_mm");
  says(reason([](auto& c) { c.stand_off_mm = -1.0; }), "stand_off_mm");
  says(reason([](auto& c) { c.laser_angle_rad = 1.5; }), "laser_angle_rad");
  says(reason([](auto& c) { c.camera_angle_rad = c.laser_angle_rad; }), "different angles");
  says(reason([&](auto& c) { c.laser_noise_mm = nan; }), "laser_noise_mm");
  says(reason([](auto& c) { c.camera_noise_mm = -0.1; }), "camera_noise_mm");
  says(reason([](auto& c) { c.lost_share = 1.1; }), "lost_share");
  says(reason([](auto& c) { c.mixed_share = -0.1; }), "mixed_share");
  says(reason([](auto& c) { c.footprint_mm = 51.0; }), "footprint_mm");
  says(reason([](auto& c) { c.quantisation_mm = -1.0; }), "quantisation_mm");
  says(reason([](auto& c) { c.incidence_max_rad = 2.0; }), "incidence_max_rad");
}

TEST(SensorConfig, TakesTwoMegapixels) {
  SensorConfig config;
  config.columns = 1536;
  config.rows = 1280;
  EXPECT_EQ(validate(config), "");
}

}  // namespace
}  // namespace flatpose::sim
