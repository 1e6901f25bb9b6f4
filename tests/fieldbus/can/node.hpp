#pragma once
// A node on the desk: the device with a job machine behind it, a master's hands before it, and all
// frames that it sent.

#include <initializer_list>
#include <string>
#include <vector>

#include "flatpose/can/device.hpp"
#include "tests/fieldbus/job/desk.hpp"

namespace flatpose::can {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::uint8_t kNode = 10;
inline constexpr std::uint8_t kMaster = 127;

inline Frame frame_of(std::uint32_t id, const Bytes& bytes) {
  Frame frame;
  frame.id = id;
  frame.size = static_cast<std::uint8_t>(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) frame.data[i] = bytes[i];
  return frame;
}

class Node {
 public:
  explicit Node(const Config& config = {}, const job::Config& machine = {.session_id = 321})
      : desk(machine), device(desk.machine) {
    EXPECT_EQ(device.init(config, desk.now_us), Status::kOk);
    drain();
  }

  /// What goes out now; also all of it in `sent`.
  std::vector<Frame> drain() {
    std::vector<Frame> fresh;
    Frame frame;
    for (int i = 0; i < 100 && device.next_frame(desk.now_us, frame); ++i) fresh.push_back(frame);
    sent.insert(sent.end(), fresh.begin(), fresh.end());
    return fresh;
  }
  std::vector<Frame> process(const Inputs& inputs) {
    const job::Outputs out = device.process(desk.now_us, inputs);
    if (out.order.kind != job::Order::Kind::kNone) desk.order = out.order;
    return drain();
  }
  std::vector<Frame> take(const Frame& frame) { return process({.frame = &frame}); }
  std::vector<Frame> take(std::uint32_t id, const Bytes& bytes) {
    return take(frame_of(id, bytes));
  }
  std::vector<Frame> pass(std::int64_t us) {
    desk.now_us += us;
    return process({});
  }

  std::vector<Frame> network(NetworkCommand command, std::uint8_t node = kNode) {
    return take(kNmtId, {static_cast<std::uint8_t>(command), node});
  }
  void start() {
    network(NetworkCommand::kStart);
    pass(10'000);
  }
  std::vector<Frame> heartbeat(std::uint8_t node = kMaster, std::uint8_t state = 5) {
    return take(kHeartbeatBase + node, {state});
  }
  std::vector<Frame> rpdo(std::uint16_t number, std::uint8_t command = 1,
                          std::uint16_t argument = 1, std::uint16_t session = 0,
                          std::uint8_t outcome = 0) {
    Bytes bytes(8);
    put_number(bytes, 0, 2, number);
    put_number(bytes, 2, 2, session);
    bytes[4] = command;
    bytes[5] = outcome;
    put_number(bytes, 6, 2, argument);
    return take(kRpdoBase + kNode, bytes);
  }

  /// The answer to one SDO request; empty: none came.
  Bytes sdo(const Bytes& request) {
    for (const Frame& frame : take(kSdoRequestBase + kNode, request)) {
      if (frame.id == kSdoAnswerBase + kNode)
        return {frame.data.begin(), frame.data.begin() + frame.size};
    }
    return {};
  }
  static Bytes object(std::uint8_t head, std::uint16_t index, std::uint8_t subindex,
                      std::uint32_t value = 0) {
    Bytes bytes(8);
    bytes[0] = head;
    put_number(bytes, 1, 2, index);
    bytes[3] = subindex;
    put_number(bytes, 4, 4, value);
    return bytes;
  }
  /// Reads an object of up to four bytes.
  std::uint32_t read(std::uint16_t index, std::uint8_t subindex) {
    const Bytes answer = sdo(object(0x40, index, subindex));
    EXPECT_EQ(answer.size(), 8U);
    if (answer.size() != 8) return 0;
    EXPECT_EQ(answer[0] & 0xe3, 0x43) << "aborted with " << std::hex << number_at(answer, 4, 4);
    return number_at(answer, 4, 4U - (answer[0] >> 2 & 3));
  }
  /// Writes one; returns why not.
  Abort write(std::uint16_t index, std::uint8_t subindex, std::uint32_t value, int size) {
    const auto head = static_cast<std::uint8_t>(0x23 | (4 - size) << 2);
    return abort_in(sdo(object(head, index, subindex, value)));
  }
  static Abort abort_in(const Bytes& answer) {
    EXPECT_EQ(answer.size(), 8U);
    if (answer.size() != 8 || answer[0] != 0x80) return Abort::kNone;
    return static_cast<Abort>(number_at(answer, 4, 4));
  }
  /// A whole object by segments.
  Bytes read_all(std::uint16_t index, std::uint8_t subindex) {
    Bytes answer = sdo(object(0x40, index, subindex));
    if (answer.empty() || answer[0] == 0x80) return {};
    if ((answer[0] & 2) != 0) {
      const auto end = answer.begin() + 8 - (answer[0] >> 2 & 3);
      return {answer.begin() + 4, end};
    }
    const std::uint32_t size = number_at(answer, 4, 4);
    Bytes all;
    std::uint8_t toggle = 0;
    for (int i = 0; i < 200; ++i, toggle ^= 0x10) {
      answer = sdo({static_cast<std::uint8_t>(0x60 | toggle), 0, 0, 0, 0, 0, 0, 0});
      if (answer.empty() || (answer[0] & 0xe0) != 0 || (answer[0] & 0x10) != toggle) return {};
      const auto end = answer.begin() + 8 - (answer[0] >> 1 & 7);
      all.insert(all.end(), answer.begin() + 1, end);
      if ((answer[0] & 1) != 0) break;
    }
    EXPECT_EQ(all.size(), size);
    return all;
  }
  Abort write_all(std::uint16_t index, std::uint8_t subindex, const Bytes& bytes,
                  bool tells_size = true) {
    const auto size = static_cast<std::uint32_t>(bytes.size());
    Bytes answer = sdo(object(tells_size ? 0x21 : 0x20, index, subindex, tells_size ? size : 0));
    std::uint8_t toggle = 0;
    for (std::size_t at = 0; answer.size() == 8 && answer[0] != 0x80; at += 7, toggle ^= 0x10) {
      if (at >= bytes.size() && at > 0) break;
      const std::size_t count = std::min<std::size_t>(7, bytes.size() - at);
      const bool is_last = at + count == bytes.size();
      Bytes segment(8);
      segment[0] = static_cast<std::uint8_t>(toggle | (7 - count) << 1 | (is_last ? 1 : 0));
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), count, segment.begin() + 1);
      answer = sdo(segment);
      if (answer.size() == 8 && answer[0] != 0x80) {
        EXPECT_EQ(answer[0], 0x20 | toggle);
      }
    }
    return abort_in(answer);
  }

  /// The last frame with this id; size 0 and id 0: none.
  [[nodiscard]] Frame last(std::uint32_t id) const {
    for (auto it = sent.rbegin(); it != sent.rend(); ++it) {
      if (it->id == id) return *it;
    }
    return {};
  }
  [[nodiscard]] Frame tpdo(int i) const { return last(tpdo_id(i, kNode)); }
  /// A field as the last frames told it.
  [[nodiscard]] std::int32_t told(ReportField field) const {
    for (int i = 0; i < kTpdoCount; ++i) {
      std::size_t at = 0;
      for (const ReportField other : fields_of_tpdo(i)) {
        const ReportLine& line = line_of(other);
        if (other == field && (i == 0) == (field <= ReportField::kDoneNumber)) {
          const std::uint32_t raw = number_at(tpdo(i).data, at, line.bytes);
          const int shift = 32 - 8 * line.bytes;
          return line.is_signed ? static_cast<std::int32_t>(raw << shift) >> shift
                                : static_cast<std::int32_t>(raw);
        }
        at += line.bytes;
      }
    }
    return 0;
  }
  /// The last whole result.
  [[nodiscard]] Frame whole() const { return last(kFdReportBase + kNode); }
  [[nodiscard]] bool sequences_agree() const {
    for (int i = 1; i < kTpdoCount; ++i) {
      if (tpdo(i).data[0] != tpdo(0).data[0]) return false;
    }
    return true;
  }
  [[nodiscard]] std::uint16_t last_emergency() const {
    return static_cast<std::uint16_t>(number_at(last(kEmergencyBase + kNode).data, 0, 2));
  }

  job::Desk desk;
  Device device;
  std::vector<Frame> sent;
};

}  // namespace flatpose::can
