// Bytes that no sound client sends. Every frame gets one answer, none harms the machine.

#include <random>

#include "tests/fieldbus/modbus/line.hpp"

namespace flatpose::modbus {
namespace {

bool is_sound(const Bytes& request, const Bytes& response) {
  if (response.empty() || response.size() > 253) return false;
  if (response[0] == request[0] && request[0] < 0x80) return true;
  const bool is_flagged = response[0] == (request[0] | 0x80);
  const int code = response.size() == 2 ? response[1] : 0;
  return is_flagged && (code == 1 || code == 2 || code == 3 || code == 4 || code == 6);
}

class Noise {
 public:
  std::uint8_t byte() { return static_cast<std::uint8_t>(engine_()); }
  int below(int limit) { return static_cast<int>(engine_() % static_cast<unsigned>(limit)); }

 private:
  std::mt19937 engine_{20};  // its numbers are the standard's, the same everywhere
};

TEST(HostileBytes, EveryFunctionTimesEveryLengthHasOneSoundAnswerOrIsClosed) {
  Line line;
  Noise noise;
  for (int function = 0; function < 256; ++function) {
    for (int length = 0; length <= 300; ++length) {
      Bytes frame{
          1, 2, 0, 0, static_cast<std::uint8_t>(length >> 8), static_cast<std::uint8_t>(length)};
      for (int i = 0; i < length; ++i) frame.push_back(i % 3 == 0 ? noise.byte() : std::uint8_t{0});
      if (length >= 1) frame[6] = 1;
      if (length >= 2) frame[7] = static_cast<std::uint8_t>(function);
      frame.resize(std::min<std::size_t>(frame.size(), kAduBytesMax));
      AduReader reader;
      std::copy(frame.begin(), frame.end(), reader.room().begin());
      reader.filled(frame.size());
      Adu adu;
      const auto step = reader.next(adu);
      ASSERT_EQ(step == AduReader::Step::kClose, length < 2 || length > 254) << length;
      if (step == AduReader::Step::kClose) continue;
      ASSERT_EQ(step, AduReader::Step::kAdu);
      const Bytes pdu(adu.pdu.begin(), adu.pdu.end());
      ASSERT_TRUE(is_sound(pdu, line.ask(pdu))) << function << " of " << length;
    }
  }
}

TEST(HostileBytes, RandomRequestsKeepTheMachinesLaws) {
  Noise noise;
  for (const job::Handshake handshake : {job::Handshake::kNumber, job::Handshake::kBits}) {
    Line line({.session_id = 321, .handshake = handshake});
    const Bytes functions{1, 2, 3, 4, 5, 6, 15, 16, 17, 22, 23, 43};
    for (int i = 0; i < 60'000; ++i) {
      Bytes pdu{functions[static_cast<std::size_t>(noise.below(12))]};
      const int bytes = noise.below(8) == 0 ? noise.below(252) : 4 + noise.below(16);
      for (int k = 0; k < bytes; ++k)  // small numbers are often right ones
        pdu.push_back(
            static_cast<std::uint8_t>(noise.below(4) == 0 ? noise.byte() : noise.below(12)));
      const job::Address asker = noise.below(4) == 0 ? job::kBob : job::kAda;
      ASSERT_TRUE(is_sound(pdu, line.ask(pdu, asker)));
      line.now_us += noise.below(20'000);
      if (noise.below(10) == 0) line.live();
      if (noise.below(5) == 0) line.finish(line.found(noise.below(12)));
      const job::Snapshot s = line.see();
      ASSERT_FALSE((s.bits & job::kBusy) && (s.bits & job::kDone));
      ASSERT_EQ((s.bits & job::kValid) != 0, s.match.index != 0);
      ASSERT_EQ(s.refused_number == 0, s.refused_status == job::Refusal::kNone);
    }
  }
}

TEST(HostileBytes, RandomStreamsAreFollowedOrClosedNeverOverrun) {
  Noise noise;
  for (int round = 0; round < 20'000; ++round) {
    AduReader reader;
    Adu adu;
    bool is_closed = false;
    for (int piece = 0; piece < 30 && !is_closed; ++piece) {
      const std::size_t most = std::min<std::size_t>(reader.room().size(), 40);
      ASSERT_GT(most, 0U);
      const auto bytes = static_cast<std::size_t>(1 + noise.below(static_cast<int>(most)));
      for (std::size_t i = 0; i < bytes; ++i)
        reader.room()[i] = noise.below(3) == 0 ? noise.byte() : std::uint8_t{0};
      reader.filled(bytes);
      auto step = reader.next(adu);
      for (; step == AduReader::Step::kAdu; step = reader.next(adu)) {
        ASSERT_GE(adu.pdu.size(), 1U);
        ASSERT_LE(adu.pdu.size(), 253U);
      }
      is_closed = step == AduReader::Step::kClose;
    }
  }
}

}  // namespace
}  // namespace flatpose::modbus
