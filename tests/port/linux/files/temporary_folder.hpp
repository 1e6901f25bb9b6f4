#pragma once
// A folder that vanishes with the test, and what the messages of this room must look like.

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "port/linux/files/input_error.hpp"

namespace flatpose::port {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "flatpose-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::string path(const std::string& name) const { return path_ + "/" + name; }
  [[nodiscard]] const std::string& path() const { return path_; }
  std::string write(const std::string& name, std::string_view bytes) const {
    std::filesystem::remove(path(name));  // some file systems flush what is written over
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  [[nodiscard]] std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::string path_;
};

inline std::span<const std::byte> as_bytes(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

// One line of printable characters, with a subject, a reason and a remedy, of bounded length.
inline void expect_one_line(const std::string& line) {
  EXPECT_LE(line.size(), kSubjectBytesMax + kReasonBytesMax + kRemedyBytesMax + 4);
  for (const char c : line) EXPECT_FALSE(static_cast<unsigned char>(c) < 0x20 || c == 0x7F) << line;
  const std::size_t why = line.find(": ");
  const std::size_t remedy = line.rfind("; ");
  EXPECT_NE(why, std::string::npos) << line;
  ASSERT_NE(remedy, std::string::npos) << line;
  EXPECT_LT(why, remedy) << line;
  EXPECT_GT(line.size(), remedy + 6) << line;
}

// `call` must throw an InputError whose line holds all of `parts`.
template <class Call>
void expect_input_error(Call&& call, std::initializer_list<std::string_view> parts) {
  try {
    call();
  } catch (const InputError& error) {
    expect_one_line(error.line());
    for (const std::string_view part : parts)
      EXPECT_NE(error.line().find(part), std::string::npos)
          << "\"" << part << "\" is not in: " << error.line();
    return;
  }
  ADD_FAILURE() << "no InputError, expected one about: " << *parts.begin();
}

}  // namespace flatpose::port
