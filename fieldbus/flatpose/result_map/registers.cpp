#include "flatpose/result_map/registers.hpp"

#include <algorithm>
#include <cmath>

#include "flatpose/result_map/table.hpp"
#include "flatpose/result_map/value.hpp"

namespace flatpose::result_map {
namespace {

constexpr std::uint32_t kNoneInt16 = 0x8000;
constexpr std::uint32_t kNoneUint16 = 0xffff;
constexpr std::uint32_t kNoneUint32 = 0xffffffff;

std::uint32_t none_of(Type type, const WireFormat& format) noexcept {
  switch (type) {
    case Type::kUint16: return kNoneUint16;
    case Type::kInt16: return kNoneInt16;
    case Type::kUint32: return kNoneUint32;
    case Type::kInt32: return format.none_int32;
    case Type::kFloat32: return format.none_float32;
  }
  return 0;
}

// The nearest whole number that the type has; one less where the last one says "none".
std::uint32_t held(double raw, Type type, bool may_be_none) noexcept {
  const double spared = may_be_none ? 1.0 : 0.0;
  const double whole = std::floor(raw + 0.5);
  const auto within = [whole](double low, double high) {
    return static_cast<std::int64_t>(std::clamp(whole, low, high));
  };
  std::int64_t number = 0;
  switch (type) {
    case Type::kUint16: number = within(0.0, 65535.0 - spared); break;
    case Type::kInt16: number = within(-32768.0 + spared, 32767.0); break;
    case Type::kUint32: number = within(0.0, 4294967295.0 - spared); break;
    case Type::kInt32: number = within(-2147483648.0 + spared, 2147483647.0); break;
    case Type::kFloat32: break;
  }
  return static_cast<std::uint32_t>(number);
}

std::uint32_t float_bits(double value) noexcept {
  constexpr double kMost = std::numeric_limits<float>::max();
  return std::bit_cast<std::uint32_t>(static_cast<float>(std::clamp(value, -kMost, kMost)));
}

constexpr std::uint16_t swapped(std::uint16_t word) noexcept {
  return static_cast<std::uint16_t>(word << 8 | word >> 8);
}

std::array<std::uint16_t, 2> ordered(std::uint32_t bits, WordOrder order) noexcept {
  auto high = static_cast<std::uint16_t>(bits >> 16);
  auto low = static_cast<std::uint16_t>(bits);
  if (order == WordOrder::kBadc || order == WordOrder::kDcba) {
    high = swapped(high);
    low = swapped(low);
  }
  if (order == WordOrder::kCdab || order == WordOrder::kDcba) return {low, high};
  return {high, low};
}

std::uint16_t* register_of(job::CommandImage& image, Field field) noexcept {
  switch (field) {
    case Field::kCommandNumber: return &image.command_number;
    case Field::kCommandSession: return &image.command_session;
    case Field::kCommand: return &image.command;
    case Field::kJob: return &image.job;
    case Field::kPickNumber: return &image.pick_number;
    case Field::kPickOutcome: return &image.pick_outcome;
    case Field::kControl: return &image.control;
    default: return nullptr;
  }
}

}  // namespace

std::uint32_t raw_of(const Entry& entry, const job::Snapshot& snapshot,
                     const WireFormat& format) noexcept {
  const Value value = value_of(entry, snapshot);
  if (value.is_none) return none_of(entry.type, format);
  if (entry.type == Type::kFloat32) return float_bits(value.number);
  const double scale = is_rotation(entry.field) ? rotation_scale(snapshot.convention) : entry.scale;
  const std::uint32_t raw = held(value.number / scale, entry.type, entry.may_be_none);
  // A "none" by config may lie among the values: then the value gives way by one.
  const bool is_taken = entry.type == Type::kInt32 && raw == format.none_int32;
  return is_taken ? raw + 1 : raw;
}

std::array<std::uint16_t, 2> encode(const Entry& entry, const job::Snapshot& snapshot,
                                    const WireFormat& format) noexcept {
  const std::uint32_t raw = raw_of(entry, snapshot, format);
  if (entry.words() == 1) return {static_cast<std::uint16_t>(raw), 0};
  return ordered(raw, format.order);
}

void read_registers(const job::Snapshot& snapshot, const WireFormat& format, int address,
                    std::span<std::uint16_t> registers) noexcept {
  const Entry* last = nullptr;
  std::array<std::uint16_t, 2> words{};
  for (int i = 0; i < static_cast<int>(registers.size()); ++i) {
    const Entry* entry = entry_at(address + i);
    if (entry != nullptr && entry != last) words = encode(*entry, snapshot, format);
    last = entry;
    registers[i] = entry == nullptr ? std::uint16_t{0} : words[address + i - entry->address];
  }
}

void write_registers(job::CommandImage& image, int address,
                     std::span<const std::uint16_t> registers) noexcept {
  for (int i = 0; i < static_cast<int>(registers.size()); ++i) {
    const Entry* entry = entry_at(address + i);
    std::uint16_t* target = entry == nullptr ? nullptr : register_of(image, entry->field);
    if (target != nullptr) *target = registers[i];
  }
}

bool touches(Field field, int address, int count) noexcept {
  const Entry* entry = find(field);
  return entry != nullptr && entry->address >= address && entry->address < address + count;
}

}  // namespace flatpose::result_map
