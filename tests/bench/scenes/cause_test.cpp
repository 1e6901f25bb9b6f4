#include "bench/scenes/cause.hpp"

#include <gtest/gtest.h>

#include "flatpose/core/maths.hpp"

namespace flatpose::bench {
namespace {

Rotation turn(double angle_deg) { return rotation_about_z(angle_deg * kRadPerDeg); }
Rotation lean(double angle_deg) { return rotation_from_vector({angle_deg * kRadPerDeg, 0.0, 0.0}); }

/// Two pads, the second hidden, and a look-alike, far from each other.
Shot made_shot() {
  Shot shot;
  shot.part = "pad";
  shot.truths = {{{turn(30.0), {-150.0, 0.0, 8.0}}, 0.9}, {{turn(0.0), {150.0, 100.0, 8.0}}, 0.2}};
  shot.clutter = {{"lookalike", {turn(0.0), {100.0, -120.0, 8.0}}, 1.0}};
  return shot;
}

std::string cause(const Shot& shot, const std::vector<Pose>& found, bool expects_target = true) {
  Trial trial;
  trial.scan_T_found = found;
  trial.first = judge_first(found, shot.truths, 1);
  trial.all = judge_all(found, shot.truths, 1, 20);
  return cause_of_first(trial, shot, 1, expects_target);
}

std::string cause_off_by(const Rotation& rotation, const Vec3& position_mm) {
  const Shot shot = made_shot();
  return cause(shot, {shot.truths[0].scan_T_part * Pose{rotation, position_mm}});
}

TEST(Cause, IsEmptyWhenAllIsWell) {
  EXPECT_EQ(cause_off_by(lean(0.3) * turn(0.3), {0.3, 0.3, 0.3}), "");
  Shot without = made_shot();
  without.truths.clear();
  EXPECT_EQ(cause(without, {}, false), "");
}

TEST(Cause, NamesTheBoundThatIsBrokenMost) {
  EXPECT_EQ(cause_off_by(turn(6.0), {9.0, 0.0, 0.0}), "position");
  EXPECT_EQ(cause_off_by(turn(20.0), {9.0, 0.0, 0.0}), "turn");
  EXPECT_EQ(cause_off_by(lean(40.0), {}), "tilt");
  EXPECT_EQ(cause_off_by(turn(178.0), {20.0, 0.0, 0.0}), "flip");
  EXPECT_EQ(cause_off_by(lean(180.0), {}), "upside_down");
  EXPECT_EQ(cause_off_by({}, {2.0, 0.0, 0.0}), "fine_position");
  EXPECT_EQ(cause_off_by(lean(3.0), {2.0, 0.0, 0.0}), "fine_tilt");
  EXPECT_EQ(cause_off_by(turn(3.0), {2.0, 0.0, 0.0}), "fine_turn");
}

TEST(Cause, NamesWhatTheAnswerLiesOn) {
  const Shot shot = made_shot();
  EXPECT_EQ(cause(shot, {shot.truths[1].scan_T_part}), "hidden_instance");
  EXPECT_EQ(cause(shot, {shot.clutter[0].scan_T_object}), "false_match_on_lookalike");
  EXPECT_EQ(cause(shot, {Pose{}}), "false_match");
}

TEST(Cause, TellsNoAnswerFromNoTarget) {
  Shot shot = made_shot();
  EXPECT_EQ(cause(shot, {}), "not_found");
  shot.truths.erase(shot.truths.begin());
  EXPECT_EQ(cause(shot, {}), "no_target");
  EXPECT_EQ(cause(shot, {shot.clutter[0].scan_T_object}, false), "false_match_on_lookalike");
}

TEST(Cause, ListsAllThatIsWrongWithSeveral) {
  Trial trial;
  EXPECT_EQ(cause_of_all(trial), "");
  trial.all.missed = {1};
  EXPECT_EQ(cause_of_all(trial), "missed");
  trial.all.double_matches = {2};
  trial.all.wrong_matches = {0};
  EXPECT_EQ(cause_of_all(trial), "wrong+double+missed");
}

TEST(Stage, TellsWhereAnInstanceWasLost) {
  const auto taught = std::make_unique<Taught>();
  taught->part.score_threshold = 0.7;
  const locate::LocateConfig config;
  EXPECT_EQ(stage_of({}, *taught, config), "search");
  EXPECT_EQ(stage_of({true, 0.6, 0.9}, *taught, config), "verification");
  EXPECT_EQ(stage_of({true, 0.9, 0.4}, *taught, config), "verification");
  EXPECT_EQ(stage_of({true, 0.9, 0.9}, *taught, config), "competition");
}

}  // namespace
}  // namespace flatpose::bench
