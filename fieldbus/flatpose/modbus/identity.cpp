#include "flatpose/modbus/identity.hpp"

#include <array>
#include <cstddef>
#include <cstring>

namespace flatpose::modbus {
namespace {

constexpr std::size_t kTextBytesMax = 30;
constexpr int kObjectCount = 7;
constexpr int kBasicCount = 3;
constexpr std::uint8_t kDeviceIdentification = 14;
constexpr std::uint8_t kRegularAndSingle = 0x82;
constexpr std::uint8_t kRunning = 0xff;

enum class Access : std::uint8_t { kBasic = 1, kRegular = 2, kExtended = 3, kSingle = 4 };

std::array<const char*, kObjectCount> objects_of(const Identity& id) noexcept {
  return {id.vendor,       id.product_code, id.revision,   id.vendor_url,
          id.product_name, id.model,        id.application};
}

std::size_t text_bytes(const char* text) noexcept {
  const std::size_t bytes = std::strlen(text);
  return bytes < kTextBytesMax ? bytes : kTextBytesMax;
}

// Bytes one after the other, into a PDU that is large enough for all that is written here.
class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> pdu) noexcept : pdu_(pdu) {}
  void byte(std::size_t value) noexcept {
    if (size_ < pdu_.size()) pdu_[size_++] = static_cast<std::uint8_t>(value);
  }
  void text(const char* text) noexcept {
    for (std::size_t i = 0; i < text_bytes(text); ++i) byte(static_cast<std::uint8_t>(text[i]));
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::span<std::uint8_t> pdu_;
  std::size_t size_ = 0;
};

static_assert(7 + kObjectCount * (2 + kTextBytesMax) <= 253, "all objects fit one response");

}  // namespace

std::size_t report_server_id(const Identity& identity, std::span<std::uint8_t> pdu) noexcept {
  Writer out(pdu);
  out.byte(static_cast<std::uint8_t>(Function::kReportServerId));
  out.byte(3 + text_bytes(identity.product_code) + text_bytes(identity.revision));
  out.byte(kServerId);
  out.byte(kRunning);
  out.text(identity.product_code);
  out.byte(' ');
  out.text(identity.revision);
  return out.size();
}

Exception read_identification(const Identity& identity, std::span<const std::uint8_t> request,
                              std::span<std::uint8_t> pdu, std::size_t& pdu_bytes) noexcept {
  if (request.size() < 2) return Exception::kIllegalValue;
  if (request[1] != kDeviceIdentification) return Exception::kIllegalFunction;
  if (request.size() != 4) return Exception::kIllegalValue;
  const auto access = static_cast<Access>(request[2]);
  if (access < Access::kBasic || access > Access::kSingle) return Exception::kIllegalValue;
  const bool is_single = access == Access::kSingle;
  if (is_single && request[3] >= kObjectCount) return Exception::kIllegalAddress;
  const int end =
      is_single ? request[3] + 1 : (access == Access::kBasic ? kBasicCount : kObjectCount);
  const int start =
      request[3] < end ? request[3] : 0;  // an object that is not there: from the first

  const auto objects = objects_of(identity);
  Writer out(pdu);
  for (const std::uint8_t byte : request.first(3)) out.byte(byte);
  out.byte(kRegularAndSingle);
  out.byte(0);  // nothing follows
  out.byte(0);
  out.byte(static_cast<std::size_t>(end - start));
  for (int i = start; i < end; ++i) {
    out.byte(static_cast<std::size_t>(i));
    out.byte(text_bytes(objects[i]));
    out.text(objects[i]);
  }
  pdu_bytes = out.size();
  return Exception::kNone;
}

}  // namespace flatpose::modbus
