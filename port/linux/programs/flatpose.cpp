#include <csignal>
#include <iostream>
#include <string>
#include <vector>

#include "port/linux/daemon/config_map.hpp"
#include "port/linux/tool/tool.hpp"

int main(int argc, char** argv) {
  // A limit on file sizes is then an error of write(), told like a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  const std::vector<std::string> args(argv + (argc > 0 ? 1 : 0), argv + argc);
  return flatpose::tool::run_tool(args, std::cout, std::cerr, flatpose::daemon::read_served_map);
}
