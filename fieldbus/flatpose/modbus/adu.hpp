#pragma once
// Modbus TCP frames out of a stream of bytes, and into one. No I/O: the port reads into room() and
// says how much came.
//
//   transaction (2)  protocol = 0 (2)  length (2)  unit (1)  PDU (length - 1)
//
// A stream in which protocol or length is wrong cannot be followed any more: it is closed, as soon
// as those bytes are there.
//
// Source: MODBUS Messaging on TCP/IP Implementation Guide V1.0b.

#include <array>
#include <cstdint>
#include <span>

namespace flatpose::modbus {

inline constexpr int kHeaderBytes = 7;
inline constexpr int kPduBytesMax = 253;
inline constexpr int kAduBytesMax = kHeaderBytes + kPduBytesMax;

struct Adu {
  std::uint16_t transaction = 0;
  std::uint8_t unit = 0;
  std::span<const std::uint8_t> pdu;  ///< At least the function code.
};

/// One for each connection.
class AduReader {
 public:
  enum class Step : std::uint8_t { kNeedsMore, kAdu, kClose };

  /// Where the next bytes go. Not empty after next() said kNeedsMore.
  [[nodiscard]] std::span<std::uint8_t> room() noexcept {
    return std::span(buffer_).subspan(filled_bytes_);
  }
  void filled(std::size_t bytes) noexcept { filled_bytes_ += bytes; }

  /// The next whole frame, if there is one. It stays where it is until next() is called again.
  /// After kClose it is kClose for ever.
  [[nodiscard]] Step next(Adu& adu) noexcept;

  /// Whether a frame has begun and is not whole: the port's frame deadline runs. After
  /// kNeedsMore.
  [[nodiscard]] bool is_inside_frame() const noexcept { return filled_bytes_ > 0; }

 private:
  void drop_taken() noexcept;

  std::array<std::uint8_t, kAduBytesMax> buffer_{};
  std::size_t filled_bytes_ = 0;
  std::size_t taken_bytes_ = 0;  ///< Of the frame that the last next() gave.
  bool is_lost_ = false;
};

/// Writes a frame.  Returns its size; 0 when the PDU is empty, too long or `out` too small.
[[nodiscard]] std::size_t compose(std::uint16_t transaction, std::uint8_t unit,
                                  std::span<const std::uint8_t> pdu,
                                  std::span<std::uint8_t> out) noexcept;

}  // namespace flatpose::modbus
