#include "port/linux/files/json_text.hpp"

#include <algorithm>
#include <cmath>

#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::port {
namespace {

using Json = nlohmann::json;

std::string line_and_column(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const auto lines = std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  return "line " + std::to_string(lines + 1) + ", column " +
         std::to_string(before.size() - line_start + 1);
}

}  // namespace

Json parse_json(const std::string& path, std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  std::size_t value_count = 0;
  const Json::parser_callback_t limit = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > kJsonDepthMax)
      throw InputError(path, "it is nested more than " + std::to_string(kJsonDepthMax) + " deep",
                       "check that it is the right file");
    if (++value_count > kJsonValuesMax)
      throw InputError(path, "it holds more than " + std::to_string(kJsonValuesMax) + " values",
                       "check that it is the right file");
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), limit);
  } catch (const Json::parse_error& error) {
    const std::size_t byte = error.byte > 0 ? error.byte - 1 : 0;
    if (byte >= text.size())
      throw InputError(path, "the JSON is cut off at byte " + std::to_string(text.size()),
                       "copy the file again");
    throw InputError(path, line_and_column(text, byte) + ": not JSON", "correct the file there");
  } catch (const Json::exception& error) {
    // The library's texts start with its own name in brackets.
    const std::string_view why = error.what();
    throw InputError(path, why.substr(std::min(why.find("] ") + 2, why.size())),
                     "correct the file");
  }
}

void JsonPlace::fail(std::string_view why, std::string_view remedy) const {
  // A name is made of our own keys, never of the file's.
  throw InputError(*path_, (name_.empty() ? "the file" : name_) + " " + std::string(why), remedy);
}

bool JsonPlace::has(std::string_view key) const {
  return value_->is_object() && value_->contains(key);
}

JsonPlace JsonPlace::operator[](std::string_view key) const {
  if (!value_->is_object()) fail("is not an object { }");
  const auto found = value_->find(key);
  if (found == value_->end()) fail("has no \"" + std::string(key) + "\"");
  return {*path_, *found, name_.empty() ? std::string(key) : name_ + "." + std::string(key)};
}

JsonPlace JsonPlace::element(std::size_t index, std::size_t count) const {
  if (!value_->is_array() || value_->size() != count)
    fail("is not a list of " + std::to_string(count));
  return {*path_, (*value_)[index], name_ + "[" + std::to_string(index) + "]"};
}

double JsonPlace::number() const {
  if (!value_->is_number()) fail("is not a number");
  const auto number = value_->get<double>();
  if (!std::isfinite(number)) fail("is not a finite number");
  return number;
}

double JsonPlace::positive_number() const {
  const double value = number();
  if (!(value > 0.0)) fail("is not above 0");
  return value;
}

std::uint64_t JsonPlace::whole_number() const {
  if (!value_->is_number_unsigned()) fail("is not a whole number");
  return value_->get<std::uint64_t>();
}

const std::string& JsonPlace::text() const {
  if (!value_->is_string()) fail("is not a text");
  return value_->get_ref<const std::string&>();
}

}  // namespace flatpose::port
