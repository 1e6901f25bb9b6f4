#include "flatpose/modbus/adu.hpp"

#include <algorithm>
#include <cstddef>

#include "flatpose/modbus/words.hpp"

namespace flatpose::modbus {

void AduReader::drop_taken() noexcept {
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(taken_bytes_),
            buffer_.begin() + static_cast<std::ptrdiff_t>(filled_bytes_), buffer_.begin());
  filled_bytes_ -= taken_bytes_;
  taken_bytes_ = 0;
}

AduReader::Step AduReader::next(Adu& adu) noexcept {
  drop_taken();
  if (filled_bytes_ >= 4 && word_at(buffer_, 2) != 0) is_lost_ = true;
  if (filled_bytes_ >= 6) {
    const int length = word_at(buffer_, 4);
    if (length < 2 || length > kPduBytesMax + 1) is_lost_ = true;
  }
  if (is_lost_) return Step::kClose;
  if (filled_bytes_ < 6) return Step::kNeedsMore;
  const std::size_t whole_bytes = 6U + word_at(buffer_, 4);
  if (filled_bytes_ < whole_bytes) return Step::kNeedsMore;
  taken_bytes_ = whole_bytes;
  adu = {word_at(buffer_, 0), buffer_[6],
         std::span<const std::uint8_t>(buffer_).subspan(kHeaderBytes, whole_bytes - kHeaderBytes)};
  return Step::kAdu;
}

std::size_t compose(std::uint16_t transaction, std::uint8_t unit, std::span<const std::uint8_t> pdu,
                    std::span<std::uint8_t> out) noexcept {
  const std::size_t whole_bytes = kHeaderBytes + pdu.size();
  if (pdu.empty() || pdu.size() > kPduBytesMax || out.size() < whole_bytes) return 0;
  put_word(out, 0, transaction);
  put_word(out, 2, 0);
  put_word(out, 4, static_cast<std::uint16_t>(pdu.size() + 1));
  out[6] = unit;
  std::copy(pdu.begin(), pdu.end(), out.begin() + kHeaderBytes);
  return whole_bytes;
}

}  // namespace flatpose::modbus
