#include <iostream>
#include <string>
#include <vector>

#include "port/linux/tool/tool.hpp"

int main(int argc, char** argv) {
  const std::vector<std::string> args(argv + (argc > 0 ? 1 : 0), argv + argc);
  return flatpose::tool::run_tool(args, std::cout, std::cerr);
}
