#pragma once
// Lists of processors as the kernel writes them: "0-3,5".

#include <string>
#include <string_view>
#include <vector>

namespace flatpose::port {

inline constexpr int kCpuMax = 4095;

/// What cannot be read is left out, and so are numbers beyond kCpuMax.
[[nodiscard]] std::vector<int> parse_cpu_list(std::string_view text);
/// In the shortest form.
[[nodiscard]] std::string to_cpu_list(std::vector<int> cpus);
[[nodiscard]] bool contains(const std::vector<int>& cpus, int cpu);

}  // namespace flatpose::port
