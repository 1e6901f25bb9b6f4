// The SDO server: every object read and written as it may be, every abort that applies.

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "flatpose/result_map/registers.hpp"
#include "flatpose/result_map/table.hpp"
#include "tests/fieldbus/can/node.hpp"

namespace flatpose::can {
namespace {

using job::kSecond_us;

std::string text(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

template <class Visit>
void over_objects(const Visit& visit) {
  for (int i = 0; i < group_count(); ++i) {
    const std::uint16_t index = group_at(i).index;
    for (int sub = 0; sub < 256; ++sub) {
      Object object;
      const auto subindex = static_cast<std::uint8_t>(sub);
      if (find_object(index, subindex, object) == Abort::kNone) visit(object);
    }
  }
}

TEST(CanDictionary, HasEveryRegisterUnderItsIndexOnce) {
  std::set<std::pair<int, int>> places;
  int registers = 0;
  over_objects([&](const Object& object) {
    EXPECT_TRUE(places.insert({object.index, object.subindex}).second);
    EXPECT_GT(std::string(object.name).size(), 2U);
    if (object.entry == nullptr) return;
    ++registers;
    EXPECT_EQ(object.entry->can_index, object.index);
    EXPECT_EQ(object.entry->can_subindex, object.subindex);
  });
  EXPECT_EQ(registers, static_cast<int>(result_map::entries().size()));
}

TEST(CanDictionary, MapsFullFramesOfObjectsThatMayBeMapped) {
  const auto check = [](const Mapped& mapped, Mapping mapping) {
    Object object;
    EXPECT_EQ(find_object(mapped.index, mapped.subindex, object), Abort::kNone);
    EXPECT_EQ(object.mapping, mapping) << object.name;
    EXPECT_EQ(bytes_of(object.type) * 8, mapped.bits) << object.name;
    return int{mapped.bits};
  };
  int bits = 0;
  for (const Mapped& mapped : rpdo_mapping()) bits += check(mapped, Mapping::kRpdo);
  EXPECT_EQ(bits, 64);
  for (int tpdo = 0; tpdo < kTpdoCount; ++tpdo) {
    bits = 0;
    for (std::size_t i = 0; i < fields_of_tpdo(tpdo).size(); ++i)
      bits += check(tpdo_mapped(tpdo, static_cast<int>(i)), Mapping::kTpdo);
    EXPECT_EQ(bits, 64);
  }
}

TEST(CanSdo, ReadsEveryObjectInTheSizeOfItsType) {
  Node node({.name = "flatpose", .hardware = "x86-64", .software = "1.2.3"});
  over_objects([&](const Object& object) {
    const Bytes bytes = node.read_all(object.index, object.subindex);
    const std::size_t size = bytes_of(object.type);
    EXPECT_EQ(size == 0 ? !bytes.empty() : bytes.size() == size, true)
        << std::hex << object.index << "." << int{object.subindex};
    if (object.subindex == 0 && size == 1 && object.index != 0x1001 && object.index != 0x1003) {
      Object last;
      EXPECT_EQ(find_object(object.index, bytes[0], last), Abort::kNone);
      EXPECT_EQ(find_object(object.index, static_cast<std::uint8_t>(bytes[0] + 1), last),
                Abort::kNoSubindex);
    }
  });
}

TEST(CanSdo, ReadsWhoIsThere) {
  Node node({.serial = 77, .hardware = "x86-64", .software = "0.1.0 of a long name"});
  EXPECT_EQ(node.read(0x1000, 0), 0U);
  EXPECT_EQ(node.read(0x1018, 2), 0x74616c66U);
  EXPECT_EQ(node.read(0x1018, 3), result_map::kMapVersion << 16);
  EXPECT_EQ(node.read(0x1018, 4), 77U);
  EXPECT_EQ(text(node.read_all(0x1008, 0)), "flatpose");
  EXPECT_EQ(text(node.read_all(0x1009, 0)), "x86-64");
  EXPECT_EQ(text(node.read_all(0x100a, 0)), "0.1.0 of a long name");
  EXPECT_EQ(node.read(0x1200, 1), 0x60aU);
  EXPECT_EQ(node.read(0x1200, 2), 0x58aU);
  EXPECT_EQ(node.read(0x1400, 1), 0x20aU);
  EXPECT_EQ(node.read(0x1803, 1), 0x4000048aU);
  EXPECT_EQ(node.read(0x1a00, 1), 0x20030108U);
  EXPECT_EQ(node.read(0x1a01, 2), 0x20030718U);
  EXPECT_EQ(node.read(0x1600, 5), 0x20020310U);
}

TEST(CanSdo, ReadsRegistersAsTheMapHasThem) {
  Node node;
  node.desk.live();
  node.desk.write(node.desk.image(4, job::Command::kLocate, kMaster), kMaster);
  node.desk.finish(node.desk.found(3));
  node.process({});
  const job::Snapshot snapshot = node.desk.see(kMaster);
  for (const result_map::Entry& entry : result_map::entries()) {
    if (entry.field == result_map::Field::kReaderIsOwner) continue;
    EXPECT_EQ(node.read(entry.can_index, entry.can_subindex),
              result_map::raw_of(entry, snapshot, {}))
        << entry.name;
  }
  EXPECT_EQ(node.read(0x2001, 2), 0x12345678U);
  EXPECT_EQ(node.read(0x2003, 6), 4U);
  EXPECT_EQ(node.read(0x2003, 7), 10'000U);
}

TEST(CanSdo, TheWholeResultIsThatOfOneMoment) {
  Node node;
  node.desk.live();
  node.desk.write(node.desk.image(4, job::Command::kLocate, kMaster), kMaster);
  node.desk.finish(node.desk.found(3));
  Bytes bytes = node.sdo(Node::object(0x40, 0x2011, 0));
  const std::uint32_t size = number_at(bytes, 4, 4);
  EXPECT_GT(size, 150U);
  bytes.clear();
  for (std::uint8_t toggle = 0; bytes.size() < size; toggle ^= 0x10) {
    const Bytes answer = node.sdo({static_cast<std::uint8_t>(0x60 | toggle), 0, 0, 0, 0, 0, 0, 0});
    ASSERT_EQ(answer.size(), 8U);
    bytes.insert(bytes.end(), answer.begin() + 1, answer.end() - (answer[0] >> 1 & 7));
    if (toggle == 0) node.desk.write(5, job::Command::kClearError, kMaster);  // in between
  }
  std::size_t at = 0;
  for (int sub = 1; at < bytes.size(); ++sub) {
    Object object;
    ASSERT_EQ(find_object(0x2010, static_cast<std::uint8_t>(sub), object), Abort::kNone);
    if (sub == 2) {
      EXPECT_EQ(number_at(bytes, at, 2), 4U);
    }
    if (std::string(object.name) == "position_x") {
      EXPECT_EQ(number_at(bytes, at, 4), 10'000U);
    }
    at += bytes_of(object.type);
    if (std::string(object.name) == "done_number_tail") {
      EXPECT_EQ(number_at(bytes, at - 2, 2), 4U);
    }
  }
  EXPECT_EQ(at, bytes.size());
  EXPECT_EQ(node.read(0x2010, 2), 5U);
}

TEST(CanSdo, TriggersByOneRegisterAfterTheOthers) {
  Node node;
  node.desk.live();
  EXPECT_EQ(node.write(0x2000, 4, 7, 2), Abort::kNone);
  EXPECT_EQ(node.write(0x2000, 2, 321, 2), Abort::kNone);
  EXPECT_EQ(node.write(0x2000, 1, 12, 2), Abort::kNone);
  EXPECT_EQ(node.desk.order.number, 12);
  EXPECT_EQ(node.desk.order.job, 7);
  EXPECT_EQ(node.write(0x2000, 7, 1, 2), Abort::kDeviceState) << "not by this handshake";
}

TEST(CanSdo, TriggersByTheWholeCommandInSegments) {
  for (const bool tells_size : {false, true}) {
    Node node;
    node.desk.live();
    Bytes bytes(14);
    put_number(bytes, 0, 2, 500);
    put_number(bytes, 4, 2, 1);
    put_number(bytes, 6, 2, 7);
    EXPECT_EQ(node.write_all(0x2004, 0, bytes, tells_size), Abort::kNone);
    EXPECT_EQ(node.desk.order.number, 500);
    EXPECT_EQ(node.desk.order.job, 7);
    EXPECT_EQ(node.read_all(0x2004, 0), bytes);
    bytes.push_back(0);
    EXPECT_EQ(node.write_all(0x2004, 0, bytes, tells_size), Abort::kTooLong);
    EXPECT_EQ(node.write_all(0x2004, 0, Bytes(13), tells_size), Abort::kTooShort);
    EXPECT_EQ(node.write(0x2004, 0, 1, 4), Abort::kTooShort);
    EXPECT_EQ(node.abort_in(node.sdo(Node::object(0x22, 0x2004, 0, 1))), Abort::kLength);
  }
}

TEST(CanSdo, AbortsADownloadThatEndsBeforeOrAfterTheSizeItTold) {
  Node node;
  (void)node.sdo(Node::object(0x21, 0x2004, 0, 14));
  EXPECT_EQ(node.abort_in(node.sdo({0x01, 1, 0, 0, 0, 1, 0, 1})), Abort::kTooShort);
  (void)node.sdo(Node::object(0x21, 0x1017, 0, 2));
  EXPECT_EQ(node.abort_in(node.sdo({0x01, 1, 0, 0, 0, 1, 0, 1})), Abort::kTooLong);
  (void)node.sdo(Node::object(0x20, 0x2004, 0));
  Bytes answer;
  for (std::uint8_t toggle = 0; answer.empty() || answer[0] >> 5 == 1; toggle ^= 0x10)
    answer = node.sdo({toggle, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(node.abort_in(answer), Abort::kTooLong) << "without end";
  EXPECT_EQ(node.read(0x1017, 0), 1000U);
}

TEST(CanSdo, WritesSmallObjectsInSegmentsAndWithoutASizeToo) {
  Node node;
  EXPECT_EQ(node.write_all(0x1017, 0, {0x2c, 1}), Abort::kNone);
  EXPECT_EQ(node.read(0x1017, 0), 300U);
  EXPECT_EQ(node.write_all(0x1017, 0, {0x90, 1}, false), Abort::kNone);
  EXPECT_EQ(node.read(0x1017, 0), 400U);
  EXPECT_EQ(node.abort_in(node.sdo(Node::object(0x22, 0x1017, 0, 500))), Abort::kNone);
  EXPECT_EQ(node.read(0x1017, 0), 500U);
  EXPECT_EQ(node.write_all(0x1017, 0, {}), Abort::kTooShort);
}

TEST(CanSdo, AbortsWhatThereIsNot) {
  Node node;
  for (const int index : {0x0000, 0x0fff, 0x1002, 0x1010, 0x1011, 0x1401, 0x1804, 0x2005, 0xffff}) {
    const auto wanted = static_cast<std::uint16_t>(index);
    EXPECT_EQ(node.abort_in(node.sdo(Node::object(0x40, wanted, 0))), Abort::kNoObject) << index;
    EXPECT_EQ(node.write(wanted, 0, 0, 1), Abort::kNoObject);
    EXPECT_EQ(node.write_all(wanted, 0, Bytes(9)), Abort::kNoObject);
  }
  EXPECT_EQ(node.abort_in(node.sdo(Node::object(0x40, 0x1800, 4))), Abort::kNoSubindex);
  EXPECT_EQ(node.abort_in(node.sdo(Node::object(0x40, 0x1000, 1))), Abort::kNoSubindex);
  EXPECT_EQ(node.abort_in(node.sdo(Node::object(0x40, 0x1003, 9))), Abort::kNoSubindex);
  EXPECT_EQ(node.abort_in(node.sdo(Node::object(0x40, 0x2010, 250))), Abort::kNoSubindex);
}

TEST(CanSdo, TellsAtFirstWhatTheDictionarySaysObjectsStartWith) {
  using result_map::Field;
  Node node;
  over_objects([&](const Object& object) {
    if (bytes_of(object.type) == 0) return;
    const bool is_of_this_start =
        object.entry != nullptr &&
        (object.entry->field == Field::kSessionId || object.entry->field == Field::kBootCount);
    if (is_of_this_start) return;
    EXPECT_EQ(node.read(object.index, object.subindex),
              object.initial + (object.adds_node ? kNode : 0U))
        << object.name;
  });
}

TEST(CanSdo, SwitchesAPdoOffWhateverItSaysOfRemoteRequests) {
  constexpr std::uint32_t kEither[] = {0, kNoRemote};
  for (const std::uint32_t off : kEither) {
    for (const std::uint32_t on : kEither) {
      Node node;
      EXPECT_EQ(node.write(0x1801, 1, kNotValid | off | 0x28a, 4), Abort::kNone);
      EXPECT_EQ(node.read(0x1801, 1), 0xc000028aU);
      EXPECT_EQ(node.write(0x1400, 1, kNotValid | off | 0x20a, 4), Abort::kNone);
      EXPECT_EQ(node.read(0x1400, 1), 0x8000020aU);
      node.start();
      EXPECT_EQ(node.tpdo(0).size, 8);
      EXPECT_EQ(node.tpdo(1).size, 0);
      EXPECT_EQ(node.write(0x1801, 1, on | 0x28a, 4), Abort::kNone);
      EXPECT_EQ(node.read(0x1801, 1), 0x4000028aU);
      EXPECT_EQ(node.write(0x1400, 1, on | 0x20a, 4), Abort::kNone);
      EXPECT_EQ(node.read(0x1400, 1), 0x20aU);
      EXPECT_EQ(node.tpdo(1).size, 8);
    }
  }
}

TEST(CanSdo, AbortsWritesOfWhatIsReadOnlyAndOfAnotherSize) {
  Node node;
  const Parameters start = Parameters::at_start({});
  over_objects([&](const Object& object) {
    const std::size_t size = bytes_of(object.type);
    const int right = size == 0 || size == 3 ? 4 : static_cast<int>(size);
    if (object.access != Access::kReadWrite) {
      EXPECT_EQ(node.write(object.index, object.subindex, 1, right), Abort::kReadOnly);
      EXPECT_EQ(node.write_all(object.index, object.subindex, Bytes(5)), Abort::kReadOnly);
    } else if (size > 0) {
      for (int wrong = 1; wrong <= 4; ++wrong) {
        if (wrong == right) continue;
        EXPECT_EQ(node.write(object.index, object.subindex, 0, wrong),
                  wrong > right ? Abort::kTooLong : Abort::kTooShort);
      }
      EXPECT_EQ(node.write_all(object.index, object.subindex, Bytes(5)), Abort::kTooLong);
    }
  });
  EXPECT_EQ(node.read(0x1017, 0), start.heartbeat_ms);
}

TEST(CanSdo, AbortsValuesThatThereAreNot) {
  Node node;
  EXPECT_EQ(node.write(0x1005, 0, 0x81, 4), Abort::kValue);
  EXPECT_EQ(node.write(0x1005, 0, 0x80, 4), Abort::kNone);
  EXPECT_EQ(node.write(0x1014, 0, 0x81, 4), Abort::kValue);
  EXPECT_EQ(node.write(0x1014, 0, 0x8000008a, 4), Abort::kNone);
  EXPECT_EQ(node.read(0x1014, 0), 0x8000008aU);
  EXPECT_EQ(node.write(0x1016, 1, 200 << 16 | 100, 4), Abort::kValue);
  EXPECT_EQ(node.write(0x1016, 1, kNode << 16 | 100, 4), Abort::kValue);
  EXPECT_EQ(node.write(0x1016, 1, 0x01000000, 4), Abort::kValue);
  EXPECT_EQ(node.write(0x1016, 1, 5 << 16 | 100, 4), Abort::kNone);
  EXPECT_EQ(node.read(0x1016, 1), 5U << 16 | 100);
  EXPECT_EQ(node.write(0x1400, 1, 0x300, 4), Abort::kValue);
  EXPECT_EQ(node.write(0x1400, 1, 0x8000020a, 4), Abort::kNone);
  EXPECT_EQ(node.write(0x1400, 2, 252, 1), Abort::kValue);
  EXPECT_EQ(node.write(0x1801, 1, 0x4000018a, 4), Abort::kValue);
  EXPECT_EQ(node.write(0x1801, 1, 0x6000028a, 4), Abort::kValue) << "an extended identifier";
  node.start();
  node.desk.live();
  node.rpdo(1);
  EXPECT_EQ(node.desk.order.number, 0) << "the RPDO was taken away";
}

TEST(CanSdo, AbortsWhatItHasNoCommandFor) {
  Node node;
  for (int head = 0xa0; head <= 0xff; head += 0x20)
    EXPECT_EQ(node.abort_in(node.sdo(Node::object(static_cast<std::uint8_t>(head), 0x1008, 0))),
              Abort::kCommand);
  for (const int head : {0x00, 0x60})  // segments of nothing
    EXPECT_EQ(node.abort_in(node.sdo(Node::object(static_cast<std::uint8_t>(head), 0x1008, 0))),
              Abort::kCommand);
  (void)node.sdo(Node::object(0x40, 0x1008, 0));
  EXPECT_EQ(node.abort_in(node.sdo({0x00, 0, 0, 0, 0, 0, 0, 0})), Abort::kCommand)
      << "a download's segment in an upload";
}

TEST(CanSdo, AbortsAWrongToggleAndASegmentThatDoesNotCome) {
  Node node;
  (void)node.sdo(Node::object(0x40, 0x2011, 0));
  EXPECT_EQ(node.abort_in(node.sdo({0x70, 0, 0, 0, 0, 0, 0, 0})), Abort::kToggle);
  (void)node.sdo(Node::object(0x40, 0x2011, 0));
  EXPECT_EQ(node.sdo({0x60, 0, 0, 0, 0, 0, 0, 0})[0] & 0xf0, 0x00);
  EXPECT_EQ(node.abort_in(node.sdo({0x60, 0, 0, 0, 0, 0, 0, 0})), Abort::kToggle) << "sent twice";
  (void)node.sdo(Node::object(0x21, 0x2004, 0, 14));
  EXPECT_EQ(node.abort_in(node.sdo({0x10, 0, 0, 0, 0, 0, 0, 0})), Abort::kToggle);

  (void)node.sdo(Node::object(0x21, 0x2004, 0, 14));
  EXPECT_EQ(node.device.next_us(), node.desk.now_us + kSecond_us);
  const auto frames = node.pass(kSecond_us);
  const Frame abort = node.last(0x58a);
  EXPECT_EQ(number_at(abort.data, 4, 4), static_cast<std::uint32_t>(Abort::kTimeout));
  EXPECT_EQ(number_at(abort.data, 1, 2), 0x2004U);
  EXPECT_FALSE(frames.empty());
}

TEST(CanSdo, TheClientsAbortAndANewRequestEndATransferQuietly) {
  Node node;
  (void)node.sdo(Node::object(0x40, 0x1008, 0));
  EXPECT_TRUE(node.sdo(Node::object(0x80, 0x1008, 0, 0x08000000)).empty());
  EXPECT_EQ(node.abort_in(node.sdo({0x60, 0, 0, 0, 0, 0, 0, 0})), Abort::kCommand);
  (void)node.sdo(Node::object(0x40, 0x1008, 0));
  EXPECT_EQ(node.read(0x1000, 0), 0U);
  EXPECT_EQ(node.write_all(0x2004, 0, Bytes(14)), Abort::kNone);
}

TEST(CanSdo, ShortRequestsAreNone) {
  Node node;
  for (std::size_t size = 0; size < 8; ++size) EXPECT_TRUE(node.sdo(Bytes(size, 0x40)).empty());
}

}  // namespace
}  // namespace flatpose::can
