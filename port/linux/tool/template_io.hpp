#pragma once
// Templates from and to disk, and what there is to say of them.

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "flatpose/model/template.hpp"

namespace flatpose::tool {

/// Whether the bytes start like a template's.
[[nodiscard]] bool is_template(std::span<const std::byte> bytes) noexcept;

/// Fails: InputError.
[[nodiscard]] std::unique_ptr<model::Template> load_template(const std::string& path);
[[nodiscard]] std::vector<std::byte> template_bytes(const model::Template& part);

/// What teach found weak, a word and a sentence each.
struct WeakPoint {
  std::string word;
  std::string sentence;
};
[[nodiscard]] std::vector<WeakPoint> weak_points(const model::Template& part);

}  // namespace flatpose::tool
