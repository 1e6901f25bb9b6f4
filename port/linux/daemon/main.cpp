#include <csignal>
#include <iostream>
#include <string>
#include <vector>

#include "port/linux/daemon/daemon.hpp"

int main(int argc, char** argv) {
  // A log that nobody reads any more must not end the daemon.
  std::signal(SIGPIPE, SIG_IGN);
  const std::vector<std::string> args(argv + (argc > 0 ? 1 : 0), argv + argc);
  return flatpose::daemon::run_daemon(args, std::cout, std::cerr);
}
