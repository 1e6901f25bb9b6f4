#include "port/linux/realtime/cpu_list.hpp"

#include <algorithm>
#include <charconv>

namespace flatpose::port {
namespace {

/// Takes a number off the start; -1 when there is none that counts.
int take_number(std::string_view& text) {
  int value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || value < 0 || value > kCpuMax) return -1;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

void add_range(std::string_view text, std::vector<int>& cpus) {
  const int first = take_number(text);
  int last = first;
  if (first >= 0 && text.starts_with("-")) {
    text.remove_prefix(1);
    last = take_number(text);
  }
  if (first < 0 || last < 0 || !text.empty()) return;
  for (int cpu = first; cpu <= last; ++cpu) cpus.push_back(cpu);
}

}  // namespace

std::vector<int> parse_cpu_list(std::string_view text) {
  std::vector<int> cpus;
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    add_range(text.substr(0, comma), cpus);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  std::sort(cpus.begin(), cpus.end());
  cpus.erase(std::unique(cpus.begin(), cpus.end()), cpus.end());
  return cpus;
}

std::string to_cpu_list(std::vector<int> cpus) {
  std::sort(cpus.begin(), cpus.end());
  std::string text;
  for (std::size_t i = 0; i < cpus.size();) {
    std::size_t end = i + 1;
    while (end < cpus.size() && cpus[end] == cpus[end - 1] + 1) ++end;
    if (!text.empty()) text += ',';
    text += std::to_string(cpus[i]);
    if (end - i > 1) text.append(1, '-').append(std::to_string(cpus[end - 1]));
    i = end;
  }
  return text;
}

bool contains(const std::vector<int>& cpus, int cpu) {
  return std::find(cpus.begin(), cpus.end(), cpu) != cpus.end();
}

}  // namespace flatpose::port
