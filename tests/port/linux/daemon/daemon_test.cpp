// The program, in process where it ends by itself and as a process of its own where a signal must.

#include "port/linux/daemon/daemon.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <sstream>

#include "tests/port/linux/realtime/made_machine.hpp"

namespace flatpose::daemon {
namespace {

using Words = std::vector<std::string>;

constexpr const char* kSmall =
    "[search]\nthreads = 2\nscan_width_px = 100\nscan_height_px = 80\ncell_count = 10_000\n";

struct Ran {
  int code = -1;
  std::string out;
  std::string err;
};

Ran run(const Words& words, const std::string& root = {}) {
  std::ostringstream out;
  std::ostringstream err;
  Ran ran;
  ran.code = run_daemon(words, out, err, root);
  ran.out = out.str();
  ran.err = err.str();
  return ran;
}

void expect_refused(const Ran& ran, const std::string& part) {
  EXPECT_EQ(ran.code, 2) << ran.err;
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  EXPECT_EQ(ran.err.rfind("flatposed: ", 0), 0U) << ran.err;
  EXPECT_NE(ran.err.find(part), std::string::npos) << ran.err;
  port::expect_one_line(ran.err.substr(11, ran.err.size() - 12));
}

TEST(Daemon, RefusesWrongCommandLines) {
  expect_refused(run({}), "--config");
  expect_refused(run({"--config"}), "--config");
  expect_refused(run({"--config", "/nowhere/f.toml"}), "/nowhere/f.toml");
  expect_refused(run({"--bogus"}), "see flatposed --help");
  const Ran help = run({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.out.find("--check"), std::string::npos);
}

TEST(Daemon, RefusesABadConfigWithItsLine) {
  const port::TemporaryFolder folder;
  const std::string path = folder.write("f.toml", "[search]\nthraeds = 2\n");
  const std::string line = "flatposed: " + path + ":2: unknown key 'thraeds' in [search]; " +
                           "did you mean 'threads'?\n";
  for (const Words& words : {Words{"--config", path}, Words{"--config", path, "--check"}}) {
    const Ran ran = run(words);
    expect_refused(ran, "thraeds");
    EXPECT_EQ(ran.err, line);
  }
}

TEST(Daemon, RefusesFilesOfTheConfigThatCannotBeUsed) {
  const port::TemporaryFolder folder;
  const std::string job = "[[part]]\nname = \"a\"\nfile = \"a.fpt\"\n[[job]]\nparts = [\"a\"]\n";
  const std::string path = folder.write("f.toml", kSmall + job);
  expect_refused(run({"--config", path, "--check"}), "a.fpt");
  folder.write("a.fpt", "no template");
  expect_refused(run({"--config", path, "--check"}), "teach the part again");
  expect_refused(run({"--config", folder.write("g.toml", kSmall), "--scan", "/nowhere", "--check"}),
                 "--scan: there is no /nowhere");
  expect_refused(run({"--config", path, "--modbus-port", "65536"}), "--modbus-port");
}

TEST(Check, OfTheExampleIsContent) {
  const Ran ran =
      run({"--config", FLATPOSE_SOURCE_DIR "/port/linux/examples/flatposed.toml", "--check"});
  EXPECT_EQ(ran.code, 0) << ran.err;
}

TEST(Check, OfAGoodMachineHasNothingToMend) {
  const port::MadeMachine machine;
  const port::TemporaryFolder folder;
  const std::string path =
      folder.write("f.toml", std::string(kSmall) + "[realtime]\ncpus = [2, 3]\npriority = 80\n");
  const Ran ran = run({"--config", path, "--check"}, machine.root());
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.err, "");
  EXPECT_EQ(ran.out.rfind(path + ": valid; 2 search threads on CPU 2-3, ", 0), 0U) << ran.out;
  EXPECT_NE(ran.out.find("the machine lacks nothing"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("\nwarning: no [modbus] and no [can]: nobody can ask"), std::string::npos)
      << "what a start warns of: " << ran.out;
}

TEST(Check, NamesWhatTheMachineLacksAndIsStillContent) {
  const port::MadeMachine machine;
  machine.set("proc/version", "Linux version 6.1.0-18-amd64 (x@y) #1 SMP PREEMPT_DYNAMIC\n");
  machine.remove("sys/kernel/realtime");
  machine.set("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
  machine.set("sys/devices/system/cpu/cpu2/cpufreq/scaling_governor", "schedutil\n");
  machine.set("proc/swaps", "Filename Type Size Used Priority\n/swapfile file 1 0 -2\n");
  const port::TemporaryFolder folder;
  const std::string path =
      folder.write("f.toml", std::string(kSmall) + "[realtime]\ncpus = [2, 3]\n");
  const Ran ran = run({"--config", path, "--check"}, machine.root());
  EXPECT_EQ(ran.code, 0) << ran.err;
  for (const char* const part :
       {"kernel: ", "  sudo apt install linux-image-rt", "throttling: ", "  sudo sysctl -w",
        "governor: 'schedutil'", "  for i in 2; do echo performance", "swap: /swapfile",
        "  sudo swapoff -a"})
    EXPECT_NE(ran.out.find(part), std::string::npos) << part << " is not in:\n" << ran.out;
}

TEST(Daemon, DoesNotStartWithoutTheMemory) {
  const port::MadeMachine machine;
  machine.set("proc/meminfo", "MemAvailable:  100 kB\n");
  const port::TemporaryFolder folder;
  const std::string path = folder.write("f.toml", kSmall);
  expect_refused(run({"--config", path}, machine.root()), "cell_count");
  const Ran checked = run({"--config", path, "--check"}, machine.root());
  EXPECT_EQ(checked.code, 0);
  EXPECT_NE(checked.out.find("memory: 0 MB are free"), std::string::npos) << checked.out;
  EXPECT_EQ(
      checked.out.rfind(
          path + ": valid, but the daemon would not start on this machine: [search] needs ", 0),
      0U)
      << checked.out;
}

/// The daemon as its service manager sees it: a socket for its state, a pipe for its log.
class Service {
 public:
  Service(const std::string& config, const std::string& socket_path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket_path.copy(address.sun_path, sizeof address.sun_path - 1);
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    const timeval limit{20, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    int ends[2] = {-1, -1};
    EXPECT_EQ(pipe(ends), 0);
    pid_ = fork();
    if (pid_ == 0) {
      dup2(ends[1], STDERR_FILENO);
      close(ends[0]);
      close(ends[1]);
      setenv("NOTIFY_SOCKET", socket_path.c_str(), 1);
      setenv("WATCHDOG_USEC", "40000", 1);
      execl(FLATPOSED_PROGRAM, "flatposed", "--config", config.c_str(), nullptr);
      _exit(127);
    }
    close(ends[1]);
    log_ = ends[0];
  }
  ~Service() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    close(socket_);
    close(log_);
  }
  /// The next thing it says; empty after a long silence.
  std::string told() const {
    char text[512];
    const ssize_t size = recv(socket_, text, sizeof text, 0);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : "";
  }
  bool tells(const std::string& what) const {
    for (std::string text = told(); !text.empty(); text = told())
      if (text.find(what) != std::string::npos) return true;
    return false;
  }
  void signal(int number) const { kill(pid_, number); }
  /// Its exit code and all of its log.
  Ran ended() {
    Ran ran;
    char text[512];
    for (ssize_t size; (size = read(log_, text, sizeof text)) > 0;)
      ran.err.append(text, static_cast<std::size_t>(size));
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = 0;
    ran.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return ran;
  }

 private:
  int socket_ = -1;
  int log_ = -1;
  pid_t pid_ = 0;
};

TEST(DaemonProcess, StartsTellsItLivesAndEndsWithTheSignal) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const port::TemporaryFolder folder;
    const std::string path =
        folder.write("f.toml", std::string(kSmall) + "[realtime]\ntimer_slack_ns = 1000\n");
    Service service(path, folder.path("notify"));
    EXPECT_TRUE(service.tells("READY=1\nSTATUS=2 search threads"));
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(service.tells("WATCHDOG=1"));
    service.signal(signal);
    EXPECT_TRUE(service.tells("STOPPING=1"));
    const Ran ran = service.ended();
    EXPECT_EQ(ran.code, 0) << ran.err;
    for (const char* const part : {"search 0: timer slack 1000 ns\n", "search 1: timer slack",
                                   "ready: 2 search threads", "flatposed: ended\n"})
      EXPECT_NE(ran.err.find(part), std::string::npos) << part << " is not in:\n" << ran.err;
  }
}

TEST(DaemonProcess, StartsWithoutWhatItMayNotHave) {
  const port::TemporaryFolder folder;
  const std::string path = folder.write("f.toml",
                                        "[search]\nscan_width_px = 100\nscan_height_px = 80\n"
                                        "cell_count = 10_000\n[realtime]\ncpus = [4095]\n");
  Service service(path, folder.path("notify"));
  EXPECT_TRUE(service.tells("READY=1"));
  service.signal(SIGTERM);
  const Ran ran = service.ended();
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.err.find("flatposed: warning: not done: search 0: on CPU 4095: "),
            std::string::npos)
      << ran.err;
}

}  // namespace
}  // namespace flatpose::daemon
