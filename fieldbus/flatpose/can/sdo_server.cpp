#include "flatpose/can/sdo_server.hpp"

#include <algorithm>

namespace flatpose::can {
namespace {

// Command specifiers, in the upper three bits.
constexpr std::uint8_t kDownloadSegment = 0;
constexpr std::uint8_t kInitiateDownload = 1;
constexpr std::uint8_t kInitiateUpload = 2;
constexpr std::uint8_t kUploadSegment = 3;
constexpr std::uint8_t kAbortTransfer = 4;

constexpr std::uint8_t kExpedited = 1 << 1;
constexpr std::uint8_t kSizeTold = 1 << 0;
constexpr std::uint8_t kToggleBit = 1 << 4;
constexpr std::uint8_t kLastSegment = 1 << 0;
constexpr std::size_t kSegmentBytes = 7;
constexpr std::size_t kExpeditedBytes = 4;

constexpr std::uint8_t with_toggle(unsigned command, bool toggle) noexcept {
  return static_cast<std::uint8_t>(toggle ? command | kToggleBit : command);
}

}  // namespace

SdoServer::Step SdoServer::take(const Frame& request, std::int64_t now_us) noexcept {
  const std::uint8_t command = request.data[0] >> 5;
  if (command == kAbortTransfer) {
    end();
    return {};
  }
  if (command == kInitiateDownload || command == kInitiateUpload) {
    end();
    index_ = static_cast<std::uint16_t>(number_at(request.data, 1, 2));
    subindex_ = request.data[3];
    if (command == kInitiateUpload) return {Step::Kind::kRead, index_, subindex_, 0, true, {}};
    return begin_download(request, now_us);
  }
  if (command == kDownloadSegment && state_ == State::kDownload)
    return go_on_with_download(request, now_us);
  if (command == kUploadSegment && state_ == State::kUpload) {
    go_on_with_upload(request, now_us);
    return {};
  }
  if (state_ == State::kIdle) {  // for nothing that is under way: the object that it names, if any
    index_ = static_cast<std::uint16_t>(number_at(request.data, 1, 2));
    subindex_ = request.data[3];
  }
  refuse(Abort::kCommand);
  return {};
}

SdoServer::Step SdoServer::begin_download(const Frame& request, std::int64_t now_us) noexcept {
  const std::uint8_t head = request.data[0];
  const bool size_is_told = (head & kSizeTold) != 0;
  is_segment_ = (head & kExpedited) == 0;
  if (!is_segment_) {
    size_ = size_is_told ? kExpeditedBytes - (head >> 2 & 3) : kExpeditedBytes;
    std::copy_n(request.data.begin() + 4, kExpeditedBytes, buffer_.begin());
    return {Step::Kind::kWrite, index_,
            subindex_,          size_,
            size_is_told,       std::span(buffer_).first(size_)};
  }
  const std::size_t told = number_at(request.data, 4, 4);
  size_ = size_is_told ? std::min(told, kWriteBytesMax + 1) : 0;
  begin(State::kDownload, now_us);
  answer_with_object(0x60);
  return {Step::Kind::kProbe, index_, subindex_, size_, size_is_told, {}};
}

SdoServer::Step SdoServer::go_on_with_download(const Frame& request, std::int64_t now_us) noexcept {
  const std::uint8_t head = request.data[0];
  if (((head & kToggleBit) != 0) != toggle_) {
    refuse(Abort::kToggle);
    return {};
  }
  const std::size_t count = kSegmentBytes - (head >> 1 & 7);
  if (place_ + count > kWriteBytesMax) {
    refuse(Abort::kTooLong);
    return {};
  }
  std::copy_n(request.data.begin() + 1, count,
              buffer_.begin() + static_cast<std::ptrdiff_t>(place_));
  place_ += count;
  limit_us_ = now_us + kSegmentLimit_us;
  if ((head & kLastSegment) == 0) {
    answer(with_toggle(0x20, toggle_));
    toggle_ = !toggle_;
    return {};
  }
  return {Step::Kind::kWrite, index_, subindex_, place_, true, std::span(buffer_).first(place_)};
}

void SdoServer::go_on_with_upload(const Frame& request, std::int64_t now_us) noexcept {
  if (((request.data[0] & kToggleBit) != 0) != toggle_) return refuse(Abort::kToggle);
  const std::size_t count = std::min(kSegmentBytes, size_ - place_);
  const bool is_last = place_ + count == size_;
  answer(with_toggle(
      static_cast<unsigned>(kSegmentBytes - count) << 1 | (is_last ? kLastSegment : 0U), toggle_));
  std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(place_), count, answer_.begin() + 1);
  place_ += count;
  toggle_ = !toggle_;
  limit_us_ = now_us + kSegmentLimit_us;
  if (is_last) end();
}

void SdoServer::give(std::span<const std::uint8_t> bytes, std::int64_t now_us) noexcept {
  if (bytes.empty() || bytes.size() > kObjectBytesMax) {
    // Nothing to read is an empty segment; what cannot be held never is in the dictionary.
    bytes = bytes.first(0);
  }
  size_ = bytes.size();
  const bool is_expedited = size_ >= 1 && size_ <= kExpeditedBytes;
  if (is_expedited) {
    answer_with_object(static_cast<std::uint8_t>(0x43 | (kExpeditedBytes - size_) << 2));
    std::copy(bytes.begin(), bytes.end(), answer_.begin() + 4);
    return end();
  }
  std::copy(bytes.begin(), bytes.end(), buffer_.begin());
  begin(State::kUpload, now_us);
  answer_with_object(0x41);
  put_number(answer_, 4, 4, static_cast<std::uint32_t>(size_));
}

void SdoServer::written() noexcept {
  if (is_segment_) {
    answer(with_toggle(0x20, toggle_));
  } else {
    answer_with_object(0x60);
  }
  end();
}

void SdoServer::refuse(Abort why) noexcept {
  answer_with_object(0x80);
  put_number(answer_, 4, 4, static_cast<std::uint32_t>(why));
  end();
}

void SdoServer::pass_time(std::int64_t now_us) noexcept {
  if (now_us >= limit_us_) refuse(Abort::kTimeout);
}

void SdoServer::begin(State state, std::int64_t now_us) noexcept {
  state_ = state;
  toggle_ = false;
  place_ = 0;
  limit_us_ = now_us + kSegmentLimit_us;
}

void SdoServer::end() noexcept {
  state_ = State::kIdle;
  limit_us_ = kNever_us;
}

void SdoServer::answer(std::uint8_t command) noexcept {
  answer_ = {command};
  has_answer_ = true;
}

void SdoServer::answer_with_object(std::uint8_t command) noexcept {
  answer(command);
  put_number(answer_, 1, 2, index_);
  answer_[3] = subindex_;
}

}  // namespace flatpose::can
