#include "bench/scenes/sensors.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace flatpose::bench {
namespace {

TEST(Sensors, AreTheSimulatorsDefaultMadeWorseInOneWayEach) {
  const sim::SensorConfig usual;
  EXPECT_EQ(sensor_named("standard").columns, usual.columns);
  EXPECT_EQ(sensor_named("standard").laser_noise_mm, usual.laser_noise_mm);
  EXPECT_EQ(sensor_named("noise").laser_noise_mm, 1.0);
  EXPECT_EQ(sensor_named("lost").lost_share, 0.2);
  EXPECT_EQ(sensor_named("half").columns, usual.columns / 2);
  EXPECT_EQ(sensor_named("half").rows, usual.rows / 2);
  EXPECT_EQ(sensor_named("half").field_x_mm, usual.field_x_mm);
}

TEST(Sensors, AreAllValidAndUnknownOnesAreRefused) {
  for (const std::string& name : sensor_names())
    EXPECT_EQ(sim::validate(sensor_named(name)), "") << name;
  EXPECT_THROW((void)sensor_named("best"), std::invalid_argument);
}

}  // namespace
}  // namespace flatpose::bench
