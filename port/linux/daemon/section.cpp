#include "port/linux/daemon/section.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "port/linux/daemon/spelling.hpp"
#include "port/linux/files/atomic_file.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {
namespace {

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string range_text(const std::string& least, const std::string& greatest) {
  return "between " + least + " and " + greatest;
}

std::string shortest(double value) {
  std::string text = std::to_string(value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

}  // namespace

struct Section::Place {
  std::shared_ptr<const toml::table> whole;  ///< Keeps the file's values.
  const toml::table* table = nullptr;        ///< None: the section is not there.
  std::string path;
  std::string name;  ///< "[realtime]"; empty for the file itself.
  unsigned line = 1;
  std::vector<std::string> known;

  const toml::node* find(const std::string& key) {
    if (std::find(known.begin(), known.end(), key) == known.end()) known.push_back(key);
    return table == nullptr ? nullptr : table->get(key);
  }
  [[noreturn]] void refuse(unsigned at_line, const std::string& what,
                           const std::string& remedy) const {
    throw port::InputError(path + ":" + std::to_string(at_line), what, remedy);
  }
  [[noreturn]] void refuse(const toml::node& node, const std::string& what,
                           const std::string& remedy) const {
    refuse(node.source().begin.line, what, remedy);
  }
  std::int64_t whole_of(const toml::node& node, const std::string& key, Range range) const {
    const auto* const value = node.as_integer();
    const std::string allowed =
        range_text(std::to_string(range.least), std::to_string(range.greatest));
    if (value == nullptr)
      refuse(node, "'" + key + "' is not a whole number", "give one " + allowed);
    if (value->get() < range.least || value->get() > range.greatest)
      refuse(node, "'" + key + "' is " + std::to_string(value->get()), "give a number " + allowed);
    return value->get();
  }
  const toml::array& list_of(const toml::node& node, const std::string& key,
                             const std::string& example, std::size_t count_max) const {
    const toml::array* const list = node.as_array();
    if (list == nullptr)
      refuse(node, "'" + key + "' is not a list", "give one, e.g. " + key + " = " + example);
    if (list->size() > count_max)
      refuse(node, "'" + key + "' has " + std::to_string(list->size()) + " values",
             "give " + std::to_string(count_max) + " at most");
    return *list;
  }
  double number_of(const toml::node& node, const std::string& key, double least,
                   double greatest) const {
    const std::string allowed = range_text(shortest(least), shortest(greatest));
    if (!node.is_number()) refuse(node, "'" + key + "' is not a number", "give one " + allowed);
    const double value = node.value<double>().value_or(std::nan(""));
    if (!(value >= least && value <= greatest))
      refuse(node, "'" + key + "' is " + shortest(value), "give a number " + allowed);
    return value;
  }
  std::string text_of(const toml::node& node, const std::string& key) const {
    if (!node.is_string()) refuse(node, "'" + key + "' is not a text", "put it in quotes");
    return node.as_string()->get();
  }
  [[nodiscard]] std::shared_ptr<Place> inside(const toml::table* other,
                                              const std::string& title) const {
    auto place = std::make_shared<Place>();
    place->whole = whole;
    place->table = other;
    place->path = path;
    place->name = title;
    place->line = other == nullptr ? line : other->source().begin.line;
    return place;
  }
};

Section Section::of_file(const std::string& path) {
  const std::vector<std::byte> bytes = port::read_file(path, kConfigBytesMax);
  return of_text(path, port::as_text(bytes));
}

Section Section::of_text(const std::string& path, std::string_view text) {
  auto place = std::make_shared<Place>();
  place->path = path;
  try {
    place->whole = std::make_shared<const toml::table>(toml::parse(text, path));
  } catch (const toml::parse_error& error) {
    std::string what(error.description());
    while (!what.empty() && (what.back() == '.' || what.back() == '\n')) what.pop_back();
    place->refuse(error.source().begin.line, what, "correct the line (TOML 1.0)");
  }
  place->table = place->whole.get();
  return Section(std::move(place));
}

std::optional<std::int64_t> Section::whole(const std::string& key, Range range) {
  const toml::node* const node = place_->find(key);
  if (node == nullptr) return std::nullopt;
  return place_->whole_of(*node, key, range);
}

std::vector<std::int64_t> Section::wholes(const std::string& key, Range range,
                                          std::size_t count_max) {
  std::vector<std::int64_t> values;
  const toml::node* const node = place_->find(key);
  if (node == nullptr) return values;
  const toml::array& list = place_->list_of(*node, key, "[1, 2]", count_max);
  for (const toml::node& element : list) values.push_back(place_->whole_of(element, key, range));
  return values;
}

std::optional<double> Section::number(const std::string& key, double least, double greatest) {
  const toml::node* const node = place_->find(key);
  if (node == nullptr) return std::nullopt;
  return place_->number_of(*node, key, least, greatest);
}

std::vector<double> Section::numbers(const std::string& key, double least, double greatest,
                                     std::size_t count) {
  std::vector<double> values;
  const toml::node* const node = place_->find(key);
  if (node == nullptr) return values;
  const toml::array& list = place_->list_of(*node, key, "[-100, 100]", count);
  if (list.size() != count)
    place_->refuse(*node, "'" + key + "' has " + std::to_string(list.size()) + " values",
                   "give " + std::to_string(count));
  for (const toml::node& element : list)
    values.push_back(place_->number_of(element, key, least, greatest));
  return values;
}

std::optional<bool> Section::flag(const std::string& key) {
  const toml::node* const node = place_->find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_boolean())
    place_->refuse(*node, "'" + key + "' is neither true nor false", "give one, without quotes");
  return node->as_boolean()->get();
}

std::optional<std::string> Section::text(const std::string& key) {
  const toml::node* const node = place_->find(key);
  if (node == nullptr) return std::nullopt;
  return place_->text_of(*node, key);
}

std::vector<std::string> Section::texts(const std::string& key, std::size_t count_max) {
  std::vector<std::string> values;
  const toml::node* const node = place_->find(key);
  if (node == nullptr) return values;
  for (const toml::node& element : place_->list_of(*node, key, "[\"a\", \"b\"]", count_max))
    values.push_back(place_->text_of(element, key));
  return values;
}

std::optional<int> Section::choice(const std::string& key, const std::vector<std::string>& words) {
  const std::optional<std::string> word = text(key);
  if (!word) return std::nullopt;
  const auto found = std::find(words.begin(), words.end(), *word);
  if (found == words.end())
    fail(key, "'" + key + "' is \"" + port::printable(*word, 60) + "\"",
         "give one of: " + listed(words));
  return static_cast<int>(found - words.begin());
}

bool Section::is_there() const noexcept { return place_->table != nullptr; }

std::string Section::place_of(const std::string& key) const {
  const toml::node* const node = place_->table == nullptr ? nullptr : place_->table->get(key);
  const unsigned at_line = node == nullptr ? place_->line : node->source().begin.line;
  return place_->path + ":" + std::to_string(at_line);
}

std::optional<std::string> Section::file(const std::string& key) {
  const std::optional<std::string> path = text(key);
  if (!path) return std::nullopt;
  const toml::node& node = *place_->table->get(key);
  if (path->empty() || path->find('\0') != std::string::npos)
    place_->refuse(node, "'" + key + "' is no path", "give one or leave the line out");
  return (std::filesystem::path(place_->path).parent_path() / *path).string();
}

Section Section::section(const std::string& key) {
  const toml::node* const node = place_->find(key);
  const std::string title = "[" + key + "]";
  if (node != nullptr && !node->is_table())
    place_->refuse(*node, "'" + key + "' is not a section", "write " + title + " on its own line");
  return Section(place_->inside(node == nullptr ? nullptr : node->as_table(), title));
}

std::vector<Section> Section::sections(const std::string& key) {
  std::vector<Section> list;
  const toml::node* const node = place_->find(key);
  if (node == nullptr) return list;
  const std::string title = "[[" + key + "]]";
  const toml::array* const tables = node->as_array();
  if (tables == nullptr || !tables->is_homogeneous<toml::table>())
    place_->refuse(*node, "'" + key + "' is not a list of sections",
                   "write " + title + " before each");
  for (const toml::node& table : *tables)
    list.push_back(Section(place_->inside(table.as_table(), title)));
  return list;
}

void Section::finish() const {
  if (place_->table == nullptr) return;
  for (const auto& [key, node] : *place_->table) {
    const std::string word(key.str());
    if (std::find(place_->known.begin(), place_->known.end(), word) != place_->known.end())
      continue;
    const std::string near = nearest_word(word, place_->known);
    const std::string where = place_->name.empty() ? "" : " in " + place_->name;
    place_->refuse(key.source().begin.line, "unknown key '" + word + "'" + where,
                   !near.empty()           ? "did you mean '" + near + "'?"
                   : place_->known.empty() ? "take it out"
                                           : "known: " + listed(place_->known));
  }
}

void Section::fail(const std::string& key, const std::string& what,
                   const std::string& remedy) const {
  const toml::node* const node = place_->table == nullptr ? nullptr : place_->table->get(key);
  if (node != nullptr) place_->refuse(*node, what, remedy);
  place_->refuse(place_->line, what, remedy);
}

namespace {

std::string written(const toml::node& node) {
  std::ostringstream text;
  text << toml::node_view<const toml::node>(node);
  return text.str();
}

}  // namespace

std::vector<std::string> changed_tables(std::string_view before, std::string_view after,
                                        const std::vector<std::string>& but) {
  const toml::table a = toml::parse(before);
  const toml::table b = toml::parse(after);
  std::vector<std::string> changed;
  const auto note = [&](const toml::table& one, const toml::table& other, bool only_missing) {
    for (const auto& [key, node] : one) {
      const std::string name(key.str());
      if (std::find(but.begin(), but.end(), name) != but.end()) continue;
      const toml::node* const counterpart = other.get(name);
      const bool differs =
          counterpart == nullptr || (!only_missing && written(node) != written(*counterpart));
      if (differs) changed.push_back(name);
    }
  };
  note(a, b, false);
  note(b, a, true);
  return changed;
}

}  // namespace flatpose::daemon
