#include "flatpose/job/status.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "flatpose/job/command.hpp"

namespace flatpose::job {
namespace {

TEST(Answer, HasOneTextForEachNumberWithoutAGap) {
  std::set<int> values;
  std::set<std::string> names;
  for (const AnswerText& text : answer_texts()) {
    EXPECT_TRUE(values.insert(static_cast<int>(text.answer)).second);
    EXPECT_TRUE(names.insert(text.name).second) << text.name;
    EXPECT_GT(std::string(text.cause).size(), 10U);
    EXPECT_GT(std::string(text.remedy).size(), 5U);
  }
  EXPECT_EQ(*values.begin(), static_cast<int>(Answer::kOutOfRange));
  EXPECT_EQ(*values.rbegin(), static_cast<int>(Answer::kFaceUnsure));
  EXPECT_EQ(static_cast<int>(values.size()), *values.rbegin() - *values.begin() + 1);
}

TEST(Answer, HasTheNamesOfALocateOutcome) {
  for (int i = -4; i <= 2; ++i) {
    const auto outcome = static_cast<locate::Outcome>(i);
    EXPECT_STREQ(to_string(answer_of(outcome)), locate::to_string(outcome));
  }
  EXPECT_STREQ(to_string(static_cast<Answer>(1234)), "unknown");
}

TEST(Answer, WithAPoseIsNoFault) {
  for (const AnswerText& text : answer_texts()) {
    EXPECT_FALSE(may_have_pose(text.answer) && is_fault(text.answer)) << text.name;
  }
  EXPECT_FALSE(is_fault(Answer::kNoMatch));
  EXPECT_TRUE(is_fault(Answer::kInternal));
}

TEST(Command, EveryNumberHasAName) {
  for (int raw = 0; raw < 70000; raw += raw < 20 ? 1 : 97) {
    const auto word = static_cast<std::uint16_t>(raw);
    EXPECT_EQ(is_command(word), std::string(name_of(command_names(), word)) != "unknown") << word;
  }
  EXPECT_STREQ(name_of(refusal_names(), static_cast<int>(Refusal::kStaleSession)), "stale_session");
  EXPECT_EQ(static_cast<int>(bit_names().size()), kBitCount);
  EXPECT_EQ(static_cast<int>(control_bit_names().size()), kControlBitCount);
}

}  // namespace
}  // namespace flatpose::job
