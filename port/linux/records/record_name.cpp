#include "port/linux/records/record_name.hpp"

#include <array>
#include <charconv>
#include <cstdio>
#include <ctime>
#include <vector>

namespace flatpose::port {
namespace {

constexpr std::size_t kStemBytesMax = 120;
constexpr std::array<const char*, 3> kKinds{"found", "failed", "done"};

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == '-') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

std::uint64_t number_of(std::string_view text) {
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

RecordName::Kind kind_of(const std::string& word) {
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    if (word == kKinds[i]) return static_cast<RecordName::Kind>(i);
  }
  return RecordName::Kind::kDone;
}

}  // namespace

std::string RecordName::text() const {
  const bool is_saved = kind == Kind::kSaved;
  char head[kStemBytesMax];
  std::snprintf(head, sizeof head, "%s-%010llu-%s-n%05u", is_saved ? "saved" : "record",
                static_cast<unsigned long long>(sequence), time.c_str(),
                static_cast<unsigned>(number));
  if (is_saved) return head;
  return std::string(head) + "-" + kKinds[static_cast<std::size_t>(kind)] + "-" + status;
}

std::optional<RecordName> RecordName::parse(std::string_view stem) {
  if (stem.size() > kStemBytesMax) return std::nullopt;
  const std::vector<std::string> words = words_of(stem);
  const bool is_saved = words[0] == "saved" && words.size() == 4;
  if (!is_saved && !(words[0] == "record" && words.size() == 6)) return std::nullopt;
  if (words[3].empty()) return std::nullopt;
  RecordName name;
  name.sequence = number_of(words[1]);
  name.time = words[2];
  name.number = static_cast<std::uint16_t>(number_of(std::string_view(words[3]).substr(1)));
  name.kind = is_saved ? Kind::kSaved : kind_of(words[4]);
  if (!is_saved) name.status = words[5];
  return name.text() == stem ? std::optional(name) : std::nullopt;
}

std::string utc_text(std::int64_t since_1970_us) {
  const auto time_s = static_cast<std::time_t>(since_1970_us / 1'000'000);
  std::tm parts{};
  char text[32] = "";
  if (gmtime_r(&time_s, &parts) != nullptr)
    std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", &parts);
  return text;
}

}  // namespace flatpose::port
