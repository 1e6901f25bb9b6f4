// Every state x every input, as a table.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/fieldbus/job/desk.hpp"

namespace flatpose::job {
namespace {

struct Step {
  const char* name;
  std::function<void(Desk&)> act;
};

void be_ready(Desk& desk) {
  desk.live();
  desk.write(std::uint16_t{0});
}
void be_busy(Desk& desk) {
  be_ready(desk);
  desk.write(1);
}
void be_shown(Desk& desk) {
  be_busy(desk);
  desk.finish(desk.found(3));
}

const std::vector<Step> kStates{
    {"asleep", [](Desk&) {}},
    {"ready", be_ready},
    {"busy", be_busy},
    {"shown", be_shown},
    {"refused",
     [](Desk& desk) {
       be_shown(desk);
       desk.write(2, static_cast<Command>(99));
     }},
    {"free",
     [](Desk& desk) {
       be_shown(desk);
       desk.pass(5 * kSecond_us);
       desk.live();
     }},
    {"dead",
     [](Desk& desk) {
       be_shown(desk);
       desk.read();
       desk.pass(2 * kSecond_us);
     }},
};

constexpr std::uint16_t kNew = 5;

Step asks(const char* name, Command command) {
  return {name, [command](Desk& desk) { desk.write(kNew, command); }};
}

const std::vector<Step> kInputs{
    asks("locate", Command::kLocate),
    asks("next", Command::kNext),
    asks("capture", Command::kCapture),
    asks("in_last", Command::kLocateInLast),
    asks("cancel", Command::kCancel),
    asks("clear", Command::kClearError),
    asks("verify", Command::kVerifyAlignment),
    asks("save", Command::kSaveScan),
    asks("report", Command::kReportPick),
    asks("reload", Command::kReloadJobs),
    asks("command 0", static_cast<Command>(0)),
    asks("command 11", static_cast<Command>(11)),
    {"job 2",
     [](Desk& desk) {
       CommandImage image = desk.image(kNew);
       image.job = 2;
       desk.write(image);
     }},
    {"old session",
     [](Desk& desk) {
       CommandImage image = desk.image(kNew);
       image.command_session = 320;
       desk.write(image);
     }},
    {"session",
     [](Desk& desk) {
       CommandImage image = desk.image(kNew);
       image.command_session = 321;
       desk.write(image);
     }},
    {"same", [](Desk& desk) { desk.write(desk.see().last_number); }},
    {"zero", [](Desk& desk) { desk.write(std::uint16_t{0}); }},
    {"Bob's", [](Desk& desk) { desk.write(kNew, Command::kLocate, kBob); }},
    {"nobody's", [](Desk& desk) { desk.write(kNew, Command::kLocate, kNobody); }},
    {"old line's", [](Desk& desk) { desk.write(desk.image(kNew), kAda, 0); }},
    {"control", [](Desk& desk) { desk.control(kTrigger); }},
    {"read", [](Desk& desk) { desk.read(); }},
    {"Bob reads", [](Desk& desk) { desk.read(kBob); }},
    {"scanned", [](Desk& desk) { desk.tell(SearchEvent::Kind::kScanned, desk.order.ticket); }},
    {"other scanned",
     [](Desk& desk) { desk.tell(SearchEvent::Kind::kScanned, desk.order.ticket + 1); }},
    {"finished", [](Desk& desk) { desk.finish(desk.found()); }},
    {"other finished",
     [](Desk& desk) {
       desk.tell(SearchEvent::Kind::kFinished, desk.order.ticket - 1, desk.found());
     }},
    {"source gone", [](Desk& desk) { desk.tell(SearchEvent::Kind::kSourceGone); }},
    {"jobs",
     [](Desk& desk) {
       const JobTable none;
       desk.process({.jobs = &none});
     }},
    {"1 s", [](Desk& desk) { desk.pass(kSecond_us); }},
    {"lease out",
     [](Desk& desk) { desk.pass(desk.see().owner_address == kNobody ? 1 : 5 * kSecond_us); }},
    {"answer late",
     [](Desk& desk) {
       desk.pass(kSecond_us);
       desk.read();
       desk.pass(kSecond_us);
     }},
};

/// What the wire and the search see of it, in words.
std::string told(const Snapshot& before, const Desk& desk) {
  const Snapshot now = desk.see();
  std::string text;
  const auto add = [&text](const std::string& word) { text += (text.empty() ? "" : " ") + word; };
  if (desk.out.verdict == Verdict::kNotOwner) add("exception");
  if (desk.out.verdict == Verdict::kBadValue) add("bad_value");
  if (desk.out.order.kind == Order::Kind::kStart) add("start");
  if (desk.out.order.kind == Order::Kind::kStop) add("stop");
  if (now.refused_number == kNew)
    add(name_of(refusal_names(), static_cast<int>(now.refused_status)));
  if (now.scanned_number != before.scanned_number) add("scanned");
  if (now.done_number != 0 &&
      (now.done_number != before.done_number || now.answer != before.answer))
    add(to_string(now.answer));
  if (now.cancelled_number != before.cancelled_number) add("cancelled_number");
  if (now.done_number == 0 && before.done_number != 0) add("withdrawn");
  return text.empty() ? "-" : text;
}

using Row = std::map<std::string, std::string>;

// Left out of a row: "-".
const std::map<std::string, Row> kTable{
    {"asleep",
     {{"locate", "not_ready"},
      {"next", "no_scan"},
      {"capture", "not_ready"},
      {"in_last", "not_ready"},
      {"cancel", "ok"},
      {"clear", "ok"},
      {"verify", "not_ready"},
      {"save", "not_ready"},
      {"report", "not_ready"},
      {"reload", "not_ready"},
      {"command 0", "bad_command"},
      {"command 11", "bad_command"},
      {"job 2", "bad_job"},
      {"old session", "stale_session"},
      {"session", "not_ready"},
      {"Bob's", "not_ready"},
      {"nobody's", "exception"},
      {"old line's", "not_ready"},
      {"control", "bad_value"}}},
    {"ready",
     {{"locate", "start"},
      {"next", "no_scan"},
      {"capture", "start"},
      {"in_last", "start"},
      {"cancel", "ok"},
      {"clear", "ok"},
      {"verify", "start"},
      {"save", "start"},
      {"report", "start"},
      {"reload", "start"},
      {"command 0", "bad_command"},
      {"command 11", "bad_command"},
      {"job 2", "bad_job"},
      {"old session", "stale_session"},
      {"session", "start"},
      {"Bob's", "exception"},
      {"nobody's", "exception"},
      {"old line's", "exception"},
      {"control", "bad_value"}}},
    {"busy",
     {{"locate", "busy"},
      {"next", "busy"},
      {"capture", "busy"},
      {"in_last", "busy"},
      {"cancel", "stop ok cancelled_number"},
      {"clear", "busy"},
      {"verify", "busy"},
      {"save", "busy"},
      {"report", "busy"},
      {"reload", "busy"},
      {"command 0", "bad_command"},
      {"command 11", "bad_command"},
      {"job 2", "busy"},
      {"old session", "stale_session"},
      {"session", "busy"},
      {"Bob's", "exception"},
      {"nobody's", "exception"},
      {"old line's", "exception"},
      {"control", "bad_value"},
      {"scanned", "scanned"},
      {"finished", "ok"},
      {"lease out", "stop answer_late"},
      {"answer late", "stop answer_late"}}},
    {"shown",
     {{"locate", "start withdrawn"},
      {"next", "ok"},
      {"capture", "start withdrawn"},
      {"in_last", "start withdrawn"},
      {"cancel", "ok"},
      {"clear", "ok"},
      {"verify", "start withdrawn"},
      {"save", "start withdrawn"},
      {"report", "start withdrawn"},
      {"reload", "start withdrawn"},
      {"command 0", "bad_command withdrawn"},
      {"command 11", "bad_command withdrawn"},
      {"job 2", "bad_job withdrawn"},
      {"old session", "stale_session withdrawn"},
      {"session", "start withdrawn"},
      {"Bob's", "exception"},
      {"nobody's", "exception"},
      {"old line's", "exception"},
      {"control", "bad_value"},
      {"lease out", "expired"}}},
    {"refused",
     {{"locate", "start"},
      {"next", "ok"},
      {"capture", "start"},
      {"in_last", "start"},
      {"cancel", "ok"},
      {"clear", "ok"},
      {"verify", "start"},
      {"save", "start"},
      {"report", "start"},
      {"reload", "start"},
      {"command 0", "bad_command"},
      {"command 11", "bad_command"},
      {"job 2", "bad_job"},
      {"old session", "stale_session"},
      {"session", "start"},
      {"Bob's", "exception"},
      {"nobody's", "exception"},
      {"old line's", "exception"},
      {"control", "bad_value"}}},
    {"free",
     {{"locate", "start withdrawn"},
      {"next", "expired"},
      {"capture", "start withdrawn"},
      {"in_last", "start withdrawn"},
      {"cancel", "ok"},
      {"clear", "ok"},
      {"verify", "start withdrawn"},
      {"save", "start withdrawn"},
      {"report", "start withdrawn"},
      {"reload", "start withdrawn"},
      {"command 0", "bad_command withdrawn"},
      {"command 11", "bad_command withdrawn"},
      {"job 2", "bad_job withdrawn"},
      {"old session", "stale_session withdrawn"},
      {"session", "start withdrawn"},
      {"Bob's", "start withdrawn"},
      {"nobody's", "exception"},
      {"old line's", "exception"},
      {"control", "bad_value"}}},
    {"dead",
     {{"locate", "not_ready withdrawn"},
      {"next", "ok"},
      {"capture", "not_ready withdrawn"},
      {"in_last", "not_ready withdrawn"},
      {"cancel", "ok"},
      {"clear", "ok"},
      {"verify", "not_ready withdrawn"},
      {"save", "not_ready withdrawn"},
      {"report", "not_ready withdrawn"},
      {"reload", "not_ready withdrawn"},
      {"command 0", "bad_command withdrawn"},
      {"command 11", "bad_command withdrawn"},
      {"job 2", "bad_job withdrawn"},
      {"old session", "stale_session withdrawn"},
      {"session", "not_ready withdrawn"},
      {"Bob's", "exception"},
      {"nobody's", "exception"},
      {"old line's", "exception"},
      {"control", "bad_value"},
      {"lease out", "expired"},
      {"answer late", "expired"}}},
};

TEST(JobMachine, EveryStateTimesEveryInput) {
  for (const Step& state : kStates) {
    const Row& row = kTable.at(state.name);
    for (const auto& [input, answer] : row) {
      const auto is_it = [&name = input](const Step& step) { return step.name == name; };
      ASSERT_NE(std::find_if(kInputs.begin(), kInputs.end(), is_it), kInputs.end()) << input;
    }
    for (const Step& input : kInputs) {
      Desk desk;
      state.act(desk);
      const Snapshot before = desk.see();
      desk.out = {};
      input.act(desk);
      const auto cell = row.find(input.name);
      EXPECT_EQ(told(before, desk), cell == row.end() ? "-" : cell->second)
          << state.name << " x " << input.name;
    }
  }
}

// Whatever the state and the input: the laws that no table needs to spell out.
TEST(JobMachine, LawsHoldInEveryStateAfterEveryInput) {
  for (const Step& state : kStates) {
    for (const Step& input : kInputs) {
      Desk desk;
      state.act(desk);
      input.act(desk);
      const Snapshot s = desk.see();
      const std::string where = std::string(state.name) + " x " + input.name;
      const auto has = [&s](Bit bit) { return (s.bits & bit) != 0; };
      EXPECT_FALSE(has(kBusy) && has(kDone)) << where;
      EXPECT_FALSE(has(kBusy) && has(kReady)) << where;
      EXPECT_TRUE(!has(kValid) || has(kDone)) << where;
      EXPECT_EQ(has(kValid), s.match.index != 0) << where;
      EXPECT_EQ(has(kDone), s.done_number != 0) << where;
      EXPECT_TRUE(s.done_number != 0 || s.answer == Answer::kPending) << where;
      EXPECT_TRUE(!has(kValid) || may_have_pose(s.answer)) << where;
      EXPECT_TRUE(s.refused_number == 0 || s.refused_number != s.done_number) << where;
      EXPECT_EQ(s.refused_number == 0, s.refused_status == Refusal::kNone) << where;
    }
  }
}

}  // namespace
}  // namespace flatpose::job
